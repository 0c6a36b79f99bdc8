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
    """Boxes of a wall on z=0; its ends extend by half its thickness.

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


def trim(
    start: tuple[float, float], end: tuple[float, float], openings: Sequence[Opening], thick: float
) -> tuple[list[Part], list[Part]]:
    """Skirting boards on both sides of a wall, and frames around its openings, which keep their full width."""
    line = np.array(end) - np.array(start)
    length, angle = float(np.hypot(*line)), float(np.degrees(np.arctan2(line[1], line[0])))
    skirting, frames, place = [], [], -thick / 2
    # a frame extends a little beyond the end of the wall that it covers
    deep, broad, lip = thick + 0.05, 0.06, 0.003

    def bar(x0: float, x1: float, z0: float, z1: float) -> None:
        frames.append(box(x1 - x0, deep, z1 - z0, 0.006).moved((x0 + x1) / 2, 0, (z0 + z1) / 2))

    def board(x0: float, x1: float) -> None:
        if x1 - x0 > 1e-6:
            skirting.append(box(x1 - x0, thick + 0.024, 0.09).moved((x0 + x1) / 2, 0, 0.045))

    for x0, x1, z0, z1 in sorted(openings):
        bar(x0 - broad, x0 + lip, z0, z1)
        bar(x1 - lip, x1 + broad, z0, z1)
        bar(x0 - broad, x1 + broad, z1 - lip, z1 + broad)
        if z0 > 0:
            bar(x0 - broad, x1 + broad, z0 - broad, z0 + lip)
        else:
            board(place, x0 - broad)
            place = x1 + broad
    board(place, length + thick / 2)
    skirting, frames = ([part.turned(z=angle).moved(*start) for part in parts] for parts in (skirting, frames))
    return skirting, frames


def panes(
    start: tuple[float, float], end: tuple[float, float], openings: Sequence[Opening], thick: float
) -> list[Part]:
    """A sheet in each opening of a wall that does not reach the floor."""
    line = np.array(end) - np.array(start)
    angle = float(np.degrees(np.arctan2(line[1], line[0])))
    sheets = [
        box(x1 - x0, thick, z1 - z0).moved((x0 + x1) / 2, 0, (z0 + z1) / 2) for x0, x1, z0, z1 in openings if z0 > 0
    ]
    return [part.turned(z=angle).moved(*start) for part in sheets]
