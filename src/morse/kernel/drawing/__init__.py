"""Camera images rendered from triangles: the C functions, and their twins in numpy."""

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

    from morse.kernel.drawing.reference import ReferenceDrawer

__all__ = ["Drawing", "Kept", "Light", "Pictures", "Poses", "Simplification", "closed_labels", "drawer", "simplify"]


def drawer(drawing: Drawing) -> NativeDrawer | ReferenceDrawer:
    """The renderer: the C functions, or numpy without the kernel."""
    native = library()
    if native is None:
        from morse.kernel.drawing.reference import ReferenceDrawer

        return ReferenceDrawer(drawing)
    return NativeDrawer(native, drawing)


def closed_labels(points: NDArray[np.float32], index: NDArray[np.int32]) -> NDArray[np.int32]:
    """The closed parts of a mesh; see `morse.kernel.drawing.reference_closed.closed_labels`."""
    native = library()
    if native is None:
        from morse.kernel.drawing.reference_closed import closed_labels as of_numpy

        return of_numpy(points, index)
    return native_closed.closed_labels(native, points, index)


def simplify(mesh: Simplification, limit: float) -> int:
    """Simplify a mesh up to an error; see `morse.kernel.drawing.reference_simplify.simplify`."""
    native = library()
    if native is None:
        from morse.kernel.drawing.reference_simplify import simplify as by_python

        return by_python(mesh, limit)
    return native_simplify.simplify(native, mesh, limit)
