"""Divides plane areas: polygons into convex ones, and areas with only right angles into rectangles."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

import mapbox_earcut
import numpy as np

from morse.mathutils.portable import matmul

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


Point2: TypeAlias = tuple[float, float]
Polygon: TypeAlias = list[int]

_STRAIGHT = 1e-7  # sine of the largest bend that is treated as straight
_SAME_AREA = 1e-3


def convex_polygons(points: Floats, loops: Sequence[Polygon], triangles: Sequence[Polygon]) -> list[Polygon]:
    """Divide an area into convex polygons, counter-clockwise.

    Args:
        points: (P, 2) metres.
        loops: indices of points around the area: one outer loop counter-clockwise, holes clockwise.
        triangles: the same area in triangles, used if the loops cross or touch themselves.
    """
    where: list[Point2] = [(x, y) for x, y in points.tolist()]
    simple = [loop for loop in (_without_straight(where, loop) for loop in loops) if len(loop) >= 3]
    area = sum(_area(where, triangle) for triangle in triangles)
    outer = [loop for loop in simple if _area(where, loop) > 0.0]
    if len(outer) == 1 and abs(sum(_area(where, loop) for loop in simple) - area) <= _SAME_AREA * area:
        if len(simple) == 1 and _is_convex(where, outer[0]):
            return outer
        ears = _ears(points, [outer[0], *(loop for loop in simple if loop is not outer[0])])
        if abs(sum(_area(where, triangle) for triangle in ears) - area) <= _SAME_AREA * area:
            return _merged(where, ears)
    return _merged(where, [list(triangle) for triangle in triangles])


def _cross(a: Point2, b: Point2, c: Point2) -> float:
    return (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])


def _bend(a: Point2, b: Point2, c: Point2) -> float:
    """Sine of the left turn at b; 0 if two of the points are the same."""
    lengths = ((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2) * ((c[0] - b[0]) ** 2 + (c[1] - b[1]) ** 2)
    return _cross(a, b, c) / lengths**0.5 if lengths > 0.0 else 0.0


def _area(where: Sequence[Point2], polygon: Iterable[int]) -> float:
    corners = [where[i] for i in polygon]
    following = corners[1:] + corners[:1]
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(corners, following, strict=True)) / 2.0


def _without_straight(where: Sequence[Point2], loop: Polygon) -> Polygon:
    previous = [loop[-1], *loop[:-1]]
    following = [*loop[1:], loop[0]]
    return [
        here
        for before, here, after in zip(previous, loop, following, strict=True)
        if abs(_bend(where[before], where[here], where[after])) > _STRAIGHT
    ]


def _is_convex(where: Sequence[Point2], loop: Polygon) -> bool:
    previous = [loop[-1], *loop[:-1]]
    following = [*loop[1:], loop[0]]
    return all(
        _bend(where[before], where[here], where[after]) >= -_STRAIGHT
        for before, here, after in zip(previous, loop, following, strict=True)
    )


def _ears(points: Floats, loops: list[Polygon]) -> list[Polygon]:
    indices = np.concatenate([np.array(loop, dtype=np.int64) for loop in loops])
    ends = np.cumsum([len(loop) for loop in loops]).astype(np.uint32)
    corners = mapbox_earcut.triangulate_float64(np.ascontiguousarray(points[indices]), ends).reshape(-1, 3)
    where = points[indices]
    a, b, c = where[corners[:, 0]], where[corners[:, 1]], where[corners[:, 2]]
    is_clockwise = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]) < 0.0
    corners[is_clockwise] = corners[is_clockwise][:, ::-1]
    triangles: list[Polygon] = indices[corners].tolist()
    return triangles


def _merged(where: Sequence[Point2], pieces: list[Polygon]) -> list[Polygon]:
    """Merge convex polygons over common edges, the longest first, as long as the result is convex.

    S. Hertel and K. Mehlhorn, "Fast triangulation of simple polygons" (1983): at most four times the minimum number.
    """
    polygons: dict[int, Polygon] = dict(enumerate(pieces))
    owner = {edge: number for number, polygon in polygons.items() for edge in _edges(polygon)}
    inner = [(a, b) for a, b in owner if a < b and (b, a) in owner]
    inner.sort(key=lambda edge: _squared(where[edge[0]], where[edge[1]]), reverse=True)
    for a, b in inner:
        one, other = owner[a, b], owner[b, a]
        if one == other:
            continue
        left = _rotated(polygons[one], b)
        right = _rotated(polygons[other], a)
        # left runs from b round to a, right from a round to b
        if (
            _bend(where[left[-2]], where[a], where[right[1]]) < -_STRAIGHT
            or _bend(where[right[-2]], where[b], where[left[1]]) < -_STRAIGHT
        ):
            continue
        union = left + right[1:-1]
        polygons[one] = union
        del polygons[other]
        for edge in _edges(union):
            owner[edge] = one
    return list(polygons.values())


def _edges(polygon: Polygon) -> Iterable[tuple[int, int]]:
    return zip(polygon, [*polygon[1:], polygon[0]], strict=True)


def _rotated(polygon: Polygon, first: int) -> Polygon:
    at = polygon.index(first)
    return polygon[at:] + polygon[:at]


def _squared(a: Point2, b: Point2) -> float:
    return (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2


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
