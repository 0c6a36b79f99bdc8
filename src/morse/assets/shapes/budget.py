"""Approximate convex decomposition with a budget, for meshes that move.

As in K. Mamou, "Volumetric hierarchical approximate convex decomposition" (Game Engine Gems 3, 2016), the volume is cut
by planes along the axes, each time the part whose hull is too large by most, where the hulls of its halves become
smallest. A part is only cut if the error is worth a further shape.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from morse.assets.shapes.parts import directions, hull_part
from morse.mathutils.portable import matmul

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.assets.shapes.parts import ConvexPart

    Floats = NDArray[np.float64]


#: cells along the longest side
_CELLS = 32
#: samples of all triangles together
_MOST_SAMPLES = 400_000


def filled_cells(corners: Floats) -> tuple[Floats, NDArray[np.bool_], float]:
    """Return the centres (N, 3) of the cells on and inside a surface, m, which of them are inside, and the width, m.

    A cell is inside if no path along the axes leads from it out of the grid without a cell of the surface. The inside
    of an open surface is therefore empty.

    Args:
        corners: (T, 3, 3) corners of triangles, m.
    """
    low = corners.min(axis=(0, 1))
    span = corners.max(axis=(0, 1)) - low
    width = float(span.max()) / _CELLS
    # one empty cell on each side, through which the outside is connected
    shape = tuple(int(side) + 3 for side in np.ceil(span / width))
    surface = np.zeros(shape, dtype=bool)
    for points in _samples(corners, 0.5 * width):
        x, y, z = np.clip(((points - low) / width).astype(np.int64) + 1, 1, np.array(shape) - 2).T
        surface[x, y, z] = True
    cells = np.argwhere(~_outside(surface))
    return low + (cells - 0.5) * width, ~surface[tuple(cells.T)], width


def _samples(corners: Floats, distance: float) -> list[Floats]:
    """Points on triangles, no farther from each other than a distance, m, unless they are too many."""
    along = corners - np.roll(corners, -1, axis=1)
    edges = np.sqrt((along * along).sum(axis=2)).max(axis=1)
    counts = np.ceil(edges / distance).astype(np.int64)
    counts = np.minimum(np.maximum(counts, 1), max(1, int((2.0 * _MOST_SAMPLES / len(corners)) ** 0.5)))
    samples = []
    for count in np.unique(counts).tolist():
        a, b, c = np.moveaxis(corners[counts == count], 1, 0)
        i, j = np.divmod(np.arange((count + 1) ** 2), count + 1)
        inside = i + j <= count
        u, v = (i[inside] / count)[:, None, None], (j[inside] / count)[:, None, None]
        samples.append((a + u * (b - a) + v * (c - a)).reshape(-1, 3))
    return samples


def _outside(surface: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which cells are connected with the first one."""
    outside = np.zeros_like(surface)
    outside[0, 0, 0] = True
    count = 0
    while count != (count := int(outside.sum())):
        for axis in range(3):
            for way in (1, -1):
                layers = np.moveaxis(outside, axis, 0)[::way]
                walls = np.moveaxis(surface, axis, 0)[::way]
                for above, below, wall in zip(layers[1:], layers[:-1], walls[1:], strict=True):
                    above |= below & ~wall
    return outside


#: share of the volume of the hull of a mesh by which the hull of a part may be too large
_WORTH = 0.01
#: directions in which hulls are measured, candidates for a cut along each axis, points at which volumes are counted
_DIRECTIONS, _CUTS, _POINTS = 90, 7, 2000
#: vertices of a hull: contacts between hulls take time for each
_VERTICES = 64


@dataclass(eq=False, slots=True)
class _Cell:
    """What lies between the planes of cuts.

    Attributes:
        corners: (T, 3, 3) triangles, m.
        inner: (N, 3) centres of the filled cells, m.
        deep: (N,) which of them the surface does not cross.
        low, high: (3,) the planes, m.
        cut: axis and position of the best cut; None if there is none.
        volume: volume of the hull, m³.
        excess: volume, m³, by which the hull is larger than the filled cells.
    """

    corners: Floats
    inner: Floats
    deep: NDArray[np.bool_]
    low: Floats
    high: Floats
    cut: tuple[int, float] | None = None
    volume: float = 0.0
    excess: float = 0.0


def decomposed(corners: Floats, budget: int) -> list[ConvexPart]:
    """Return convex parts that cover triangles (T, 3, 3), m, and what they enclose.

    Args:
        budget: maximum number of parts.
    """
    inner, deep, width = filled_cells(corners)
    whole = _Cell(corners, inner, deep, corners.min(axis=(0, 1)), corners.max(axis=(0, 1)))
    _measure(whole, width)
    least, cells = _WORTH * whole.volume, [whole]
    while len(cells) < budget:
        worst = max(cells, key=lambda cell: cell.excess)
        if worst.excess < least:
            break
        halves = _halves(worst)
        for half in halves:
            _measure(half, width)
        place = cells.index(worst)
        cells[place : place + 1] = halves
    return [_hull(cell, width) for cell in cells if len(cell.corners)]


def _measure(cell: _Cell, width: float) -> None:
    """Find the best cut of a cell."""
    if len(cell.inner) < 2:
        return
    outward = directions(_DIRECTIONS)
    heights = matmul(cell.inner, outward.T)
    low, high = cell.inner.min(axis=0), cell.inner.max(axis=0)
    probes = _grid(low, high, width)
    reach = matmul(probes, outward.T)
    # a centre stands for a volume; without a margin, rounding would decide
    margin = 1e-6 * width
    inside = (reach <= heights.max(axis=0) + margin).all(axis=1)
    unit = float(np.prod(high - low + width)) / len(probes)
    cell.volume = unit * int(inside.sum())
    volume = len(cell.inner) * width**3
    smallest = np.inf
    for axis in range(3):
        for place in _places(low[axis], high[axis], width):
            left, probes_left = cell.inner[:, axis] < place, probes[:, axis] < place
            if left.all() or not left.any():
                continue
            count = 0
            for side, probe in ((left, probes_left), (~left, ~probes_left)):
                count += int((reach[probe] <= heights[side].max(axis=0) + margin).all(axis=1).sum())
            if unit * count < smallest:
                smallest, cell.cut = unit * count, (axis, place)
    if cell.cut is not None:
        cell.excess = cell.volume - volume


def _places(low: float, high: float, width: float) -> list[float]:
    """Planes between the layers of cells, spread evenly."""
    layers = round((high - low) / width)
    numbers = np.unique(np.linspace(0, layers, _CUTS + 2).round().astype(np.int64)[1:-1])
    return [low + (number + 0.5) * width for number in numbers.tolist() if number < layers]


def _grid(low: Floats, high: Floats, width: float) -> Floats:
    """Points (P, 3) of a regular grid in a box, at the centres of equal cells."""
    span = np.maximum(high - low, width)
    step = max(float(np.prod(span) / _POINTS) ** (1.0 / 3.0), width)
    counts = np.maximum((span / step).round().astype(np.int64), 1)
    axes = [low[k] + (np.arange(counts[k]) + 0.5) * ((high[k] - low[k]) / counts[k]) for k in range(3)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def _halves(cell: _Cell) -> list[_Cell]:
    assert cell.cut is not None
    axis, place = cell.cut
    left = cell.inner[:, axis] < place
    below, above = cell.high.copy(), cell.low.copy()
    below[axis] = above[axis] = place
    return [
        _Cell(_clipped(cell.corners, axis, place, 1.0), cell.inner[left], cell.deep[left], cell.low, below),
        _Cell(_clipped(cell.corners, axis, place, -1.0), cell.inner[~left], cell.deep[~left], above, cell.high),
    ]


def _clipped(corners: Floats, axis: int, place: float, sign: float) -> Floats:
    """The parts of triangles (T, 3, 3) below a plane, or above it if the sign is negative."""
    depth = sign * (place - corners[:, :, axis])
    inside = depth >= 0.0
    number = inside.sum(axis=1)
    result = [corners[number == 3]]
    for count in (1, 2):
        is_outside = number == count
        some, deep = corners[is_outside], depth[is_outside]
        # the corner that is alone on its side comes first
        alone = (inside[is_outside] == (count == 1)).argmax(axis=1)
        order = (alone[:, None] + np.arange(3)) % 3
        rows = np.arange(len(some))[:, None]
        a, b, c = np.moveaxis(some[rows, order], 1, 0)
        da, db, dc = deep[rows, order].T
        ab = a + (b - a) * (da / (da - db))[:, None]
        ac = a + (c - a) * (da / (da - dc))[:, None]
        if count == 1:
            result.append(np.stack([a, ab, ac], axis=1))
        else:
            result += [np.stack([ab, b, c], axis=1), np.stack([ab, c, ac], axis=1)]
    return np.concatenate(result)


def _hull(cell: _Cell, width: float) -> ConvexPart:
    """The hull of the surface within a cell, and of the corners of the cell that are inside the mesh."""
    points = cell.corners.reshape(-1, 3)
    corners = np.stack(np.meshgrid(*zip(cell.low, cell.high, strict=True), indexing="ij"), axis=-1).reshape(-1, 3)
    inside = cell.inner[cell.deep]
    nearest = [np.abs(inside - corner).max(axis=1).min(initial=np.inf) for corner in corners]
    solid = corners[np.array(nearest) <= 0.5001 * width]
    return hull_part(np.unique(np.vstack([points, solid]), axis=0), most=_VERTICES)
