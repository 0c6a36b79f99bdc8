"""Level faces of boxes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: maximum slope of a level face, for rounding: less than a micrometre per kilometre
_LEVEL = 1e-10


def level_axis(rotation: NDArray[np.float64]) -> int | None:
    """Return the axis of a box that is vertical: 0, 1 or 2; None if no face is level.

    Args:
        rotation: (3, 3) of the box in the world.
    """
    up = int(np.argmax(np.abs(rotation[2])))
    return up if np.abs(np.delete(rotation[2], up)).max() <= _LEVEL else None
