"""Moves a robot to a position on a straight line."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.actuators.goal_motion import TRANSIT, GoalMotion
from morse.core.limits import LENGTH
from morse.core.robot import drives_body
from morse.helpers.components import add_kind, add_property

if TYPE_CHECKING:
    from collections.abc import Sequence

#: cosine of the largest tilt of a robot that stands upright
_UPRIGHT = 0.5


class Destination(GoalMotion):
    """Moves the robot in a straight line to a position, in three dimensions and without rotation.

    The robot stops as soon as the three-dimensional distance is at most the tolerance.
    """

    _name = "Destination"
    _short_desc = "Motion controller which moves the robot on a straight line to a position"

    add_property("_tolerance", 0.5, "Tolerance", "float", "Distance at which the robot has arrived", **LENGTH)
    add_property("_speed", 5.0, "Speed", "float", "Speed of the robot", unit="m/s", low=0.0, high=1e4)
    add_kind("pose", position=("x", "y", "z"))

    _tolerance: float
    _speed: float

    def default_action(self) -> None:
        """Move by one tick."""
        data = self.local_data
        x, y, z = self.bge_object.world_pose()[0]
        dx, dy, dz = data["x"] - x, data["y"] - y, data["z"] - z
        distance = math.sqrt(dx * dx + dy * dy + dz * dz)
        if distance <= self._tolerance:
            self._arrive()
            return
        self.robot_parent.move_status = TRANSIT
        share = min(self._speed, distance * self.frequency) / distance
        r = self.robot_parent.bge_object.world_pose()[1]
        dx, dy, dz = share * dx, share * dy, share * dz
        if self._is_level(r):
            # the ground determines the vertical speed of a ground robot; a command in its plane allows it to glide
            self._drive(((r[4] * dx - r[1] * dy) / r[8], (r[0] * dy - r[3] * dx) / r[8], 0.0))
            return
        self._drive(
            (
                r[0] * dx + r[3] * dy + r[6] * dz,
                r[1] * dx + r[4] * dy + r[7] * dz,
                r[2] * dx + r[5] * dy + r[8] * dz,
            )
        )

    def _is_level(self, r: Sequence[float]) -> bool:
        """Whether the robot stands upright on the ground."""
        robot = self.robot_parent
        return bool(robot._is_ground_robot) and r[8] > _UPRIGHT and drives_body(robot)
