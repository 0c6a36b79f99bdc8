"""Opens pictures that may come from anybody: their cost is known before their pixels are decoded.

The headers of PNG and JPEG files, which nearly all textures are, tell the cost, and they are decoded in this process.
All other formats are decoded in a process with limits, and become PNG files.

The process is ``python -m morse.system.pictures``. A small TIFF file can contain gigabytes of tags, a GIF comments that
take quadratic time; JPEG 2000 takes 130 ns for a pixel. The question is the content of a file, the answer a byte 1 and
the same picture as PNG (or TIFF, which has more kinds of pixels), or a byte 0 and the reason in UTF-8.
"""

from __future__ import annotations

import importlib
import io
import re
import struct
import warnings
from functools import cache
from typing import TYPE_CHECKING

from morse.system.regular_files import MOST_MEMORY, MOST_SECONDS, budget_of_file
from morse.system.workers import Server, limit_resources, serve_program

if TYPE_CHECKING:
    from PIL.Image import Image


#: pixels of a picture; a file may be a thousand times smaller than its pixels
MOST_PIXELS = 1 << 27
#: formats of textures, and the modules of Pillow that read them; Pillow reads others by running a program, such as
#: Ghostscript for PostScript
_READERS = {
    "BMP": "Bmp", "DDS": "Dds", "GIF": "Gif", "JPEG": "Jpeg", "JPEG2000": "Jpeg2K", "PNG": "Png", "PPM": "Ppm",
    "SGI": "Sgi", "TGA": "Tga", "TIFF": "Tiff", "WEBP": "WebP",
}  # fmt: skip
_FORMATS = tuple(_READERS)
#: what Pillow calls a JPEG file of a camera with two lenses
_OF_JPEG = "MPO"
_PNG, _JPEG = b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff"
#: parts of a file, bytes of Exif data, and of all parts without pixels: Pillow joins them again and again
_MOST_PARTS, _MOST_EXIF, _MOST_OTHERS = 100_000, 1 << 16, 16 << 20
#: scans of a progressive JPEG file that cost as much as decoding its pixels once; programs write up to 10
_SCANS = 10
#: the next marker of a JPEG file after pixels: neither a byte of them nor a mark within
_MARKER = re.compile(rb"\xff[^\x00\xd0-\xd7\xff]")
_FRAMES = {*range(0xC0, 0xD0)} - {0xC4, 0xC8, 0xCC}
_START_OF_SCAN, _END, _APP1, _OTHERS = 0xDA, 0xD9, 0xE1, range(0xE0, 0xFF)
_ORIENTATION = 0x0112


@cache
def load_readers() -> None:
    """Import what reads the formats, once: Pillow would import the readers of all formats at the first picture."""
    for name in _READERS.values():
        importlib.import_module(f"PIL.{name}ImagePlugin")


def open_picture(data: bytes) -> Image:
    """Open the content of a file of a picture; its pixels are not decoded.

    Raises:
        ValueError: see `readable_picture`.
    """
    return opened(readable_picture(data))


def readable_picture(data: bytes) -> bytes:
    """The content of a file of a picture whose pixels this process can decode: that of a PNG or JPEG file as it is.

    Raises:
        ValueError: it is damaged, has too many pixels, costs too much to decode, or is of another format, whatever its
            name.
    """
    with budget_of_file() as budget:
        if data.startswith((_PNG, _JPEG)):
            budget.take_pixels(_cost(data))
            return data
        budget.take_bytes(len(data))
        try:
            answer = budget.decoded(data)
        except OSError as error:
            raise ValueError(f"no process can decode it: {error.strerror}") from None
        if answer[:1] != b"\1":
            raise ValueError(answer[1:].decode("utf-8", "replace") or "it cannot be decoded")
        return answer[1:]


def opened(data: bytes) -> Image:
    """Open the content of a file in this process.

    Raises:
        ValueError: it is damaged, has far too many pixels, or is of another format, whatever its name.
    """
    from PIL import Image, UnidentifiedImageError

    load_readers()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return Image.open(io.BytesIO(data), formats=_FORMATS)
    except UnidentifiedImageError:
        raise ValueError("it is not a picture, or of an unknown format") from None
    except Exception as error:  # Pillow's readers raise many kinds of errors for damaged files
        raise ValueError(f"{error!s:.100}") from None


def run_no_programs() -> None:
    """Let Pillow run no program in this process, also for a library that opens pictures itself."""
    from PIL import EpsImagePlugin

    EpsImagePlugin.gs_binary = False


def is_usable(picture: Image) -> bool:
    """Whether a picture that another program has opened is of one of these formats, or of none: it has pixels only."""
    return picture.format in (None, _OF_JPEG, *_FORMATS)


def orientation_of(picture: Image) -> int:
    """The orientation in the Exif data of a picture: 1 if it is upright, or has none.

    Pillow would read all tags, each of which may be as large as all data.
    """
    data: object = picture.info.get("exif")
    if not isinstance(data, bytes):
        return 1
    data = data.removeprefix(b"Exif\0\0")
    order = {b"II": "<", b"MM": ">"}.get(data[:2])
    if order is None or len(data) < 8:
        return 1
    (begin,) = struct.unpack_from(f"{order}I", data, 4)
    if begin + 2 > len(data):
        return 1
    (count,) = struct.unpack_from(f"{order}H", data, begin)
    for place in range(begin + 2, min(begin + 2 + 12 * count, len(data) - 11), 12):
        tag, kind, _, value = struct.unpack_from(f"{order}HHIH", data, place)
        if tag == _ORIENTATION and kind == 3:
            return int(value)
    return 1


# -- cost ------------------------------------------------------------------------------------


def _cost(data: bytes) -> int:
    """The number of pixels whose decoding takes as long as that of a PNG or JPEG file; of a damaged one up to there.

    Raises:
        ValueError: it is too high.
    """
    width, height, scans = _of_png(data) if data.startswith(_PNG) else _of_jpeg(data)
    if width * height > MOST_PIXELS:
        raise ValueError(f"it has {width} x {height} pixels, more than {MOST_PIXELS}")
    cost = -(-width * height * max(scans, _SCANS) // _SCANS)
    if cost > MOST_PIXELS:
        raise ValueError(f"it has {scans} scans of {width} x {height} pixels: save it again, with 10 scans at most")
    return cost


def _of_png(data: bytes) -> tuple[int, int, int]:
    """Width and height, and the number of scans."""
    place, parts, others, size = len(_PNG), 0, 0, (0, 0)
    while place + 8 <= len(data):
        length, name = struct.unpack_from(">I4s", data, place)
        if name == b"IHDR" and length >= 8 and place + 16 <= len(data):
            size = struct.unpack_from(">II", data, place + 8)
        elif name == b"eXIf" and length > _MOST_EXIF:
            raise ValueError(f"it has {length} bytes of Exif data, more than {_MOST_EXIF}")
        elif name not in (b"IDAT", b"fdAT"):
            others += length
        place, parts = place + 12 + length, parts + 1
        _check_parts(parts, others)
    return size[0], size[1], 1


def _of_jpeg(data: bytes) -> tuple[int, int, int]:
    """Width and height, and the number of scans."""
    place, parts, scans, others, exif, width, height = 2, 0, 0, 0, 0, 0, 0
    while (found := _MARKER.search(data, place)) is not None:
        kind, place = data[found.end() - 1], found.end()
        if kind == _END:
            break
        if place + 2 > len(data):
            break
        (length,) = struct.unpack_from(">H", data, place)
        if kind in _FRAMES and place + 7 <= len(data):
            high, wide = struct.unpack_from(">HH", data, place + 3)
            width, height = max(width, wide), max(height, high)
        elif kind == _START_OF_SCAN:
            scans += 1
        elif kind in _OTHERS:
            others += length
            exif += length if kind == _APP1 and data[place + 2 : place + 6] == b"Exif" else 0
        place, parts = place + length, parts + 1
        if exif > _MOST_EXIF:
            raise ValueError(f"it has {exif} bytes of Exif data, more than {_MOST_EXIF}")
        _check_parts(parts, others)
    return width, height, scans


def _check_parts(parts: int, others: int) -> None:
    if parts > _MOST_PARTS or others > _MOST_OTHERS:
        raise ValueError(
            f"it has more than {_MOST_PARTS} parts, or {_MOST_OTHERS >> 20} MiB beside its pixels: save it again"
        )


#: pixels of a picture
_MOST_PIXELS = 1 << 26
#: modes that a PNG file has, and those of numbers, which are heights
_PNG_MODES, _TIFF_MODES = ("1", "L", "LA", "I;16", "P", "RGB", "RGBA"), ("I", "F", "I;16B")


class Decoder(Server):
    """Decodes pictures."""

    def answer(self, question: bytes) -> bytes:
        """Decode a picture."""
        try:
            with opened(question) as picture:
                if picture.width * picture.height > _MOST_PIXELS:
                    raise ValueError(f"it has {picture.width} x {picture.height} pixels, more than {_MOST_PIXELS}")
                picture.load()
                plain = picture
                if picture.mode not in (*_PNG_MODES, *_TIFF_MODES):
                    plain = picture.convert("RGBA" if "A" in picture.getbands() else "RGB")
                for name in ("icc_profile", "exif", "xmp", "comment"):
                    plain.info.pop(name, None)
                result = io.BytesIO()
                if plain.mode in _TIFF_MODES:
                    plain.save(result, "TIFF")
                else:
                    plain.save(result, "PNG", compress_level=1)
                return b"\1" + result.getvalue()
        except Exception as error:  # Pillow's readers raise many kinds of errors for damaged pictures
            return b"\0" + f"{error!s:.100}".encode()


def main() -> None:
    """Decode the pictures of the process that has started this one."""
    load_readers()
    limit_resources(MOST_SECONDS, MOST_MEMORY)
    serve_program(Decoder, watches=False)


if __name__ == "__main__":
    main()
