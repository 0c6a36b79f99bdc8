"""Compressed images, read by the rules of the decoders of image_transport.

The decoders are those of compressed_image_transport and compressed_depth_image_transport of ROS 2 Jazzy, with Pillow in
the place of OpenCV, whose decoded colours are blue, green, red.
"""

import io
import struct
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from morse.rosmsgs.kinds.vision import compressed_outlet
from tests.kit.effort import examples

COLOURS = {"red": (200, 0, 0), "green": (0, 200, 0), "blue": (0, 0, 200)}
#: channels of red, green and blue in an encoding
PLACES = {"rgb8": (0, 1, 2), "rgba8": (0, 1, 2), "bgr8": (2, 1, 0), "bgra8": (2, 1, 0)}


def decoded_colours(message: Any) -> tuple[Any, str]:
    """The pixels that a subscriber of compressed images gets, and their encoding."""
    opencv = np.asarray(Image.open(io.BytesIO(bytes(message.data))).convert("RGB"))[..., ::-1]
    encoding, semicolon, rest = message.format.partition(";")
    if not semicolon:
        return opencv, "bgr8"
    # if the pixels of the file are marked as bgr, those of rgb encodings are exchanged, else those of bgr encodings
    exchanged = encoding.startswith("rgb") if "compressed bgr" in rest else encoding.startswith("bgr")
    return (opencv[..., ::-1] if exchanged else opencv), encoding


def decoded_depth(message: Any) -> Any:
    """The depths that a subscriber of compressed depth gets, m; for whole numbers these."""
    data, (encoding, _, rest) = bytes(message.data), message.format.partition(";")
    assert "rvl" not in rest
    _, a, b = struct.unpack("<iff", data[:12])
    raw = np.asarray(Image.open(io.BytesIO(data[12:])))
    if encoding == "16UC1":
        return raw
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(raw == 0, np.nan, np.float32(a) / (raw.astype(np.float32) - np.float32(b)))


def made(pixels: Any, encoding: str, unit: str | None = None) -> Any:
    outlet = compressed_outlet(encoding, unit, None)
    assert outlet is not None
    message = outlet.make(SimpleNamespace(pixels=pixels, encoding=encoding, stamp=0), "eye")  # type: ignore[arg-type]
    assert message is not None
    return SimpleNamespace(**message)


@pytest.mark.parametrize("encoding", PLACES)
@pytest.mark.parametrize("colour", COLOURS)
def test_no_decoder_exchanges_red_and_blue(encoding: str, colour: str) -> None:
    pixels = np.full((16, 16, 4 if "a" in encoding else 3), 255, np.uint8)
    pixels[..., PLACES[encoding]] = COLOURS[colour]
    decoded, name = decoded_colours(made(pixels, encoding))
    assert name == encoding
    assert np.abs(decoded[..., PLACES[encoding]].astype(int) - COLOURS[colour]).max() < 12  # JPEG is not exact


def test_grey_images_have_one_channel() -> None:
    message = made(np.full((8, 8), 77, np.uint8), "mono8")
    assert message.format.startswith("mono8; jpeg compressed")
    assert Image.open(io.BytesIO(message.data)).mode == "L"


@settings(max_examples=examples(60), deadline=None)
@given(
    st.lists(
        st.one_of(st.floats(0.0625, 200.0, width=32), st.sampled_from([float("inf"), float("nan"), 0.0, -1.0])),
        min_size=1,
        max_size=30,
    )
)
def test_depth_survives_compression(depths: list[float]) -> None:
    pixels = np.array([depths], dtype=np.float32)
    decoded = decoded_depth(made(pixels, "32FC1", "m"))[0]
    for depth, result in zip(pixels[0], decoded, strict=True):
        if np.isfinite(depth) and depth > 0.0:
            # 16 bits for the inverse of depths whose ratio is at most 4000
            assert result == pytest.approx(depth, rel=0.05)
        else:
            assert np.isnan(result)


def test_depth_of_a_room_has_errors_below_a_centimetre() -> None:
    pixels = np.linspace(0.3, 10.0, 1000, dtype=np.float32).reshape(20, 50)
    assert np.abs(decoded_depth(made(pixels, "32FC1", "m")) - pixels).max() < 0.005


def test_whole_millimetres_and_ids_are_exact() -> None:
    pixels = np.arange(60000, dtype=np.uint16).reshape(200, 300)
    assert (decoded_depth(made(pixels, "16UC1")) == pixels).all()


@pytest.mark.parametrize(("encoding", "unit"), [("32FC1", "°C"), ("32FC1", "1"), ("32FC2", "px"), ("32FC3", "1")])
def test_what_is_no_depth_is_not_compressed(encoding: str, unit: str) -> None:
    assert compressed_outlet(encoding, unit, None) is None


def test_the_topics_have_the_names_of_image_transport(start: Callable[..., Any]) -> None:
    size = "properties(cam_width=32, cam_height=24)"
    sim, desk = start(
        f"eye = VideoCamera('eye'); eye.{size}; eye.add_stream('ros2', encoding='bgr8'); robot.append(eye)\n"
        f"deep = DepthVideoCamera('deep'); deep.{size}; deep.add_stream('ros2', depth16=True); robot.append(deep)\n"
        f"far = DepthVideoCamera('far'); far.{size}; robot.append(far)\n"
        "far.translate(0.6, 0.0, 0.4); far.add_stream('ros2')\n"
        "other = ATRV('other'); other.translate(4.0, 2.0, 0.0)",
        connected="",
    )
    sim.step(8)
    cameras = {"/robot/eye/image": "compressed", "/robot/deep/image": "compressedDepth"}
    for topic, transport in cameras.items():
        assert {name for name in desk.publishers if name.startswith(f"{topic}/")} == {f"{topic}/{transport}"}
    colours, encoding = decoded_colours(desk.last("/robot/eye/image/compressed"))
    raw = desk.last("/robot/eye/image").data.reshape(24, 32, 3)
    assert encoding == desk.last("/robot/eye/image").encoding == "bgr8"
    exchanged = colours[..., ::-1]
    assert np.abs(colours.astype(int) - raw).mean() < 0.5 * np.abs(exchanged.astype(int) - raw).mean()
    deep = desk.last("/robot/deep/image").data.view(np.uint16).reshape(24, 32)
    assert (decoded_depth(desk.last("/robot/deep/image/compressedDepth")) == deep).all()
    far = desk.last("/robot/far/image").data.view(np.float32).reshape(24, 32)
    known = np.isfinite(far)
    assert known.any()
    assert np.allclose(decoded_depth(desk.last("/robot/far/image/compressedDepth"))[known], far[known], rtol=0.01)
