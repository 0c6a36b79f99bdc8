"""Robots that are driven together: over a level floor, and on wheels."""

from __future__ import annotations

import ctypes
import math
from ctypes import c_double, c_int64, c_void_p
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Protocol

from morse.kernel.loading import library
from morse.kernel.memory import addresses

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

    Integers = NDArray[np.int64]

    Bytes = NDArray[np.uint8]

__all__ = ["chassis", "gliders", "planes"]


@dataclass(eq=False)
class StanceArrays:
    """How the robots of a world with K rigid groups ("slots") stood when they were last driven without gliding.

    Attributes:
        able: (K,) 1 for robots that may glide.
        ticks: (K,) tick of the stance; -1 for a robot that has to settle anew.
        heights: (K,) height of the origin of the robot, m.
        ups: (K, 3) vertical direction in the axes of the robot.
        until: (K,) first tick in which the robot may glide.
    """

    able: Bytes
    ticks: Integers
    heights: Floats
    ups: Floats
    until: Integers

    def __post_init__(self) -> None:
        """Single numbers are read and written through memory views in a third of the time that arrays take."""
        parts: tuple[Any, ...] = (self.ticks, self.heights, self.ups.reshape(-1), self.until)
        self.views: tuple[Any, ...] = tuple(map(memoryview, parts))


@dataclass(eq=False)
class GliderArrays:
    """N robots of a world with K rigid groups ("slots"); all arrays are contiguous, and their addresses do not change.

    Attributes:
        slots: (N,) slots of the robots.
        forward, aside, rate: (N,) commands in the axes of each robot, m/s and rad/s.
        shifts: (N,) 1 for robots that are moved without momentum.
        ground: (N,) 1 for robots that keep their vertical speed, and their roll and pitch rates.
        dofs: (K,) address of the velocity.
        speeds, margins, extents: (K,) limits for which gliding was checked, m/s and m; a negative speed: no gliding.
        plain: (K,) 1 for robots whose commands nothing else changes.
        free: (K,) 1 for bodies with six degrees of freedom.
        sliding: (K,) 1 for robots that were driven in the last tick.
        trees: (K,) the tree of the engine, or -1.
        asleep: (T,) 0 or more for sleeping trees.
        velocities: velocities of the engine.
        period: of a tick, s.
        done: (N,) result of `GliderWork.begin`, for `GliderWork.end`: see ``c/glide.c``.
        cosines, sines: (N,) of half the turning angle.
        others: (N,) result: the rows that have to be driven separately.
        settled: (N,) result of `GliderWork.push`: the rows of robots that have settled and may glide.
        stances: stances of the robots that do not glide.
    """

    slots: Integers
    forward: Floats
    aside: Floats
    rate: Floats
    shifts: Bytes
    ground: Bytes
    dofs: Integers
    speeds: Floats
    margins: Floats
    extents: Floats
    plain: Bytes
    free: Bytes
    sliding: Bytes
    trees: NDArray[np.int32]
    asleep: NDArray[np.int32]
    velocities: Floats
    period: float
    done: Bytes
    cosines: Floats
    sines: Floats
    others: Integers
    settled: Integers
    stances: StanceArrays


class GliderWork(Protocol):
    """Drives the robots of a `GliderArrays`."""

    def begin(self, rotations: Floats) -> int:
        """Write the velocities of a tick.

        Args:
            rotations: (K, 9) of all slots, row by row.

        Returns:
            The number of rows in `GliderArrays.others`, robots that have to be driven separately.
        """

    def push(self, positions: Floats, rotations: Floats, count: int, tick: int) -> tuple[int, int]:
        """Write the velocities of robots that do not glide, and record their stances.

        Args:
            positions, rotations: (K, 3), (K, 9) of all slots.
            count: the number of rows in `GliderArrays.others`.
            tick: number of the tick.

        Returns:
            The number of rows in `GliderArrays.others` now, robots that have to be driven one by one; and of rows in
            `GliderArrays.settled`.
        """

    def end(self) -> None:
        """After the tick: a shift leaves no momentum, a velocity points along the new heading."""


@dataclass(eq=False)
class ChassisArrays:
    """N robots with W wheels.

    Attributes:
        first: (N + 1,) the wheels of robot i are first[i] to first[i + 1].
        geoms, motors: (W,) geom and motor of each wheel.
        radii, levers: (W,) m; what the speed of each tread adds to the yaw rate, 1/m.
        slots, dofs: (N,) slots and velocity addresses of the robots.
        axles: (N,) metres from the origin ahead to the middle of the wheels.
        frictions: (N,) Coulomb coefficients.
        turnings: (N,) m/s^2 of friction to rad/s^2 of the yaw rate.
        driven: (N,) 1 for robots that are commanded as bodies in this tick.
        touching: (C, 2) geoms that touch, in its first rows; may be replaced by a larger array.
        touched: (G,) scratch memory.
        controls, velocities, dimensions: arrays of the engine.
        period: of a tick, s.
        creep: a robot with stopped wheels that moves more slowly than this, m/s and rad/s, is held by plain friction.
    """

    first: Integers
    geoms: Integers
    motors: Integers
    radii: Floats
    levers: Floats
    slots: Integers
    dofs: Integers
    axles: Floats
    frictions: Floats
    turnings: Floats
    driven: Bytes
    touching: NDArray[np.int32]
    touched: Bytes
    controls: Floats
    velocities: Floats
    dimensions: NDArray[np.int32]
    period: float
    creep: float


@dataclass(eq=False)
class PlaneArrays:
    """N robots with S shapes, above P boxes whose level tops may be replaced by planes.

    Attributes:
        first: (N + 1,) the shapes of robot i are first[i] to first[i + 1].
        geoms, carriers: (S,) geom of each shape, and its body if the body is not that of the robot, else -1.
        slots, dofs: (N,) slots and velocity addresses of the robots.
        boxes: (P,) geoms.
        places: (P, 12) position and rotation, row by row, of each box while its top is the floor.
        tops: (P, 9) height, centre, first and second axis, half lengths along these axes, m.
        box_bits, plane_bits: (P,) collision bits.
        velocities, body_places, box_places, box_turns, shape_places, radii, types, affinities: arrays of the engine:
            qvel, body_pos, geom_xpos, geom_xmat, geom_pos, geom_rbound, geom_contype, geom_conaffinity.
        period: of a tick, s.
        edge: distance to the edges that a robot needs in addition to its size and its speed, m.
        deep: depth of the origin of a robot below the top, m, at which the robot still touches the plane.
        all_bits: collision bits of a shape that touches every box.
    """

    first: Integers
    geoms: Integers
    carriers: Integers
    slots: Integers
    dofs: Integers
    boxes: Integers
    places: Floats
    tops: Floats
    box_bits: NDArray[np.int32]
    plane_bits: NDArray[np.int32]
    velocities: Floats
    body_places: Floats
    box_places: Floats
    box_turns: Floats
    shape_places: Floats
    radii: Floats
    types: NDArray[np.int32]
    affinities: NDArray[np.int32]
    period: float
    edge: float
    deep: float
    all_bits: int


class PlaneWork(Protocol):
    """Selects planes or boxes for the robots of a `PlaneArrays`."""

    def select(self, positions: Floats) -> None:
        """Write the collision bits of the shapes of each robot; shapes without bits keep none.

        Args:
            positions: (K, 3) of all slots.
        """


class ChassisWork(Protocol):
    """Moves the robots of a `ChassisArrays`."""

    def pull(self, rotations: Floats, pairs: int, gravity: float) -> None:
        """Move the velocities of the robots closer to those of their treads.

        Args:
            rotations: (K, 9) of all slots, row by row.
            pairs: number of valid rows of `ChassisArrays.touching`.
            gravity: m/s^2, downward.
        """


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
    """See `morse.kernel.driving.GliderWork`."""

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
    """See `morse.kernel.driving.PlaneWork`."""

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
    """See `morse.kernel.driving.ChassisWork`."""

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


def gliders(arrays: GliderArrays) -> GliderWork:
    """The function that drives robots over a level floor."""
    return NativeGliders(library(), arrays)


def chassis(arrays: ChassisArrays) -> ChassisWork:
    """The function that moves wheeled robots."""
    return NativeChassis(library(), arrays)


def planes(arrays: PlaneArrays) -> PlaneWork:
    """The function that selects the planes or boxes below wheeled robots."""
    return NativePlanes(library(), arrays)


class _PlacedStructure(ctypes.Structure):
    """``Placed`` of ``c/course.h``."""

    _fields_ = (("count", c_int64), *((name, c_void_p) for name in ("places", "dofs", "slots", "qpos")))


class _CourseStructure(ctypes.Structure):
    """``Course`` of ``c/course.h``."""

    _fields_ = (
        *((name, c_void_p) for name in ("robots", "placed", "positions", "rotations")),
        *((name, c_void_p) for name in ("positions_before", "rotations_before")),
        ("count", c_int64),
    )


class Placed:
    """Robots that glide, in the arrays of the engine.

    Args:
        places, dofs: (M,) addresses of the coordinates and the velocities of robots.
        slots: (M,) their rows among the poses of the world.
        qpos: the coordinates of the engine.
    """

    def __init__(
        self, places: NDArray[np.int64], dofs: NDArray[np.int64], slots: NDArray[np.int64], qpos: Floats
    ) -> None:
        kernel = library()
        self._keep = places, dofs, slots, qpos
        self._structure = _PlacedStructure(len(places), *addresses(*self._keep))
        self._all = ctypes.byref(self._structure)
        self._move, self._poses = kernel.morse_glide_move, kernel.morse_glide_poses
        self._move.argtypes, self._move.restype = (c_void_p, c_void_p, c_void_p, c_double), None
        self._poses.argtypes, self._poses.restype = (c_void_p, c_void_p, c_void_p), None

    @property
    def place(self) -> int:
        """The address of the structure."""
        return ctypes.addressof(self._structure)

    def move(self, start: int, velocities: int, period: float) -> None:
        """Set the coordinates of the robots after a time.

        Args:
            start: address of the coordinates of all bodies at the beginning; may be those of the engine.
            velocities: address of those of all bodies: linear in the axes of the world, angular in those of each body.
            period: s.
        """
        self._move(self._all, start, velocities, period)

    def write_poses(self, positions: int | None, rotations: int | None) -> None:
        """Write the rows of the robots in the positions (K, 3) and the rotations (K, 9) of the world, at addresses."""
        self._poses(self._all, positions, rotations)


class Course:
    """Ticks in which robots of a world only glide.

    Args:
        positions_before, rotations_before: results, (K, 3), (K, 9): the poses of all bodies that move, at the beginning
            of the last tick.

    Attributes:
        positions, rotations: (K, 3), (K, 9) the present poses, which are set before the first tick.
    """

    def __init__(self, positions_before: Floats, rotations_before: Floats) -> None:
        self.positions, self.rotations = positions_before.copy(), rotations_before.copy()
        self._before = positions_before, rotations_before
        arrays = addresses(self.positions, self.rotations, *self._before)
        self._structure = _CourseStructure(None, None, *arrays, len(positions_before))
        self._all = ctypes.byref(self._structure)
        self._run = library().morse_glide_ticks
        self._run.argtypes, self._run.restype = (c_void_p, c_int64), c_int64
        self._keep: tuple[object, ...] = ()

    @property
    def place(self) -> int:
        """The address of the structure."""
        return ctypes.addressof(self._structure)

    def follow(self, robots: GliderWork, placed: Placed, positions: Floats, rotations: Floats) -> bool:
        """Set the robots, and the present poses (at least K rows); return False if the kernel cannot drive them."""
        if not isinstance(robots, NativeGliders):
            return False
        if self._keep != (robots, placed):
            self._keep = robots, placed
            self._structure.robots, self._structure.placed = robots.place, placed.place
        count = len(self.positions)
        self.positions[...], self.rotations[...] = positions[:count], rotations[:count]
        return True

    def ticks(self, ticks: int) -> int:
        """Run ticks; return their number, which is smaller if a robot does not glide."""
        count: int = self._run(self._all, ticks)
        return count


#: what has been done with a driven robot in a tick
GLIDES, TURNS, SHIFTS = 1, 2, 4
#: pi/2 in three parts; the product of the first part and a number below 2^20 is exact
_HALF_PI = tuple(map(float.fromhex, ("0x1.921fb544p+0", "0x1.0b4611a6p-34", "0x1.3198a2e037073p-69")))
_TWO_OVER_PI = 0.63661977236758134308


@lru_cache(maxsize=1024)  # commands are often equal for many ticks
def turn_by(angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle by sums and products only, bit-identical on all platforms."""
    if not math.isfinite(angle):
        return math.nan, math.nan
    angle += 0.0  # no negative zero
    quarters = float(round(angle * _TWO_OVER_PI))
    x = ((angle - quarters * _HALF_PI[0]) - quarters * _HALF_PI[1]) - quarters * _HALF_PI[2]
    z = x * x
    # Taylor series; within an eighth of a turn, the next terms are below the last bit
    s = 1.0 - z / 110.0 * (1.0 - z / 156.0 * (1.0 - z / 210.0 * (1.0 - z / 272.0)))
    s = 1.0 - z / 20.0 * (1.0 - z / 42.0 * (1.0 - z / 72.0 * s))
    s = x - x * (z / 6.0 * s)
    c = 1.0 - z / 132.0 * (1.0 - z / 182.0 * (1.0 - z / 240.0 * (1.0 - z / 306.0)))
    c = 1.0 - z / 12.0 * (1.0 - z / 30.0 * (1.0 - z / 56.0 * (1.0 - z / 90.0 * c)))
    c = 1.0 - z / 2.0 * c
    odd = quarters % 4.0
    if odd == 0.0:
        return c, s
    return (-s, c) if odd == 1.0 else (-c, -s) if odd == 2.0 else (s, -c)


def arc(x: float, y: float, half: float) -> tuple[float, float, float, float]:
    """The chord of an arc: the constant velocity that ends at the same position, in the initial axes.

    Args:
        x, y: velocity in the axes of the body.
        half: half the turning angle, rad.

    Returns:
        The velocity; cosine and sine of ``half``.
    """
    if not abs(half) > 1e-9:
        return x, y, 1.0, 0.0
    cosine, sine = turn_by(half)
    chord = sine / half
    return chord * (cosine * x - sine * y), chord * (sine * x + cosine * y), cosine, sine
