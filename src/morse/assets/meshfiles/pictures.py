"""The pictures of a model: examined before their pixels are decoded, decoded once."""

from __future__ import annotations

import contextlib
import hashlib
import io
import os
from typing import Any

from morse.assets import targa
from morse.assets.missing_picture import chequered
from morse.scene import Image
from morse.system.pictures import is_usable, opened, orientation_of, readable_picture

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
    if targa.is_targa(data[: targa.HEADER_SIZE]):
        # models of Gazebo have many of these; their cost is known, and no process is needed
        with contextlib.suppress(targa.TargaError):
            data = targa.png_of(data)
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
