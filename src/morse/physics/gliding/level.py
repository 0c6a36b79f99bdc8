"""Level faces of boxes."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

#: maximum slope of a level face, for rounding: less than a micrometre per kilometre
_LEVEL = 1e-10


def level_axis(rotation: NDArray[np.float64]) -> int | None:
    """Return the axis of a box that is vertical: 0, 1 or 2; None if no face is level.

    Args:
        rotation: (3, 3) of the box in the world.
    """
    heights = [abs(height) for height in rotation[2].tolist()]
    up = heights.index(max(heights))
    del heights[up]
    return up if max(heights) <= _LEVEL else None
