"""Finds the closed parts of a mesh by a C function."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.memory import addresses

if TYPE_CHECKING:
    from numpy.typing import NDArray

_ADDRESSES = "points triangles points_table edges_table welded beside labels volumes"
_SIZES = "points_size edges_size vertex_count triangle_count"


class _Search(ctypes.Structure):
    """``ClosedSearch`` of ``c/draw_closed.c``."""

    _fields_ = (
        *[(name, ctypes.c_void_p) for name in _ADDRESSES.split()],
        *[(name, ctypes.c_int64) for name in _SIZES.split()],
    )


def closed_labels(library: ctypes.CDLL, points: NDArray[np.float32], index: NDArray[np.int32]) -> NDArray[np.int32]:
    """See `morse.kernel.drawing.closed_labels`."""
    vertices, triangles = len(points), len(index)
    # at most half of a table is filled
    points_size, edges_size = (1 << (2 * count).bit_length() for count in (vertices, 3 * triangles))
    arrays = (
        np.ascontiguousarray(points, np.float32),
        np.ascontiguousarray(index, np.int32),
        np.empty(points_size, np.int32),
        np.empty(edges_size, np.int32),
        np.empty(vertices, np.int32),
        np.empty(3 * triangles, np.int32),
        np.empty(triangles, np.int32),
        np.empty(triangles, np.float64),
    )
    search = _Search(*addresses(*arrays), points_size, edges_size, vertices, triangles)
    library.morse_draw_closed(ctypes.byref(search))
    return arrays[6]
