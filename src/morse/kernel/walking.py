"""Directions and ways of people who walk, computed by ``c/walk.c``."""

from __future__ import annotations

from ctypes import Structure, byref, c_double, c_int64, c_void_p
from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.loading import library

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["arrival", "directions", "wall"]


class _Walk(Structure):
    """``Walk`` of ``c/walk.c``."""

    _fields_ = (
        *((name, c_int64) for name in ("people", "pairs", "turns", "height", "width")),
        *((name, c_void_p) for name in ("first", "apart", "velocity", "distance", "radii", "position", "wanted")),
        *((name, c_void_p) for name in ("speed", "beside", "present", "gap")),
        ("origin", c_double * 2),
        ("cell", c_double),
        ("sight", c_double),
        *((name, c_void_p) for name in ("turned", "best", "free", "result")),
    )


class _Arrival(Structure):
    """``Arrival`` of ``c/walk.c``."""

    _fields_ = (
        *((name, c_int64) for name in ("width", "count", "seeds")),
        *((name, c_void_p) for name in ("is_free", "slowness", "seed", "heap", "place", "time")),
    )


class _Wall(Structure):
    """``Wall`` of ``c/walk.c``."""

    _fields_ = (
        *((name, c_int64) for name in ("width", "corners", "first_row", "last_row", "first_column", "last_column")),
        ("polygon", c_void_p),
        ("origin", c_double * 2),
        ("cell", c_double),
        ("gap", c_void_p),
    )


def _numbers(values: NDArray[np.floating], *shape: int) -> Floats:
    """Return an array as C reads it.

    Raises:
        ValueError: it has another shape.
    """
    found = np.ascontiguousarray(values, dtype=np.float64)
    if found.shape != shape:
        raise ValueError(f"an array of the shape {shape} is needed, got {found.shape}")
    return found


def directions(
    first: NDArray[np.intp],
    apart: Floats,
    velocity: Floats,
    distance: Floats,
    radii: Floats,
    position: Floats,
    wanted: Floats,
    speed: Floats,
    beside: Floats,
    present: NDArray[np.bool_],
    gap: Floats,
    origin: Floats,
    cell: float,
    sight: float,
    turned: Floats,
) -> Floats:
    """Return the directions (N, 2) that bring people nearest to where they would be without obstacles: unit vectors.

    A direction counts by how far one comes at the free speed before the first collision, at most the sight.

    Args:
        first: (P,) numbers of those who see somebody.
        apart: (P, 2) from the one who is seen, m.
        velocity: (P, 2) of the one who is seen, m/s.
        distance: (P,) m.
        radii: (P,) sums of both radii, m.
        position: (N, 2) m.
        wanted: (N, 2) unit vectors of the ways; 0 for those who stand.
        speed: (N,) free speeds, m/s.
        beside: (N,) distance to a wall at which somebody stops, m.
        present: (N,) the others keep the direction they want.
        gap: (H, W) distance to the nearest wall, m; at least 2 cells along each axis.
        origin: (2,) of the middle of the first cell, m.
        cell: m.
        sight: m.
        turned: (T, 2) cosines and sines of the directions to try besides the straight one.

    Raises:
        ValueError: an array has another shape, or a number of a person does not exist.
    """
    count, pairs, (height, width) = len(position), len(first), gap.shape
    seers = np.ascontiguousarray(first, dtype=np.int64)
    if pairs and not (int(seers.min()) >= 0 and int(seers.max()) < count):
        raise ValueError(f"pairs have the numbers 0 to {count - 1}, got {int(seers.min())} to {int(seers.max())}")
    if height < 2 or width < 2 or len(present) != count:
        raise ValueError(f"a grid of {height} x {width} cells, and {len(present)} marks for {count} people")
    arrays = [
        *(seers, _numbers(apart, pairs, 2), _numbers(velocity, pairs, 2), _numbers(distance, pairs)),
        *(_numbers(radii, pairs), _numbers(position, count, 2), _numbers(wanted, count, 2), _numbers(speed, count)),
        *(_numbers(beside, count), np.ascontiguousarray(present, dtype=np.bool_), _numbers(gap, height, width)),
    ]
    turns, work, result = _numbers(turned, len(turned), 2), np.empty((2, count)), np.empty((count, 2))
    begin = _numbers(origin, 2).tolist()
    values = _Walk(
        *(count, pairs, len(turns), height, width),
        *(array.ctypes.data for array in arrays),
        *((c_double * 2)(*begin), cell, sight, turns.ctypes.data),
        *(row.ctypes.data for row in work),
        result.ctypes.data,
    )
    library().morse_walk_direction(byref(values))
    return result


def arrival(time: Floats, is_free: NDArray[np.bool_], slowness: Floats, seeds: NDArray[np.intp]) -> None:
    """Shorten the times (H, W) of arrival from some cells on, by the eikonal equation.

    Args:
        time: (H, W) known times; infinite where none is known. Changed.
        is_free: (H, W) which cells can be walked on; none at the edges of the grid.
        slowness: (H, W) time through a cell.
        seeds: (S,) numbers of cells whose times are known.

    Raises:
        ValueError: an array has another shape, or a cell at an edge is free or a seed.
    """
    height, width = time.shape
    inner = np.zeros((height, width), dtype=bool)
    inner[1:-1, 1:-1] = True
    free, starts = np.ascontiguousarray(is_free, dtype=np.bool_), np.ascontiguousarray(seeds, dtype=np.int64)
    if free.shape != time.shape or (free & ~inner).any():
        raise ValueError(f"cells at the edges of a grid of {height} x {width} cells cannot be free")
    if len(starts) and not (int(starts.min()) >= 0 and int(starts.max()) < time.size):
        raise ValueError(f"there are the cells 0 to {time.size - 1}")
    if not inner.ravel()[starts].all():
        raise ValueError("no search begins at the edge of a grid")
    if time.dtype != np.float64 or not time.flags.c_contiguous:
        raise ValueError("times are a contiguous array of doubles")
    work, slow = np.empty((2, time.size), dtype=np.int64), _numbers(slowness, height, width)
    arrays = (free, slow, starts, work[0], work[1], time)
    values = _Arrival(width, time.size, len(starts), *(array.ctypes.data for array in arrays))
    library().morse_walk_arrival(byref(values))


def wall(gap: Floats, polygon: Floats, rows: slice, columns: slice, origin: Floats, cell: float) -> None:
    """Shorten the distances (H, W) to the nearest wall in a part of a grid by a convex polygon; negative within it.

    Args:
        gap: (H, W) m; infinite, or as far as walls are looked for. Changed.
        polygon: (V, 2) counter-clockwise, m, V at least 1.
        rows: of the part.
        columns: of the part.
        origin: (2,) of the middle of the first cell, m.
        cell: m.

    Raises:
        ValueError: an array has another shape, or the part is not in the grid.
    """
    points, (height, width) = _numbers(polygon, len(polygon), 2), gap.shape
    if not (0 <= rows.start <= rows.stop <= height and 0 <= columns.start <= columns.stop <= width and len(points)):
        raise ValueError(f"{len(points)} corners, rows {rows}, columns {columns} in {height} x {width} cells")
    if gap.dtype != np.float64 or not gap.flags.c_contiguous:
        raise ValueError("distances are a contiguous array of doubles")
    begin = (c_double * 2)(*_numbers(origin, 2).tolist())
    part = (rows.start, rows.stop, columns.start, columns.stop)
    values = _Wall(width, len(points), *part, points.ctypes.data, begin, cell, gap.ctypes.data)
    library().morse_walk_wall(byref(values))
