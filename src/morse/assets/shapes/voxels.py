"""The cells of a grid that a surface fills."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

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
