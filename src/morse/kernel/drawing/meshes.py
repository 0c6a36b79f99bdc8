"""Simplifies a mesh by a C function."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.kernel.loading import library
from morse.kernel.memory import addresses

if TYPE_CHECKING:
    from numpy.typing import NDArray


_CLOSED_ADDRESSES = "points triangles points_table edges_table welded beside labels volumes"
_CLOSED_SIZES = "points_size edges_size vertex_count triangle_count"


class _Search(ctypes.Structure):
    """``ClosedSearch`` of ``c/draw_closed.c``."""

    _fields_ = (
        *[(name, ctypes.c_void_p) for name in _CLOSED_ADDRESSES.split()],
        *[(name, ctypes.c_int64) for name in _CLOSED_SIZES.split()],
    )


def closed_labels(
    points: NDArray[np.float32], index: NDArray[np.int32], kernel: ctypes.CDLL | None = None
) -> NDArray[np.int32]:
    """Find the closed parts of a mesh.

    Args:
        points: (V, 3) positions of the vertices, without -0.
        index: (T, 3) vertices of the triangles, at least one triangle.
        kernel: the library; by default that of this machine.

    Returns:
        (T,) the first triangle of the part of each triangle, -1 if the part is not closed.
    """
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
    (kernel or library()).morse_draw_closed(ctypes.byref(search))
    return arrays[6]


_SIMPLIFY_ADDRESSES = "points looks slots vertices look errors alive first next open touched"
_SIMPLIFY_SIZES = "vertex_count triangle_count textured"


class _Structure(ctypes.Structure):
    """``Simplification`` of ``c/draw_simplify.c``."""

    _fields_ = (
        *[(name, ctypes.c_void_p) for name in _SIMPLIFY_ADDRESSES.split()],
        ("limit", ctypes.c_double),
        *[(name, ctypes.c_int64) for name in _SIMPLIFY_SIZES.split()],
    )


def simplify(mesh: Simplification, limit: float, kernel: ctypes.CDLL | None = None) -> int:
    """Simplify a mesh up to a limit of the error, in place; the next call, with a larger limit, goes on.

    A vertex moves onto the neighbour where the error is smallest. Vertices whose surroundings have changed wait for the
    next pass.

    Args:
        mesh: the mesh.
        limit: largest error, m.
        kernel: the library; by default that of this machine.

    Returns:
        The number of triangles that remain.
    """
    vertices, triangles = len(mesh.points), len(mesh.alive)
    room = (
        np.empty(vertices + 1, np.int32),
        np.empty(3 * triangles + 1, np.int32),
        np.empty(vertices + 1, np.uint8),
        np.empty(vertices + 1, np.uint8),
    )
    structure = _Structure(*addresses(*mesh[:7], *room), limit, vertices, triangles, mesh.textured)
    function = (kernel or library()).morse_draw_simplify
    function.restype = ctypes.c_int64
    remaining: int = function(ctypes.byref(structure))
    return remaining


class Simplification(NamedTuple):
    """A mesh that is simplified: the last four arrays change.

    Attributes:
        points: (V, 3) float64, positions of the vertices, all different.
        looks: (A, 5) float64, unit normals and texture coordinates, all rows different.
        slots: (A,) int32, the material slot of each of these rows.
        vertices: (T, 3) int32, the vertices of the corners of triangles.
        look: (T, 3) int32, the row of `looks` of each corner.
        errors: (T,) float64, the bounds of the errors of triangles, m.
        alive: (T,) uint8, 1 for triangles that remain.
        textured: whether texture coordinates are used.
    """

    points: NDArray[np.float64]
    looks: NDArray[np.float64]
    slots: NDArray[np.int32]
    vertices: NDArray[np.int32]
    look: NDArray[np.int32]
    errors: NDArray[np.float64]
    alive: NDArray[np.uint8]
    textured: bool
