"""Compressed images, as the plug-ins of image_transport write and read them.

Sources: compressed_image_transport and compressed_depth_image_transport of ROS 2 Jazzy. Both decode with OpenCV, whose
colours are blue, green, red: the word ``bgr8`` in the format tells the decoder to exchange them.
"""

from __future__ import annotations

import io
import struct
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.rosmsgs.outlets import Outlet
from morse.rosmsgs.parts import header

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.kinds import Message
    from morse.core.values import RosMessage
    from morse.rosmsgs.kinds.image_forms import Form

_TYPE = "sensor_msgs/msg/CompressedImage"
#: JPEG quality, 0 to 100
_QUALITY = 85
#: of PNG, 0 to 9: higher levels take several times as long, and save a few per cent
_LEVEL = 1
#: channels that are red, green and blue; one channel is grey
_COLOURS = {"rgb8": (0, 1, 2), "rgba8": (0, 1, 2), "bgr8": (2, 1, 0), "bgra8": (2, 1, 0)}
#: the header of compressed depth: the method (inverse depth), and the numbers a and b
_DEPTH_HEADER = struct.Struct("<iff")
_INVERSE_DEPTH = 0
#: the largest value of a pixel, and that of the farthest depth; 0 is no depth
_NEAREST, _FARTHEST = 65535, 1
#: ratio of the farthest to the nearest depth, at least and at most
_RATIOS = (2.0, 1e4)


def compressed_outlet(encoding: str, unit: str | None, form: Form | None) -> Outlet | None:
    """The topic of the compressed images of an encoding; None if image_transport has no compression for it.

    Args:
        encoding: of the images, after their conversion.
        unit: of the pixels of the component.
        form: the conversion; None for the images as they are.
    """
    if encoding in _COLOURS or encoding == "mono8":
        make, topic = _jpeg, "image/compressed"
    elif encoding == "16UC1" or (encoding == "32FC1" and unit == "m"):
        make, topic = _depth, "image/compressedDepth"
    else:
        return None
    return Outlet(_TYPE, partial(make, form=form), topic, or_none=True, takes_long=True)


def _jpeg(message: Message, frame: str, form: Form | None) -> RosMessage:
    pixels, encoding = _converted(message, form)
    order = _COLOURS.get(encoding)
    pixels = np.reshape(pixels, pixels.shape[:2]) if order is None else pixels[..., order]
    suffix = "" if order is None else "bgr8"
    data = _file(pixels, "JPEG", quality=_QUALITY)
    return {"header": header(message, frame), "format": f"{encoding}; jpeg compressed {suffix}", "data": data}


def _depth(message: Message, frame: str, form: Form | None) -> RosMessage:
    pixels, encoding = _converted(message, form)
    pixels, numbers = np.reshape(pixels, pixels.shape[:2]), (0.0, 0.0)
    if encoding == "32FC1":
        pixels, numbers = _inverse(pixels)
    data = _DEPTH_HEADER.pack(_INVERSE_DEPTH, *numbers) + _file(pixels, "PNG", compress_level=_LEVEL)
    return {"header": header(message, frame), "format": f"{encoding}; compressedDepth png", "data": data}


def _converted(message: Message, form: Form | None) -> tuple[Any, str]:
    return (message.pixels, message.encoding) if form is None else form(message.pixels, message.encoding)


def _inverse(depth: NDArray[np.float32]) -> tuple[NDArray[np.uint16], tuple[float, float]]:
    """Depth as whole numbers a / depth + b, and the numbers a and b; 0 where there is no depth.

    The range of the numbers is that of the depths of the image: decoders read a and b in each message.
    """
    valid = np.isfinite(depth) & (depth > 0.0)
    if not valid.any():
        return np.zeros(depth.shape, np.uint16), (1.0, 0.0)
    values = depth[valid].astype(np.float64)
    low, high = _RATIOS
    farthest = float(values.max())
    nearest = min(max(float(values.min()), farthest / high), farthest / low)
    a = (_NEAREST - _FARTHEST) / (1.0 / nearest - 1.0 / farthest)
    b = _FARTHEST - a / farthest
    numbers = np.zeros(depth.shape, np.uint16)
    numbers[valid] = np.clip(np.rint(a / values + b), _FARTHEST, _NEAREST)
    return numbers, (a, b)


def _file(pixels: object, kind: str, **options: int) -> bytes:
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels)).save(file, kind, **options)
    return file.getvalue()
