"""Images and point clouds as JSON, with pixels and points in base64."""

from __future__ import annotations

import base64
import io
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.mathutils.portable import matmul
from morse.wire.encoding import to_json

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.datastream import AbstractDatastream

#: fields of every image and cloud: arrays among them are lists in JSON
_NOT_OTHERS = frozenset(("timestamp", "height", "width", "intrinsic_matrix"))
#: the weight of each colour in the luminance (ITU-R BT.709)
_LUMA = (0.2126, 0.7152, 0.0722)


def image_json(
    stream: AbstractDatastream, pixels: Callable[[Any], bytes] | None = None, *, others: bool = True
) -> bytes | None:
    """``{timestamp, height, width, image, intrinsic_matrix}``; the image is RGBA, 8 bits each, in base64.

    A camera with ``compression`` sends the bytes of an image file instead, and ``format`` is its format. The other
    fields of the component follow, arrays of them in base64. None while the camera does not capture.

    Args:
        stream: of a component with the fields ``image`` and ``intrinsic_matrix``.
        pixels: converts the image of the field to bytes; default: RGBA.
        others: send the other fields of the component as well.
    """
    return _json(stream, "image", pixels or as_bytes, others=others)


def _file(pixels: Any, form: str, quality: int) -> bytes:
    """An image (H, W, 4) uint8, (H, W) uint8 or uint16, as the bytes of an image file."""
    # imported only by cameras that compress
    from PIL import Image

    data = io.BytesIO()
    picture = Image.fromarray(np.ascontiguousarray(pixels[..., :3] if pixels.ndim == 3 else pixels))
    if form == "jpeg":
        picture.save(data, "JPEG", quality=quality)
    else:
        # level 1 takes a quarter of the time of the default level
        picture.save(data, "PNG", compress_level=1)
    return data.getvalue()


def image_fields(stream: AbstractDatastream) -> dict[str, Any] | None:
    """The data of `image_json`, with images and other arrays as arrays, and image files as bytes."""
    return _fields(stream, "image", _unchanged, others=True)


def cloud_fields(stream: AbstractDatastream) -> dict[str, Any] | None:
    """The data of `cloud_json`, with the points (..., 3) as an array of float32."""
    if not _is_cloud(stream):
        return stream.data
    return _fields(stream, "points", _as_float32, others=False)


def _unchanged(value: Any) -> Any:
    return value


def _as_float32(points: Any) -> Any:
    return points if isinstance(points, (bytes, bytearray, memoryview)) else np.float32(points)


def _is_cloud(stream: AbstractDatastream) -> bool:
    return "points" in stream.data and hasattr(stream.component_instance, "image_height")


def cloud_json(stream: AbstractDatastream) -> bytes | None:
    """``{timestamp, height, width, points, intrinsic_matrix}``; points are x, y, z in float32, in base64.

    None while the camera does not capture. Data of other components are sent unchanged.
    """
    if not _is_cloud(stream):
        return to_json(stream.data)
    return _json(stream, "points", points_as_bytes)


def _json(
    stream: AbstractDatastream, field: str, encode: Callable[[Any], bytes], *, others: bool = False
) -> bytes | None:
    message = _fields(stream, field, encode, others=others)
    if message is None:
        return None
    message[field] = base64.b64encode(message[field]).decode("ascii")
    if others:
        for name, value in message.items():
            if name not in _NOT_OTHERS and isinstance(value, np.ndarray):
                message[name] = as_bytes(value)
    return to_json(message)


def _fields(
    stream: AbstractDatastream, field: str, encode: Callable[[Any], Any], *, others: bool
) -> dict[str, Any] | None:
    camera: Any = stream.component_instance
    data = stream.data
    # None: the component is not a camera, but has a cloud
    if getattr(camera, "capturing", None) not in (None, True):
        return None
    form = getattr(camera, "compression", "") if field == "image" else ""
    height, width = np.shape(data[field])[:2] if np.ndim(data[field]) >= 2 else (None, None)
    message = {
        "timestamp": data["timestamp"],
        "height": getattr(camera, "image_height", height),
        "width": getattr(camera, "image_width", width),
        field: _file(data[field], form, camera.quality) if form and np.size(data[field]) else encode(data[field]),
    }
    if form:
        message["format"] = form
    if "intrinsic_matrix" in data:
        message["intrinsic_matrix"] = data["intrinsic_matrix"]
    if others:
        for name in data:
            if name not in message:
                message[name] = data[name]
    return message


def as_bytes(value: Any) -> bytes:
    """The bytes of an array, row by row; bytes are returned unchanged."""
    return value.tobytes() if hasattr(value, "tobytes") else bytes(value)


def points_as_bytes(points: Any) -> bytes:
    """Points as float32; bytes are returned unchanged."""
    return bytes(points) if isinstance(points, (bytes, bytearray, memoryview)) else np.float32(points).tobytes()


def grey(image: Any) -> bytes:
    """The luminance of each pixel of an RGBA image, 8 bits."""
    rgba = np.frombuffer(as_bytes(image), dtype=np.uint8).reshape(-1, 4)
    return bytes((matmul(rgba[:, :3], np.array(_LUMA))).astype(np.uint8).tobytes())
