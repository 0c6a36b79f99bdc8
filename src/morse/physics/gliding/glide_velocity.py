"""The velocity of a robot that glides, in the arrays of the engine."""

from __future__ import annotations

from struct import Struct
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

#: a few numbers of the engine are read and written in this way in a third of the time that an array takes
_PLANE, _TWIST, _BYTES = Struct("=2d"), Struct("=6d"), 8


def read(qvel: Any, dof: int) -> tuple[float, ...]:
    """Return the six numbers of the velocity of a body."""
    return _TWIST.unpack_from(qvel, _BYTES * dof)


def put(qvel: Any, dof: int, numbers: Sequence[float]) -> None:
    """Write the six numbers of the velocity of a body."""
    _TWIST.pack_into(qvel, _BYTES * dof, *numbers)


def write(qvel: Any, dof: int, rotation: Sequence[float], x: float, y: float, rate: float) -> None:
    """Write the velocity of a tick: the rotation axis is the vertical of the world, and height and tilt are constant.

    Args:
        qvel: (V,) float64, velocities of the engine.
        dof: address of the robot in them.
        rotation: (9,) rotation of the robot, row by row.
        x, y: velocity along its axes, m/s.
        rate: angular velocity about its Z axis, rad/s.
    """
    a, b, _, d, e, _, g, h, i = rotation
    rate *= i
    _TWIST.pack_into(qvel, _BYTES * dof, a * x + b * y, d * x + e * y, 0.0, g * rate, h * rate, i * rate)


def end(qvel: Any, dof: int, cosine: float, sine: float, shift: bool) -> None:
    """End a tick: remove the momentum of a shift, or rotate the velocity to the new heading.

    Args:
        cosine, sine: of half the angle turned.
    """
    if shift:
        qvel[dof], qvel[dof + 1], qvel[dof + 5] = 0.0, 0.0, 0.0
    else:
        vx, vy = _PLANE.unpack_from(qvel, _BYTES * dof)
        _PLANE.pack_into(qvel, _BYTES * dof, cosine * vx - sine * vy, sine * vx + cosine * vy)
