"""Simplifies a mesh by a C function."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.memory import addresses

if TYPE_CHECKING:
    from morse.kernel.drawing.simplification import Simplification

_ADDRESSES = "points looks slots vertices look errors alive first next open touched"
_SIZES = "vertex_count triangle_count textured"


class _Structure(ctypes.Structure):
    """``Simplification`` of ``c/draw_simplify.c``."""

    _fields_ = (
        *[(name, ctypes.c_void_p) for name in _ADDRESSES.split()],
        ("limit", ctypes.c_double),
        *[(name, ctypes.c_int64) for name in _SIZES.split()],
    )


def simplify(library: ctypes.CDLL, mesh: Simplification, limit: float) -> int:
    """See `morse.kernel.drawing.simplify`."""
    vertices, triangles = len(mesh.points), len(mesh.alive)
    room = (
        np.empty(vertices + 1, np.int32),
        np.empty(3 * triangles + 1, np.int32),
        np.empty(vertices + 1, np.uint8),
        np.empty(vertices + 1, np.uint8),
    )
    structure = _Structure(*addresses(*mesh[:7], *room), limit, vertices, triangles, mesh.textured)
    library.morse_draw_simplify.restype = ctypes.c_int64
    remaining: int = library.morse_draw_simplify(ctypes.byref(structure))
    return remaining
