"""Examines the pictures of a model before their pixels are decoded."""

from __future__ import annotations

import io
import os
import warnings
from typing import Any

#: pixels of a picture; its file may be a thousand times smaller than its pixels
MOST_PIXELS = 1 << 26
_SUFFIXES = (".bmp", ".dds", ".gif", ".jpeg", ".jpg", ".ktx2", ".png", ".tga", ".tif", ".tiff", ".webp")


def is_picture(name: str) -> bool:
    """Whether the name of a file is that of a picture."""
    return os.path.splitext(name.strip().lower())[1] in _SUFFIXES


def mistake_in(data: bytes) -> str:
    """Return why a file is no picture that can be used; empty if it can be used."""
    from PIL import Image, UnidentifiedImageError

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            with Image.open(io.BytesIO(data)) as picture:
                return too_large(picture)
    except UnidentifiedImageError:
        return "it is not a picture, or of an unknown format"
    except Exception as error:  # Pillow's readers raise many kinds of errors for damaged files
        return f"{error!s:.100}"


def too_large(picture: Any) -> str:
    """Return a text if a picture has too many pixels, else an empty one."""
    if picture.width * picture.height <= MOST_PIXELS:
        return ""
    return f"it has {picture.width} x {picture.height} pixels, more than {MOST_PIXELS}"
