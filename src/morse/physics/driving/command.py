"""Velocity commands of actuators for one tick, and what slows down bodies.

After ``env.use_physics_of_1_4()``, friction and damping act on a driven robot within each tick, in the two physics
steps that a tick of 1.4 had: each step scales the velocity by ``(1 - d)^(T/2)``, with the damping ``d`` of the robot,
and reduces it by ``mu g T/2``. Sensors measure the velocity after both steps.

The centre of mass of robots without driven wheels is at their origin, so that forces there do not turn them. The linear
damping of bodies that only forces move is smaller than that of driven robots.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import mujoco
import numpy as np

from morse.physics.poses import rigid

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.physics.model.layout import Slot
    from morse.scene import BodySettings


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


#: friction of every floor in 1.4, by which the friction of a robot is multiplied
FLOOR = 0.5
#: friction of a robot to which its script gives none
_ROBOT = 0.5
#: share of the relative loss of speed by which friction reduces the yaw rate
_YAW_LOSS = 0.4
#: linear damping of a body that only forces move, relative to that of a driven robot
FREE_DAMPING = 0.6
#: yaw rate of a robot that skids on more than two wheels, relative to its command
SKIDDING = 0.985


def friction_of(body: BodySettings) -> float:
    """Return the friction coefficient between a robot and the floor."""
    return FLOOR * (_ROBOT if body.friction is None else body.friction)


class Slowing(NamedTuple):
    """A command that friction and damping have reduced.

    Attributes:
        command: mean velocities of the tick.
        linear, angular: velocities at the end of the tick, relative to the mean ones.
    """

    command: Command
    linear: float
    angular: float


class Slowdown(NamedTuple):
    """The losses of a robot in a physics step of half a tick.

    Attributes:
        linear, angular: share of the velocity that damping leaves.
        friction: speed that friction takes, m/s; of a robot that touches nothing, none.
    """

    linear: float
    angular: float
    friction: float

    @classmethod
    def of(cls, body: BodySettings, rolling: float | None, gravity: float, period: float) -> Slowdown:
        """The losses of a robot.

        Args:
            rolling: friction of a robot that rolls on passive wheels, if its script sets none; None: it slides.
            gravity: m/s^2.
            period: duration of a tick, s.
        """
        linear, angular = (
            (1.0 - min(max(d, 0.0), 0.999)) ** (0.5 * period) for d in (body.linear_damping, body.angular_damping)
        )
        friction = friction_of(body) if rolling is None or body.friction is not None else FLOOR * rolling
        return cls(linear, angular, 0.5 * friction * gravity * period)

    def slow(self, command: Command, touches: bool) -> Slowing:
        """Reduce the command of a tick.

        Args:
            touches: whether the robot stands on something.
        """
        speed = math.hypot(*command.linear[:2])
        mean, end = self._losses(speed, self.linear, self.friction if touches else 0.0)
        yaw_rate, turning = self._losses(1.0, self.angular, 0.0)
        if touches and speed:
            damped, stays = self._losses(1.0, self.linear, 0.0)
            yaw_rate -= _YAW_LOSS * (damped - mean)
            turning -= _YAW_LOSS * (stays - end)
        (x, y, z), (roll, pitch, yaw) = command.linear, command.angular
        if not command.ground:
            z, roll, pitch = z * mean, roll * yaw_rate, pitch * yaw_rate
        slowed = Command((x * mean, y * mean, z), (roll, pitch, yaw * yaw_rate), command.shift, command.ground)
        return Slowing(slowed, end / mean if mean else 0.0, turning / yaw_rate)

    @staticmethod
    def _losses(speed: float, share: float, friction: float) -> tuple[float, float]:
        """Return the mean speed of a tick, and that at its end, relative to the commanded one."""
        if not speed:
            return share, share
        first = max(0.0, speed * share - friction)
        second = max(0.0, first * share - friction)
        return 0.5 * (first + second) / speed, second / speed


def set_damping(model: mujoco.MjModel, slot: Slot, of_1_4: bool) -> None:
    """Set the damping of a free body, given as the share of the velocity that it loses per second.

    ``v' = -c v`` with ``exp(-c) = 1 - d`` keeps ``1 - d`` of the velocity after a second.

    Args:
        of_1_4: whether the scene has the physics of MORSE 1.4; see `morse.physics.driving.command`.
    """
    body = slot.frame.node.body
    if slot.frame.node.articulation is not None and not body.linear_damping and not body.angular_damping:
        # the joint has the damping of its file
        return
    linear, angular = (-math.log(1.0 - min(max(d, 0.0), 0.999)) for d in (body.linear_damping, body.angular_damping))
    linear *= FREE_DAMPING if of_1_4 else 1.0
    model.dof_damping[slot.dof : slot.dof + 3] = linear * model.body_mass[slot.body]
    # the inertia about the axes of the body: it may differ by a factor of ten among them
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[slot.body])
    about = (turn.reshape(3, 3) ** 2 * model.body_inertia[slot.body]).sum(axis=1)
    model.dof_damping[slot.dof + 3 : slot.dof + 6] = angular * about
