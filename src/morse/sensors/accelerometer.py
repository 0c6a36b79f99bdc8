"""Distance, velocity and acceleration of the robot."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults, Visual
from morse.helpers.components import add_data, add_kind, add_state
from morse.mathutils.rotations import turn_back
from morse.sensors.motion_sensor import MotionSensor

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.robot import Robot
    from morse.core.world import Body

_ZERO = [0.0, 0.0, 0.0]


class Accelerometer(MotionSensor):
    """Measures distance, velocity and acceleration of the robot, without gravity. See `IMU` for specific force."""

    _name = "Accelerometer"
    _short_desc = "A sensor returning the distance since the last measurement, velocity and acceleration of the robot"
    _source = "Newtonian kinematics; differences of velocity over a tick"
    _builder = BuilderDefaults(visual=Visual("cube", (0.04, 0.04, 0.02), (0.3, 0.9, 0.6)))

    add_data("distance", 0.0, "float", "Distance from the position of the last measurement", unit="m", low=0.0)
    add_data("velocity", _ZERO, "vec3<float>", "Velocity", unit="m/s", frame="own", shape=3)
    add_data("acceleration", _ZERO, "vec3<float>", "Acceleration, no gravity", unit="m/s^2", frame="own", shape=3)
    add_data("angular_acceleration", _ZERO, "vec3<float>", "Angular acceleration", unit="rad/s^2", frame="own", shape=3)
    add_kind("accel", linear="acceleration", angular="angular_acceleration")

    add_state("_place", tuple, "Position at the last measurement", unit="m")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._place: Sequence[float] = self._pose[0]

    def placed(self) -> None:
        """The next distance is that from the present position."""
        super().placed()
        self._place = self._pose[0]

    def measure(self) -> None:
        """Measure distance, velocity and acceleration."""
        motion = self.motion()
        position, rotation = self.position_3d.get_pose()
        data = self.local_data
        data["distance"] = math.dist(position, self._place)
        self._place = position
        data["velocity"] = list(turn_back(rotation, motion.linear))
        data["acceleration"] = list(turn_back(rotation, motion.acceleration))
        data["angular_acceleration"] = list(turn_back(rotation, motion.angular_acceleration))
