"""Images that are put together from several: rows that are exposed apart, and instants of an exposure."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.rendering.light_codes import LIGHT, encoded

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.rendering.lens import Lens
    from morse.rendering.picture import Picture


@lru_cache(maxsize=256)
def cropped(lens: Lens, first: int, last: int) -> Lens:
    """Return the lens of some rows of an image."""
    return replace(lens, height=last - first, cy=lens.cy - first)


def averaged(pictures: Sequence[Picture]) -> Picture:
    """Return the mean light of images; depth, ids and normals are those of the middle one."""
    middle = pictures[len(pictures) // 2]
    if len(pictures) == 1 or middle.rgba is None:
        return middle
    light = np.zeros((*middle.rgba.shape[:2], 3), np.float32)
    for picture in pictures:
        light += LIGHT[picture.rgb]
    rgba = middle.rgba.copy()
    rgba[..., :3] = encoded(light * np.float32(1 / len(pictures)))
    return middle._replace(rgba=rgba)


def joined(bands: Sequence[Picture]) -> Picture:
    """Return the image of its bands of rows."""
    parts: dict[str, Any] = {
        name: None if getattr(bands[0], name) is None else np.concatenate([getattr(band, name) for band in bands])
        for name in ("rgba", "depth", "ids", "normals")
    }
    return bands[-1]._replace(**parts)
