"""The arrays of driven robots, as C and Python see them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]
    Bytes = NDArray[np.uint8]


@dataclass(eq=False)
class GliderArrays:
    """N robots of a world with K rigid groups ("slots"); all arrays are in one piece, and stay where they are.

    Attributes:
        slots: (N,) of the robots.
        forward, aside, rate: (N,) commands in the axes of each robot, m/s and rad/s.
        shifts: (N,) 1 for robots that are to keep no momentum.
        dofs: (K,) address of the velocity.
        speeds, margins, extents: (K,) what gliding has planned for, m/s and m; a negative speed: does not glide.
        plain: (K,) 1 for robots whose commands nothing else changes.
        sliding: (K,) 1 for robots that were driven in the tick before.
        trees: (K,) the tree of the engine, or -1.
        asleep: (T,) 0 or more for trees that sleep.
        velocities: of the engine.
        period: of a tick, s.
        done: (N,) result of `GliderWork.begin`, for `GliderWork.end`: see ``c/glide.c``.
        cosines, sines: (N,) of half the angle turned.
        others: (N,) result: the rows that have to be driven separately.
    """

    slots: Integers
    forward: Floats
    aside: Floats
    rate: Floats
    shifts: Bytes
    dofs: Integers
    speeds: Floats
    margins: Floats
    extents: Floats
    plain: Bytes
    sliding: Bytes
    trees: NDArray[np.int32]
    asleep: NDArray[np.int32]
    velocities: Floats
    period: float
    done: Bytes
    cosines: Floats
    sines: Floats
    others: Integers


class GliderWork(Protocol):
    """Drives the robots of a `GliderArrays`."""

    def begin(self, rotations: Floats) -> int:
        """Write the velocities of a tick.

        Args:
            rotations: (K, 9) of all slots, row by row.

        Returns:
            The number of rows in `GliderArrays.others`, robots that have to be driven separately.
        """

    def end(self) -> None:
        """The tick is over: a shift leaves no momentum, a velocity points along the new heading."""


@dataclass(eq=False)
class ChassisArrays:
    """N robots with W wheels.

    Attributes:
        first: (N + 1,) the wheels of robot i are first[i] to first[i + 1].
        geoms, motors: (W,) of each wheel.
        radii, levers: (W,) m; what the speed of each tread adds to the yaw rate, 1/m.
        slots, dofs: (N,) of the robots.
        axles: (N,) metres from the origin ahead to the middle of the wheels.
        frictions: (N,) Coulomb coefficients.
        turnings: (N,) m/s^2 of friction to rad/s^2 of the yaw rate.
        driven: (N,) 1 for robots that are commanded as bodies in this tick.
        touching: (C, 2) geoms that touch, in its first rows; it may be replaced by a longer one.
        touched: (G,) memory for the work.
        controls, velocities, dimensions: of the engine.
        period: of a tick, s.
        creep: a robot whose wheels stand and that moves more slowly, m/s and rad/s, is held by plain friction.
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


class ChassisWork(Protocol):
    """Moves the robots of a `ChassisArrays`."""

    def pull(self, rotations: Floats, pairs: int, gravity: float) -> None:
        """Bring the velocities of the robots closer to those of their treads.

        Args:
            rotations: (K, 9) of all slots, row by row.
            pairs: how many rows of `ChassisArrays.touching` count.
            gravity: m/s^2, downward.
        """
