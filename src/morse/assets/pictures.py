"""The pictures of a model: examined before their pixels are decoded, decoded once, converted from TGA, or replaced.

Browsers do not show TGA: true-colour images of 24 and 32 bits per pixel, uncompressed and run-length encoded, become
PNG. Source: Truevision TGA File Format Specification, version 2.0 (1991).
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import io
import os
import struct
import zlib
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.scene import Image
from morse.system.pictures import is_usable, opened, orientation_of, readable_picture

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


#: size and pixels of a square of the pattern; its two colours
_SIZE, _SQUARE = 16, 4
_COLOURS = ((255, 255, 255), (255, 0, 255))


@functools.cache
def chequered() -> bytes:
    """Return a chequered pattern in white and magenta, 16 x 16 pixels, PNG."""
    from PIL import Image

    pattern = Image.new("RGB", (_SIZE, _SIZE))
    squares = ((x, y) for y in range(_SIZE) for x in range(_SIZE))
    pattern.putdata([_COLOURS[(x // _SQUARE + y // _SQUARE) % 2] for x, y in squares])
    file = io.BytesIO()
    pattern.save(file, "PNG")
    return file.getvalue()


#: pixels of a picture, and of all pictures of a model; a file may be a thousand times smaller than its pixels
MOST_PIXELS, MOST_PIXELS_TOGETHER = 1 << 26, 1 << 28
_SUFFIXES = (".bmp", ".dds", ".gif", ".jpeg", ".jpg", ".ktx2", ".png", ".tga", ".tif", ".tiff", ".webp")
#: formats and modes that need not be converted for browsers
_SHOWN = {"PNG": "image/png", "JPEG": "image/jpeg"}
_MODES = ("1", "L", "LA", "P", "RGB", "RGBA")
#: the conversion of a pixel takes as long as decoding so many pixels
_CONVERSION = 8


def is_picture(name: str) -> bool:
    """Whether the name of a file is that of a picture."""
    return os.path.splitext(name.strip().lower())[1] in _SUFFIXES


def usable_picture(data: bytes) -> bytes:
    """The content of a picture as that of a PNG or JPEG file.

    Raises:
        ValueError: it cannot be used.
    """
    if is_targa(data[:HEADER_SIZE]):
        # models of Gazebo have many of these; their cost is known, and no process is needed
        with contextlib.suppress(TargaError):
            data = png_of(data)
    data = readable_picture(data)
    with opened(data) as picture:
        if mistake := _mistake(picture):
            raise ValueError(mistake)
    return data


def _mistake(picture: Any) -> str:
    if not is_usable(picture):
        return f"pictures of the format {picture.format!s:.20} are not read"
    if picture.width * picture.height <= MOST_PIXELS:
        return ""
    return f"it has {picture.width} x {picture.height} pixels, more than {MOST_PIXELS}"


class Pictures:
    """Converts the pictures of a model; equal ones, whatever their names, become one image.

    Attributes:
        warnings: pictures that a chequered pattern replaces.
    """

    def __init__(self) -> None:
        self._images: dict[bytes, Image] = {}
        self._pixels = 0
        self.warnings: list[str] = []

    def image(self, name: str, picture: object) -> Image:
        """The image of a picture of Pillow; a chequered pattern if it is damaged or too large.

        Args:
            name: name of the material.
            picture: its pixels are not decoded yet.
        """
        data = _encoded(picture)
        key = hashlib.blake2b(data, digest_size=16).digest() if data else id(picture).to_bytes(16, "big")
        if key not in self._images:
            self._images[key] = self._converted(name, picture, data)
        return self._images[key]

    def _converted(self, name: str, picture: Any, data: bytes) -> Image:
        mistake = _mistake(picture)
        if data and not mistake:
            try:
                # a copy is decoded, so that the pixels do not stay in memory
                data = readable_picture(data)
                picture = opened(data)
            except ValueError as error:
                mistake = str(error)
        mime = _SHOWN.get(str(picture.format), "") if data and picture.mode in _MODES else ""
        pixels = picture.width * picture.height * (1 if mime else _CONVERSION)
        if not mistake and self._pixels + pixels > MOST_PIXELS_TOGETHER:
            mistake = (
                f"with it, the pictures of the model have more than {MOST_PIXELS_TOGETHER} pixels together (a pixel "
                f"of a file that is neither PNG nor JPEG counts {_CONVERSION} times)"
            )
        if not mistake:
            self._pixels += pixels
            try:
                picture.load()
                if mime and _is_plain(picture):
                    return Image(name, data, mime)
                buffer = io.BytesIO()
                picture.convert("RGBA" if "A" in picture.getbands() else "RGB").save(buffer, "PNG", compress_level=1)
                return Image(name, buffer.getvalue(), "image/png")
            except Exception as error:  # Pillow's readers raise many kinds of errors for damaged pictures
                mistake = f"{error!s:.100}"
        self.warnings.append(f"the picture of the material '{name:.80}' is replaced by a chequered pattern: {mistake}")
        return Image(name, chequered(), "image/png")


def _encoded(picture: object) -> bytes:
    """The file of a picture; empty if it is not known."""
    file = getattr(picture, "fp", None)
    return file.getvalue() if isinstance(file, io.BytesIO) else b""


def _is_plain(picture: Any) -> bool:
    """Whether browsers show a decoded picture as other programs do: without a colour profile or an orientation."""
    return "icc_profile" not in picture.info and orientation_of(picture) == 1
