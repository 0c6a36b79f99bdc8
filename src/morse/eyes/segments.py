"""What pictures show by the flags of a scene: light, or a colour for each geom."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.eyes.picture import Artist, Geoms, View

_SEGMENT, _IDCOLOR = int(mujoco.mjtRndFlag.mjRND_SEGMENT), int(mujoco.mjtRndFlag.mjRND_IDCOLOR)
#: MuJoCo leaves out the first terms of the sequences, and very dark and very light colours
_FIRST, _DARK, _SPAN = 10, 0.1, 0.8


def shown(artist: Artist, scene: Any, geoms: Geoms, view: View) -> NDArray[np.uint8]:
    """Return a picture (H, W, 3) as `mujoco.mjr_render` draws it.

    With ``mjRND_SEGMENT``, each geom has one colour, and the background is black. The colour is ``segid + 1`` in
    little-endian bytes with ``mjRND_IDCOLOR``, else terms of the Halton sequences of 2, 3 and 5.
    """
    if not scene.flags[_SEGMENT]:
        return artist.colors(scene, geoms, view)
    numbers = artist.segments(scene, geoms, view) + 1
    if scene.flags[_IDCOLOR]:
        return np.stack([numbers & 255, numbers >> 8 & 255, numbers >> 16 & 255], axis=-1).astype(np.uint8)
    used, index = np.unique(numbers, return_inverse=True)
    return np.array([_color(int(number)) for number in used], np.uint8)[index.reshape(numbers.shape)]


@cache
def _color(number: int) -> tuple[int, int, int]:
    """The colour of the geom ``segid + 1``; black for 0, the background."""
    if not number:
        return 0, 0, 0
    red, green, blue = (
        round(255 * (_DARK + _SPAN * mujoco.mju_Halton(number - 1 + _FIRST, base))) for base in (2, 3, 5)
    )
    return red, green, blue
