"""TGA images: their specification, compared with the PNG as read by Pillow; and malicious files."""

import contextlib
import io
import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from morse.assets.targa import HEADER_SIZE, TargaError, is_targa, png_of

#: the corners of an image: red, green above blue, white
CORNERS = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]], np.uint8)
TOP_FIRST, RIGHT_TO_LEFT = 0x20, 0x10


def header(
    width: int, height: int, bits: int, *, kind: int = 2, flags: int = 0, comment: int = 0, colors: int = 0
) -> bytes:
    return struct.pack("<BBB5xHHHHBB", comment, colors, kind, 0, 0, width, height, bits, flags)


def pixels_of(png: bytes) -> np.ndarray:
    with Image.open(io.BytesIO(png)) as picture:
        return np.asarray(picture)


def stored(pixels: np.ndarray) -> bytes:
    """Pixels (H, W, 3 or 4) as blue, green, red and alpha."""
    order = [2, 1, 0, 3][: pixels.shape[2]]
    return pixels[:, :, order].tobytes()


@pytest.mark.parametrize(
    ("flags", "turned"),
    [
        (TOP_FIRST, CORNERS),
        (0, CORNERS[::-1]),
        (TOP_FIRST | RIGHT_TO_LEFT, CORNERS[:, ::-1]),
        (RIGHT_TO_LEFT, CORNERS[::-1, ::-1]),
    ],
)
def test_the_flags_say_where_the_first_pixel_is(flags: int, turned: np.ndarray) -> None:
    data = header(2, 2, 24, flags=flags) + stored(turned)
    np.testing.assert_array_equal(pixels_of(png_of(data)), CORNERS)


def test_the_comment_after_the_header_is_skipped() -> None:
    data = header(2, 2, 24, flags=TOP_FIRST, comment=5) + b"hello" + stored(CORNERS)
    np.testing.assert_array_equal(pixels_of(png_of(data)), CORNERS)


@pytest.mark.parametrize(("flags", "channels"), [(TOP_FIRST | 8, 4), (TOP_FIRST, 3)])
def test_the_fourth_byte_is_alpha_only_if_the_header_says_so(flags: int, channels: int) -> None:
    rgba = np.dstack([CORNERS, np.array([[0, 128], [255, 7]], np.uint8)])
    found = pixels_of(png_of(header(2, 2, 32, flags=flags) + stored(rgba)))
    np.testing.assert_array_equal(found, rgba[:, :, :channels])


def test_runs_and_raw_packets_go_across_rows() -> None:
    red, green, blue = b"\0\0\xff", b"\0\xff\0", b"\xff\0\0"
    body = bytes([0x80 | 3]) + red + bytes([1]) + green + blue
    found = pixels_of(png_of(header(3, 2, 24, kind=10, flags=TOP_FIRST) + body))
    expected = [[[255, 0, 0]] * 3, [[255, 0, 0], [0, 255, 0], [0, 0, 255]]]
    np.testing.assert_array_equal(found, expected)


@settings(deadline=None)
@given(st.integers(1, 9), st.integers(1, 9), st.sampled_from(["RGB", "RGBA"]), st.booleans(), st.randoms())
def test_files_that_pillow_writes_are_read(width: int, height: int, mode: str, compressed: bool, random) -> None:  # type: ignore[no-untyped-def]
    channels = len(mode)
    values = bytes(random.choice((0, 7, 255)) for _ in range(width * height * channels))
    picture = Image.frombytes(mode, (width, height), values)
    file = io.BytesIO()
    picture.save(file, "TGA", compression="tga_rle" if compressed else None)
    assert is_targa(file.getvalue()[:HEADER_SIZE])
    np.testing.assert_array_equal(pixels_of(png_of(file.getvalue())), np.asarray(picture))


@pytest.mark.parametrize(
    "data",
    [
        b"",
        header(2, 2, 24)[:-1],
        header(2, 2, 24),
        header(2, 2, 24) + b"\0" * 11,
        header(2, 2, 24, comment=255) + stored(CORNERS),
        header(0, 5, 24) + b"\0" * 100,
        header(65535, 65535, 32) + b"\0" * 100,
        header(65535, 65535, 32, kind=10) + b"\xff\0\0\0\0" * 10,
        header(2, 2, 24, kind=10),
        header(2, 2, 24, kind=10) + b"\x83",
        header(2, 2, 24, kind=10) + b"\x84\0\0\0",
        header(2, 2, 24, kind=10) + b"\x7f" + b"\0" * 12,
        header(2, 2, 16) + b"\0" * 100,
        header(2, 2, 8, kind=3) + b"\0" * 100,
        header(2, 2, 24, kind=1, colors=1) + b"\0" * 100,
        header(2, 2, 24, flags=0x40) + b"\0" * 100,
        header(2, 2, 24, flags=8) + b"\0" * 100,
    ],
)
def test_damaged_files_and_other_kinds_are_refused(data: bytes) -> None:
    with pytest.raises(TargaError):
        png_of(data)


@given(st.binary(max_size=200))
def test_no_bytes_raise_anything_else(tail: bytes) -> None:
    for kind in (2, 10):
        with contextlib.suppress(TargaError):
            png_of(header(5, 4, 32, kind=kind, flags=8) + tail)


def test_the_number_of_packets_is_bounded() -> None:
    data = header(8000, 4000, 24, kind=10) + b"\0\1\2\3" * 4_000_000
    with pytest.raises(TargaError, match="packets"):
        png_of(data)
