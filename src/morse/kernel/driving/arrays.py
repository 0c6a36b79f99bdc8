"""The arrays of driven robots, shared by C and Python."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]
    Bytes = NDArray[np.uint8]


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
