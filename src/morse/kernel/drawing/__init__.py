"""Camera images rendered from triangles: the C functions, and their twins in numpy."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.kernel.drawing.arrays import Drawing, Light, Pictures, Poses
from morse.kernel.loading import library

if TYPE_CHECKING:
    from morse.kernel.drawing.native import NativeDrawer
    from morse.kernel.drawing.reference import ReferenceDrawer

__all__ = ["Drawing", "Light", "Pictures", "Poses", "drawer"]


def drawer(drawing: Drawing) -> NativeDrawer | ReferenceDrawer:
    """The renderer: the C functions, or numpy without the kernel."""
    native = library()
    if native is None:
        from morse.kernel.drawing.reference import ReferenceDrawer

        return ReferenceDrawer(drawing)
    from morse.kernel.drawing.native import NativeDrawer

    return NativeDrawer(native, drawing)
