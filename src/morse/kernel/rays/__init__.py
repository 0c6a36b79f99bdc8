"""Rays at solids, as arrays."""

from __future__ import annotations

from morse.kernel.loading import library
from morse.kernel.rays.arrays import Fan, Hits, Poses, SolidArrays, TriangleMesh
from morse.kernel.rays.native import NativeRays

__all__ = ["Fan", "Hits", "Poses", "SolidArrays", "TriangleMesh", "ray_caster"]


def ray_caster(solids: SolidArrays) -> NativeRays:
    """The function that casts rays."""
    return NativeRays(library(), solids)
