"""Opens pictures that may come from anybody."""

from __future__ import annotations

import importlib
import io
import warnings
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from PIL.Image import Image

#: formats of textures, and the modules of Pillow that read them; Pillow reads others by running a program, such as
#: Ghostscript for PostScript
_READERS = {
    "BMP": "Bmp", "DDS": "Dds", "GIF": "Gif", "JPEG": "Jpeg", "JPEG2000": "Jpeg2K", "PNG": "Png", "PPM": "Ppm",
    "SGI": "Sgi", "TGA": "Tga", "TIFF": "Tiff", "WEBP": "WebP",
}  # fmt: skip
_FORMATS = tuple(_READERS)
#: what Pillow calls a JPEG file of a camera with two lenses
_OF_JPEG = "MPO"


@cache
def load_readers() -> None:
    """Import what reads the formats, once: Pillow would import the readers of all formats at the first picture."""
    for name in _READERS.values():
        importlib.import_module(f"PIL.{name}ImagePlugin")


def open_picture(data: bytes) -> Image:
    """Open the content of a file of a picture; its pixels are not decoded.

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
