"""Walls with doors and windows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from common.shapes import box

if TYPE_CHECKING:
    from collections.abc import Sequence

    from common.parts import Part

Opening = tuple[float, float, float, float]


def wall(
    start: tuple[float, float], end: tuple[float, float], openings: Sequence[Opening], thick: float, height: float
) -> list[Part]:
    """Boxes of a wall on z=0; its ends reach half its thickness further.

    Args:
        openings: start and end along the wall, lower and upper edge, m.
    """
    line = np.array(end) - np.array(start)
    length, angle = float(np.hypot(*line)), float(np.degrees(np.arctan2(line[1], line[0])))
    parts, place = [], -thick / 2

    def piece(x0: float, x1: float, z0: float, z1: float) -> None:
        if x1 - x0 > 1e-6 and z1 - z0 > 1e-6:
            parts.append(box(x1 - x0, thick, z1 - z0).moved((x0 + x1) / 2, 0, (z0 + z1) / 2))

    for x0, x1, z0, z1 in sorted(openings):
        piece(place, x0, 0.0, height)
        piece(x0, x1, 0.0, z0)
        piece(x0, x1, z1, height)
        place = x1
    piece(place, length + thick / 2, 0.0, height)
    return [part.turned(z=angle).moved(*start) for part in parts]
