"""Converts Truevision TGA images to PNG, because browsers do not show TGA.

Reads true-colour images of 24 and 32 bits per pixel, uncompressed and run-length encoded. Source: Truevision TGA File
Format Specification, version 2.0 (1991).
"""

from __future__ import annotations

import struct
import zlib
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: size of the header, bytes
HEADER_SIZE = 18
_HEADER = struct.Struct("<BBB5xHHHHBB")
_TRUE_COLOR, _RUN_LENGTH = 2, 10
#: maximum number of pixels of an image
_MAX_PIXELS = 1 << 25
#: maximum number of run-length packets of an image; this number takes 0.5 s
_MAX_PACKETS = 1 << 21
_RIGHT_TO_LEFT, _TOP_FIRST, _INTERLEAVED = 0x10, 0x20, 0xC0
_ALPHA_BITS = 0x0F
_PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_RGB, _RGBA = 2, 6


class TargaError(ValueError):
    """The image is damaged, too large, or of an unsupported kind."""


class _Header(NamedTuple):
    """The relevant fields of the header; ``channels`` is the number of bytes per pixel."""

    start: int
    compressed: bool
    width: int
    height: int
    channels: int
    flags: int


def is_targa(head: bytes) -> bool:
    """Whether the first `HEADER_SIZE` bytes of a file can be those of an image that `png_of` reads."""
    try:
        _header(head)
    except TargaError:
        return False
    return True


def png_of(data: bytes) -> bytes:
    """The image of a TGA file as the bytes of a PNG file.

    Raises:
        TargaError: the file is damaged, has more than 33 million pixels, or is of another kind.
    """
    header = _header(data)
    size = header.width * header.height * header.channels
    body = _unpacked(data, header, size) if header.compressed else data[header.start : header.start + size]
    if len(body) < size:
        raise TargaError("it is cut off")
    pixels = np.frombuffer(body, np.uint8).reshape(header.height, header.width, header.channels)
    if not header.flags & _TOP_FIRST:
        pixels = pixels[::-1]
    if header.flags & _RIGHT_TO_LEFT:
        pixels = pixels[:, ::-1]
    # stored as blue, green, red and alpha; without alpha bits, the fourth byte has no meaning
    has_alpha = header.channels == 4 and header.flags & _ALPHA_BITS
    return _png(pixels[:, :, [2, 1, 0, 3] if has_alpha else [2, 1, 0]])


def _header(head: bytes) -> _Header:
    if len(head) < HEADER_SIZE:
        raise TargaError("it is cut off")
    id_size, has_map, kind, _x, _y, width, height, bits, flags = _HEADER.unpack_from(head)
    if has_map or kind not in (_TRUE_COLOR, _RUN_LENGTH) or bits not in (24, 32) or flags & _INTERLEAVED:
        raise TargaError("it is not a true-colour TGA image of 24 or 32 bits")
    if (flags & _ALPHA_BITS) not in ((0,) if bits == 24 else (0, 8)):
        raise TargaError(f"it has {flags & _ALPHA_BITS} alpha bits in {bits} bits")
    if not 0 < width * height <= _MAX_PIXELS:
        raise TargaError(f"it has {width} x {height} pixels; at least 1 and at most {_MAX_PIXELS} are read")
    return _Header(HEADER_SIZE + id_size, kind == _RUN_LENGTH, width, height, bits // 8, flags)


def _unpacked(data: bytes, header: _Header, size: int) -> bytearray:
    """The pixels of a run-length encoded image."""
    channels, at, position = header.channels, header.start, 0
    result = bytearray(size)
    for _ in range(_MAX_PACKETS):
        if position >= size:
            return result
        if at >= len(data):
            break
        count = (data[at] & 0x7F) + 1
        run = data[at] & 0x80
        length = channels if run else channels * count
        values = data[at + 1 : at + 1 + length]
        if len(values) < length or position + channels * count > size:
            break
        result[position : position + channels * count] = values * count if run else values
        position += channels * count
        at += 1 + length
    if position >= size:
        return result
    raise TargaError("its run-length encoding is damaged, or has too many packets")


def _png(pixels: NDArray[np.uint8]) -> bytes:
    """The bytes of a PNG file; pixels (H, W, 3 or 4), 8 bits, top row first."""
    height, width, channels = pixels.shape
    # each row begins with the number of its filter: 0, none
    rows = np.zeros((height, 1 + width * channels), np.uint8)
    rows[:, 1:] = pixels.reshape(height, -1)
    head = struct.pack(">IIBBBBB", width, height, 8, _RGBA if channels == 4 else _RGB, 0, 0, 0)
    chunks = ((b"IHDR", head), (b"IDAT", zlib.compress(rows.tobytes(), 3)), (b"IEND", b""))
    return _PNG_SIGNATURE + b"".join(
        struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
        for kind, content in chunks
    )
