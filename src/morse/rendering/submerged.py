"""The light under water, as the live view shows it: blue-green, darker with the depth, and dense as mist."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: colour of clear sea water near the surface, linear RGB
_TINT = np.array([0.012, 0.155, 0.2])
#: m: depth at which a quarter of the light is left, and distance at which water hides everything
_DARKER, _SIGHT = 16.0, 26.0


def submerged(sky: NDArray[np.float32], depth: float) -> NDArray[np.float32]:
    """Return the sky (20,) of a camera under water; see `morse.kernel.drawing.Light`.

    Args:
        sky: above the water.
        depth: of the camera, m.
    """
    under = sky.copy()
    water = _TINT / (1.0 + depth / _DARKER) ** 2
    for begin, share in ((0, 1.0), (3, 2.2), (6, 0.35), (9, 0.0)):  # all around, up, down, around the sun
        under[begin : begin + 3] = water * share
    under[15:17] = 0.0, _SIGHT
    return under
