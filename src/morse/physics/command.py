"""Velocity commands: what actuators ask of bodies for one tick."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from morse.physics import rigid

if TYPE_CHECKING:
    from collections.abc import Sequence


class Command(NamedTuple):
    """A velocity that a body has during one tick.

    Attributes:
        linear: m/s along the axes of the body.
        angular: rad/s about the axes of the body.
        shift: the body moves by that much without gaining momentum.
        ground: vertical speed, roll and pitch rates stay what they are.
    """

    linear: Sequence[float]
    angular: Sequence[float]
    shift: bool
    ground: bool

    @property
    def is_rest(self) -> bool:
        """True for a command to stand still."""
        return not (any(self.linear) or any(self.angular))


def midway(linear: Sequence[float], angular: Sequence[float], period: float) -> tuple[float, float, float]:
    """The constant velocity, in the frame at the start of a tick, that ends where the arc ends.

    A body that turns at a constant rate runs along an arc; its chord points along the heading
    in the middle of the tick and is shorter by ``sin(a)/a``, ``a`` half the angle turned.
    """
    wx, wy, wz = angular
    rate = math.sqrt(wx * wx + wy * wy + wz * wz)
    half = 0.5 * rate * period
    if half < 1e-9:
        return linear[0], linear[1], linear[2]
    scale = 0.5 * period
    x, y, z = rigid.turn(rigid.rotation_of_vector((wx * scale, wy * scale, wz * scale)), linear)
    # only the part across the axis is bent
    along = (wx * linear[0] + wy * linear[1] + wz * linear[2]) / (rate * rate)
    ax, ay, az = along * wx, along * wy, along * wz
    chord = math.sin(half) / half
    return ax + chord * (x - ax), ay + chord * (y - ay), az + chord * (z - az)
