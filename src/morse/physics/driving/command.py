"""Velocity commands of actuators for one tick."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from morse.physics.poses import rigid

if TYPE_CHECKING:
    from collections.abc import Sequence


class Command(NamedTuple):
    """A velocity that a body has during one tick.

    Attributes:
        linear: m/s along the axes of the body.
        angular: rad/s about the axes of the body.
        shift: whether the body moves without gaining momentum.
        ground: whether the vertical speed and the roll and pitch rates are left unchanged.
    """

    linear: Sequence[float]
    angular: Sequence[float]
    shift: bool
    ground: bool

    @property
    def is_rest(self) -> bool:
        """Whether the command is zero."""
        return not (any(self.linear) or any(self.angular))


def midway(linear: Sequence[float], angular: Sequence[float], period: float) -> tuple[float, float, float]:
    """Return the constant velocity, in the frame at the start of a tick, that leads to the end of the arc.

    A body that turns at a constant rate moves along an arc. The chord of the arc points along the heading in the middle
    of the tick and is shorter by the factor ``sin(a)/a``, where ``a`` is half the angle turned.
    """
    wx, wy, wz = angular
    rate = math.sqrt(wx * wx + wy * wy + wz * wz)
    half = 0.5 * rate * period
    if half < 1e-9:
        return linear[0], linear[1], linear[2]
    scale = 0.5 * period
    x, y, z = rigid.turn(rigid.rotation_of_vector((wx * scale, wy * scale, wz * scale)), linear)
    # only the component perpendicular to the axis is rotated
    along = (wx * linear[0] + wy * linear[1] + wz * linear[2]) / (rate * rate)
    ax, ay, az = along * wx, along * wy, along * wz
    chord = math.sin(half) / half
    return ax + chord * (x - ax), ay + chord * (y - ay), az + chord * (z - az)
