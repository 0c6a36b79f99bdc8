"""Images of YARP, which are bottles of a fixed form.

Source: yarp/sig/ImageNetworkHeader.h: ``[mat] [pixel type] (size of a pixel, size of the image, padding of rows,
width, height) {pixels}``.
"""

from __future__ import annotations

import struct

import numpy as np

from morse.plugins.yarp.bottle import BLOB, INT32, LIST, VOCAB

#: word of each encoding: yarp::sig::ImageOf<PixelRgba>, <PixelFloat>, <PixelRgbFloat>, <PixelMono16>, …
_TYPES = {
    "rgba8": b"rgba",
    "rgb8": b"rgb\0",
    "mono8": b"mono",
    "16UC1": b"mo16",
    "mono16": b"mo16",
    "32FC1": b"dec\0",
    "32FC3": b"rgb.",
}
ENCODINGS = tuple(_TYPES)
#: rows are padded to a multiple of this number of bytes
_QUANTUM = 8
#: rows from the top to the bottom
_FROM_TOP = 0
_HEADER = struct.Struct("<3i4si4s4i2h3ii")


def encode_image(pixels: np.ndarray, encoding: str) -> bytes:
    """An image.

    Args:
        pixels: (H, W) or (H, W, C), row 0 on top; uint8, uint16 or float32, as the encoding says.
        encoding: one of `ENCODINGS`.
    """
    height, width = pixels.shape[:2]
    rows = np.ascontiguousarray(pixels).reshape(height, -1).view(np.uint8)
    padding = -rows.shape[1] % _QUANTUM
    if padding:
        rows = np.pad(rows, ((0, 0), (0, padding)))
    depth = pixels.dtype.itemsize * int(np.prod(pixels.shape[2:]))
    data = rows.tobytes()
    return (
        _HEADER.pack(
            LIST, 4, VOCAB, b"mat\0", VOCAB, _TYPES[encoding], LIST | INT32, 5, depth, len(data), _QUANTUM, _FROM_TOP,
            width, height, BLOB, len(data),
        )
        + data
    )  # fmt: skip
