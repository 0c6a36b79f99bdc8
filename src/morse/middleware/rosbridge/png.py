"""Messages of rosbridge as images: its compression ``png``."""

from __future__ import annotations

import base64
import io
import math

import msgspec
from PIL import Image

_CHANNELS = 3


def as_png(frame: str) -> str:
    """A message whose characters are the colours of an image.

    Source: pngcompression.py of rosbridge_suite: RGB, about as high as wide; blanks at the end.
    """
    data = frame.encode()
    width = math.isqrt(max(1, math.ceil(len(data) / _CHANNELS)))
    height = math.ceil(len(data) / (width * _CHANNELS))
    image = Image.frombytes("RGB", (width, height), data.ljust(width * height * _CHANNELS))
    file = io.BytesIO()
    image.save(file, "PNG", compress_level=1)  # in the network thread
    return msgspec.json.encode({"op": "png", "data": base64.b64encode(file.getvalue()).decode()}).decode()
