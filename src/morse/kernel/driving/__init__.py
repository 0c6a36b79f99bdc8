"""Robots that are driven together: over a level floor, and on wheels."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.kernel.driving import reference
from morse.kernel.driving.native import NativeChassis, NativeGliders, NativePlanes
from morse.kernel.loading import library

if TYPE_CHECKING:
    from morse.kernel.driving.arrays import (
        ChassisArrays,
        ChassisWork,
        GliderArrays,
        GliderWork,
        PlaneArrays,
        PlaneWork,
    )

__all__ = ["chassis", "gliders", "planes"]


def gliders(arrays: GliderArrays) -> GliderWork:
    """The function that drives robots over a level floor: C, or Python without the kernel."""
    kernel_library = library()
    return reference.Gliders(arrays) if kernel_library is None else NativeGliders(kernel_library, arrays)


def chassis(arrays: ChassisArrays) -> ChassisWork:
    """The function that moves wheeled robots: C, or Python without the kernel."""
    kernel_library = library()
    return reference.Chassis(arrays) if kernel_library is None else NativeChassis(kernel_library, arrays)


def planes(arrays: PlaneArrays) -> PlaneWork:
    """The function that selects the planes or boxes below wheeled robots: C, or Python without the kernel."""
    kernel_library = library()
    return reference.Planes(arrays) if kernel_library is None else NativePlanes(kernel_library, arrays)
