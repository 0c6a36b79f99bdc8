"""Divides plane areas with only right angles, such as walls with doors, into rectangles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils.portable import matmul

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

_RIGHT = 1e-4  # sine of the largest angle between an edge and the axes
_SAME = 1e-5  # share of the extent: coordinates closer than this are merged
_CELLS = 40_000


def rectangles(points: Floats, loops: Sequence[Sequence[int]]) -> list[Floats] | None:
    """Return rectangles (4, 2), counter-clockwise, of an area whose edges have two perpendicular directions.

    Args:
        points: (P, 2) metres.
        loops: indices of points around the area, which lies to their left.

    Returns:
        None if the edges have other directions, or there are too many edges.
    """
    starts = np.concatenate([points[loop] for loop in loops])
    ends = np.concatenate([np.roll(points[loop], -1, axis=0) for loop in loops])
    edges = ends - starts
    lengths = np.linalg.norm(edges, axis=1)
    if not lengths.max(initial=0.0) > 0.0:
        return None
    x, y = edges[lengths.argmax()] / lengths.max()
    axes = np.array([[x, -y], [y, x]])
    edges = matmul(edges, axes)
    if (np.abs(edges).min(axis=1) > _RIGHT * lengths).any():
        return None
    starts, ends = matmul(starts, axes), matmul(ends, axes)
    upright = np.abs(edges[:, 1]) > np.abs(edges[:, 0])
    tolerance = _SAME * float(np.ptp(starts, axis=0).max())
    columns, rows = _lines(starts[:, 0], tolerance), _lines(starts[:, 1], tolerance)
    if len(columns) * len(rows) > _CELLS:
        return None
    winding = np.zeros((len(columns), len(rows)), dtype=np.int64)
    for start, end in zip(starts[upright], ends[upright], strict=True):
        column = _index(columns, start[0], tolerance)
        low, high = sorted((_index(rows, start[1], tolerance), _index(rows, end[1], tolerance)))
        winding[column:, low:high] += 1 if end[1] < start[1] else -1
    inside = winding[:-1, :-1] > 0
    standing = _strips(inside)
    lying = [(a, b, c, d) for c, d, a, b in _strips(inside.T)]
    strips = lying if len(lying) <= len(standing) else standing
    return [
        matmul(
            np.array([[columns[a], rows[c]], [columns[b], rows[c]], [columns[b], rows[d]], [columns[a], rows[d]]]),
            axes.T,
        )
        for a, b, c, d in strips
    ]


def _lines(values: Floats, tolerance: float) -> Floats:
    series = np.sort(values)
    lines: Floats = series[np.append(True, np.diff(series) > tolerance)]
    return lines


def _index(lines: Floats, value: float, tolerance: float) -> int:
    return int(np.searchsorted(lines, value + tolerance, side="right")) - 1


def _strips(inside: NDArray[np.bool_]) -> list[tuple[int, int, int, int]]:
    """Rectangles (first and last line of each axis) of runs of filled cells; equal neighbouring runs are merged."""
    strips = []
    open_runs: dict[tuple[int, int], int] = {}
    for row in range(len(inside) + 1):
        runs = _runs(inside[row]) if row < len(inside) else []
        for run, first in list(open_runs.items()):
            if run not in runs:
                strips.append((first, row, *run))
                del open_runs[run]
        for run in runs:
            open_runs.setdefault(run, row)
    return strips


def _runs(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    steps = np.diff(np.concatenate([[0], mask.astype(np.int8), [0]]))
    return list(zip(np.flatnonzero(steps == 1).tolist(), np.flatnonzero(steps == -1).tolist(), strict=True))
