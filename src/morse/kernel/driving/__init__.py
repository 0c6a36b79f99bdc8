"""Robots that are driven together: over a level floor, and on wheels."""

from __future__ import annotations

from typing import TYPE_CHECKING

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
    """The function that drives robots over a level floor."""
    return NativeGliders(library(), arrays)


def chassis(arrays: ChassisArrays) -> ChassisWork:
    """The function that moves wheeled robots."""
    return NativeChassis(library(), arrays)


def planes(arrays: PlaneArrays) -> PlaneWork:
    """The function that selects the planes or boxes below wheeled robots."""
    return NativePlanes(library(), arrays)
