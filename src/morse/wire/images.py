"""The fields of images and point clouds; as JSON, with pixels and points in base64."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.values import Fields
from morse.mathutils.portable import matmul
from morse.wire.encoding import to_json

if TYPE_CHECKING:
    from collections.abc import Mapping


#: fields of every image and cloud: arrays among them are lists in JSON
_NOT_OTHERS = frozenset(("timestamp", "height", "width", "intrinsic_matrix"))
#: the weight of each colour in the luminance (ITU-R BT.709)
_LUMA = (0.2126, 0.7152, 0.0722)


class PictureFields(Fields):
    """Fields of a message whose pixels, points and other arrays are in base64 in lines of JSON."""

    def line(self) -> bytes:
        """The JSON object, without the line end."""
        return to_json({name: as_bytes(value) if _is_packed(name, value) else value for name, value in self.items()})


def _is_packed(name: str, value: object) -> bool:
    return isinstance(value, np.ndarray) and name not in _NOT_OTHERS


def image_fields(camera: Any, data: Mapping[str, object]) -> PictureFields:
    """``{timestamp, height, width, image, intrinsic_matrix}``, and the other fields of the component.

    The image is RGBA, 8 bits each. A camera with ``compression`` has the bytes of an image file instead, and ``format``
    is its format.

    Args:
        camera: the component.
        data: its data, with the field ``image``.
    """
    form = getattr(camera, "compression", "")
    fields = _fields(camera, data, "image")
    if form and np.size(fields["image"]):
        fields["image"] = image_file(fields["image"], form, camera.quality)
    if form:
        fields["format"] = form
    if "intrinsic_matrix" in data:
        fields["intrinsic_matrix"] = data["intrinsic_matrix"]
    for name in data:
        if name not in fields:
            fields[name] = data[name]
    return fields


def cloud_fields(camera: object, data: Mapping[str, object]) -> Mapping[str, object]:
    """``{timestamp, height, width, points, intrinsic_matrix}``; points are x, y, z in float32.

    Data of other components than cameras are returned unchanged.
    """
    if "points" not in data or not hasattr(camera, "image_height"):
        return data
    fields = _fields(camera, data, "points")
    if not isinstance(fields["points"], (bytes, bytearray, memoryview)):
        fields["points"] = np.float32(fields["points"])
    if "intrinsic_matrix" in data:
        fields["intrinsic_matrix"] = data["intrinsic_matrix"]
    return fields


def _fields(camera: object, data: Mapping[str, Any], field: str) -> PictureFields:
    height, width = np.shape(data[field])[:2] if np.ndim(data[field]) >= 2 else (None, None)
    return PictureFields(
        timestamp=data["timestamp"],
        height=getattr(camera, "image_height", height),
        width=getattr(camera, "image_width", width),
        **{field: data[field]},
    )


def image_file(pixels: Any, form: str, quality: int) -> bytes:
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


def as_bytes(value: Any) -> bytes:
    """The bytes of an array, row by row; bytes are returned unchanged."""
    return value.tobytes() if hasattr(value, "tobytes") else bytes(value)


def grey(image: object) -> bytes:
    """The luminance of each pixel of an RGBA image, 8 bits."""
    rgba = np.frombuffer(as_bytes(image), dtype=np.uint8).reshape(-1, 4)
    return bytes((matmul(rgba[:, :3], np.array(_LUMA))).astype(np.uint8).tobytes())
