"""Rays at solids, as arrays: the C functions and their twin in numpy."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.kernel.loading import library
from morse.kernel.rays import primitives
from morse.kernel.rays.arrays import Fan, Hits, Poses, SolidArrays, TriangleMesh
from morse.kernel.rays.native import NativeRays

if TYPE_CHECKING:
    from morse.kernel.rays.reference import ReferenceRays

__all__ = ["Fan", "Hits", "Poses", "SolidArrays", "TriangleMesh", "primitives", "ray_caster"]


def ray_caster(solids: SolidArrays) -> NativeRays | ReferenceRays:
    """The function that casts rays: C, or numpy if the kernel is missing or disabled, with bit-identical results."""
    kernel_library = library()
    if kernel_library is None:
        from morse.kernel.rays.reference import ReferenceRays

        return ReferenceRays(solids)
    return NativeRays(kernel_library, solids)
