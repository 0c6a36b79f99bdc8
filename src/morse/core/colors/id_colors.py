"""Ids and directions as colours."""

from __future__ import annotations

import colorsys
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils import portable

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: shortest length of a vector with a full colour, px: the rounding errors of a scene at rest have none
_SHORTEST = 0.1
#: the golden ratio: consecutive hues differ strongly
_STEP = 0.6180339887


@cache
def _palette(size: int) -> NDArray[np.uint8]:
    colors = [
        colorsys.hsv_to_rgb(i * _STEP % 1.0, (0.75, 0.5)[i // 8 % 2], (0.95, 0.7)[i // 16 % 2]) for i in range(size)
    ]
    bytes_of_colors = np.round(np.array(colors) * 255).astype(np.uint8)
    bytes_of_colors[0] = 0
    return bytes_of_colors


def as_colors(ids: NDArray[np.integer]) -> NDArray[np.uint8]:
    """(H, W, 3) a colour for each id, black for 0."""
    size = 1 << int(ids.max(initial=0)).bit_length()
    return np.asarray(_palette(size)[ids], np.uint8)


def as_directions(flow: NDArray[np.floating]) -> NDArray[np.uint8]:
    """Colours (H, W, 3) of vectors (H, W, 2): the hue is the direction, and the saturation grows with the length.

    Pixels without a vector are black, pixels at rest are white.
    """
    is_known = np.isfinite(flow).all(axis=2)
    x, y = (np.where(is_known, flow[..., axis], 0.0).astype(np.float64) for axis in range(2))
    length = np.hypot(x, y)
    share = length / max(float(length.max(initial=0.0)), _SHORTEST)
    hue = portable.arctan2(y, x)
    # three cosines, shifted by a third of a turn
    colors = [1.0 - share * (0.5 - 0.5 * portable.cos(hue - third)) for third in (0.0, 2.0944, 4.1888)]
    pixels = np.round(np.stack(colors, axis=-1) * 255).astype(np.uint8)
    pixels[~is_known] = 0
    return pixels
