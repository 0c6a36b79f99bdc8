"""Driven robots by C functions."""

from __future__ import annotations

import ctypes
from ctypes import c_double, c_int64, c_void_p
from typing import TYPE_CHECKING

from morse.kernel.memory import addresses

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from morse.kernel.driving.arrays import ChassisArrays, Floats, GliderArrays, PlaneArrays

_GLIDERS = "slots forward aside rate shifts ground dofs speeds margins extents plain free sliding trees asleep"
_STANCES = "able ticks until heights ups"
_RESULTS = "velocities done cosines sines others settled"
_CHASSIS = "first geoms motors radii levers slots dofs axles frictions turnings driven"


_PLANES = "first geoms carriers slots dofs boxes places tops box_bits plane_bits velocities body_places"
_PLANES_OF_GEOMS = "box_places box_turns shape_places radii types affinities"


def _pointers(names: str) -> list[tuple[str, type]]:
    return [(name, c_void_p) for name in names.split()]


class _GlidersStructure(ctypes.Structure):
    """``Gliders`` of ``c/gliders.h``."""

    _fields_ = (
        ("count", c_int64),
        *_pointers(f"{_GLIDERS} rotations positions"),
        ("period", c_double),
        *_pointers(f"{_STANCES} {_RESULTS}"),
        ("settled_count", c_int64),
    )


class _ChassisStructure(ctypes.Structure):
    """``Chassis`` of ``c/traction.c``."""

    _fields_ = (
        ("count", c_int64),
        *_pointers(_CHASSIS),
        ("pairs", c_int64),
        *_pointers("touching touched controls rotations"),
        *((name, c_double) for name in ("period", "gravity", "creep")),
        *_pointers("velocities dimensions"),
    )


class _PlanesStructure(ctypes.Structure):
    """``Planes`` of ``c/planes.c``."""

    _fields_ = (
        *((name, c_int64) for name in ("robots", "planes")),
        *_pointers(f"{_PLANES} {_PLANES_OF_GEOMS}"),
        *((name, c_double) for name in ("period", "edge", "deep")),
        ("all_bits", c_int64),
        *_pointers("positions"),
    )


class NativeGliders:
    """See `morse.kernel.driving.arrays.GliderWork`."""

    def __init__(self, library: ctypes.CDLL, arrays: GliderArrays) -> None:
        self._arrays = arrays
        self._known: Floats | None = None
        self._places: Floats | None = None
        names, stances = f"{_GLIDERS} {_RESULTS}".split(), _STANCES.split()
        parts = [*(getattr(arrays, name) for name in names), *(getattr(arrays.stances, name) for name in stances)]
        pointers = dict(zip([*names, *stances], addresses(*parts), strict=True))
        self._structure = _GlidersStructure(count=len(arrays.slots), period=arrays.period, **pointers)
        self._all = ctypes.byref(self._structure)
        #: address of the structure; its ``rotations`` may be those of an earlier tick
        self.place = ctypes.addressof(self._structure)
        self._begin, self._end = library.morse_glide_begin, library.morse_glide_end
        self._push = library.morse_push
        self._push.argtypes = c_void_p, c_int64, c_int64
        self._begin.restype, self._end.restype, self._push.restype = c_int64, None, c_int64

    def begin(self, rotations: Floats) -> int:
        """Write the velocities of a tick."""
        self._turned(rotations)
        count: int = self._begin(self._all)
        return count

    def push(self, positions: Floats, rotations: Floats, count: int, tick: int) -> tuple[int, int]:
        """Drive robots that do not glide: see `GliderWork.push`."""
        self._turned(rotations)
        if positions is not self._places:
            self._places = positions
            (self._structure.positions,) = addresses(positions)
        remaining: int = self._push(self._all, count, tick)
        return remaining, self._structure.settled_count

    def _turned(self, rotations: Floats) -> None:
        if rotations is not self._known:
            self._known = rotations
            (self._structure.rotations,) = addresses(rotations)

    def end(self) -> None:
        """After the tick: see `GliderWork.end`."""
        self._end(self._all)


class NativePlanes:
    """See `morse.kernel.driving.arrays.PlaneWork`."""

    def __init__(self, library: ctypes.CDLL, arrays: PlaneArrays) -> None:
        self._arrays = arrays
        self._known: Floats | None = None
        names = f"{_PLANES} {_PLANES_OF_GEOMS}".split()
        pointers = dict(zip(names, addresses(*(getattr(arrays, name) for name in names)), strict=True))
        numbers = {name: getattr(arrays, name) for name in ("period", "edge", "deep", "all_bits")}
        self._structure = _PlanesStructure(robots=len(arrays.slots), planes=len(arrays.boxes), **pointers, **numbers)
        self._all = ctypes.byref(self._structure)
        self._select = library.morse_planes
        self._select.restype = None

    def select(self, positions: Floats) -> None:
        """Write the collision bits of the shapes of each robot: see `PlaneWork.select`."""
        if positions is not self._known:
            self._known = positions
            (self._structure.positions,) = addresses(positions)
        self._select(self._all)


class NativeChassis:
    """See `morse.kernel.driving.arrays.ChassisWork`."""

    def __init__(self, library: ctypes.CDLL, arrays: ChassisArrays) -> None:
        self._arrays = arrays
        self._known: Floats | None = None
        names = [*_CHASSIS.split(), "touched", "controls", "velocities", "dimensions"]
        pointers = dict(zip(names, addresses(*(getattr(arrays, name) for name in names)), strict=True))
        self._touching: NDArray[np.int32] | None = None
        self._structure = _ChassisStructure(
            count=len(arrays.slots), period=arrays.period, creep=arrays.creep, **pointers
        )
        self._all = ctypes.byref(self._structure)
        self._pull = library.morse_traction
        self._pull.restype = None

    def pull(self, rotations: Floats, pairs: int, gravity: float) -> None:
        """Move the velocities of the robots closer to those of their treads."""
        structure = self._structure
        if rotations is not self._known:
            self._known = rotations
            (structure.rotations,) = addresses(rotations)
        if self._arrays.touching is not self._touching:
            self._touching = self._arrays.touching
            (structure.touching,) = addresses(self._touching)
        structure.pairs = pairs
        structure.gravity = gravity
        self._pull(self._all)
