"""Camera images rendered from triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.kernel.drawing import native_closed, native_simplify
from morse.kernel.drawing.arrays import Drawing, Light, Pictures, Poses
from morse.kernel.drawing.kept import Kept
from morse.kernel.drawing.native import NativeDrawer
from morse.kernel.drawing.simplification import Simplification
from morse.kernel.loading import library

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["Drawing", "Kept", "Light", "Pictures", "Poses", "Simplification", "closed_labels", "drawer", "simplify"]


def drawer(drawing: Drawing) -> NativeDrawer:
    """The renderer."""
    return NativeDrawer(library(), drawing)


def closed_labels(points: NDArray[np.float32], index: NDArray[np.int32]) -> NDArray[np.int32]:
    """Find the closed parts of a mesh.

    Args:
        points: (V, 3) positions of the vertices, without -0.
        index: (T, 3) vertices of the triangles, at least one triangle.

    Returns:
        (T,) the first triangle of the part of each triangle, -1 if the part is not closed.
    """
    return native_closed.closed_labels(library(), points, index)


def simplify(mesh: Simplification, limit: float) -> int:
    """Simplify a mesh up to a limit of the error, in place; the next call, with a larger limit, goes on.

    A vertex moves onto the neighbour where the error is smallest. Vertices whose surroundings have changed wait for the
    next pass.

    Args:
        mesh: the mesh.
        limit: largest error, m.

    Returns:
        The number of triangles that remain.
    """
    return native_simplify.simplify(library(), mesh, limit)
