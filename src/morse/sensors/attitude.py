"""Attitude and angular velocity."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults, Visual
from morse.helpers.components import add_data, add_kind, add_property, euler
from morse.helpers.geodesy import angle_against_north
from morse.mathutils import Euler
from morse.mathutils.rotations import turn_back
from morse.sensors.motion_sensor import MotionSensor

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.robot import Robot
    from morse.core.world import Body


class Attitude(MotionSensor):
    """Measures the absolute attitude and the angular velocity.

    With ``UseAngleAgainstNorth`` the attitude is relative to east, north and up; ``env.properties(
    angle_against_north=...)`` is the rotation of the axes of the world from these, rad.
    """

    _name = "Attitude"
    _short_desc = "A sensor returning the absolute attitude and the angular velocity of the robot"
    _builder = BuilderDefaults(visual=Visual("cube", (0.04, 0.04, 0.02), (0.3, 0.9, 0.6)))

    add_data("rotation", Euler(), "Euler", "Yaw, pitch and roll", unit="rad", frame="world", shape=3, angle=True)
    add_data("angular_velocity", [0.0, 0.0, 0.0], "vec3<float>", "Angular velocity", unit="rad/s", frame="own", shape=3)
    add_property(
        "_use_angle_against_north",
        False,
        "UseAngleAgainstNorth",
        "bool",
        "Measure the yaw counter-clockwise from east, not from the X axis of the world",
    )
    add_kind("attitude", orientation=euler("rotation"), rates="angular_velocity")

    _use_angle_against_north: bool

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._north = angle_against_north(self.context.scene.properties)

    @property
    def field_changes(self) -> Mapping[str, Mapping[str, object]]:
        """Return the frame of the attitude, which is east-north-up with ``UseAngleAgainstNorth``."""
        return {"rotation": {"frame": "enu"}} if self._use_angle_against_north else {}

    def measure(self) -> None:
        """Measure attitude and angular velocity."""
        motion = self.motion()
        *_, yaw, pitch, roll = self.position_3d.numbers()
        if self._use_angle_against_north:
            yaw = math.remainder(yaw + self._north, math.tau)
        data = self.local_data
        data["rotation"] = Euler((roll, pitch, yaw))
        data["angular_velocity"] = list(turn_back(self.position_3d.get_pose()[1], motion.angular))
