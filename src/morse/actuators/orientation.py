"""Controls the orientation of a robot."""

from __future__ import annotations

import math
from operator import sub
from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.core.limits import ANGLE
from morse.helpers.components import add_data, add_kind, add_property, euler
from morse.mathutils.rotations import rotation_from_euler

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

_ALIKE = 1e-9


_STILL = (0.0, 0.0, 0.0)


class Orientation(Actuator):
    """Sets the orientation of the robot, immediately or at limited speed, without changing its position.

    With a limited speed, the robot turns about each of its axes at a rate that is proportional to the error of roll,
    pitch or yaw, at most that speed, in the shorter direction, until the error is within the tolerance. For a ground
    robot, only the yaw can be controlled at limited speed.
    """

    _name = "Orientation"
    _short_desc = "Motion controller which changes the orientation of the robot"

    add_data("yaw", 0.0, "float", "Rotation about Z; initially that of the robot", frame="world", **ANGLE)
    add_data("pitch", 0.0, "float", "Rotation about Y; initially that of the robot", frame="world", **ANGLE)
    add_data("roll", 0.0, "float", "Rotation about X; initially that of the robot", frame="world", **ANGLE)
    add_kind("attitude", orientation=euler("roll", "pitch", "yaw"))
    add_property(
        "_speed",
        math.inf,
        "speed",
        "float",
        "Largest rate about each axis; infinite for an immediate change",
        unit="rad/s",
        low=0.0,
        allow=("inf",),
    )
    add_property("_tolerance", 0.02, "tolerance", "float", "Errors below it are not corrected", unit="rad", low=0.0)
    add_property(
        "_type",
        "Velocity",
        "ControlType",
        "string",
        "Velocity sets the speed of the body, Position turns it each tick",
        choices=("Velocity", "Position"),
    )

    _speed: float
    _tolerance: float
    _type: str

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        pose = self.robot_parent.position_3d
        for field in ("yaw", "pitch", "roll"):
            self.local_data[field] = float(getattr(pose, field))

    def default_action(self) -> None:
        """Rotate the robot by one tick."""
        data = self.local_data
        if self._speed == math.inf:
            self._force(data["roll"], data["pitch"], data["yaw"])
            return
        here = self.robot_parent.position_3d
        here.update(self.robot_parent.bge_object)
        _, _, _, yaw, pitch, roll = here.numbers()
        rates = [
            self._rate(data["roll"] - roll),
            self._rate(data["pitch"] - pitch),
            self._rate(data["yaw"] - yaw),
        ]
        self.robot_parent.apply_speed(self._type, (0.0, 0.0, 0.0), rates)

    def _rate(self, error: float) -> float:
        error = math.remainder(error, 2.0 * math.pi)
        if abs(error) <= self._tolerance:
            return 0.0
        return math.copysign(min(self._speed, abs(error) * self.frequency), error)

    def _force(self, roll: float, pitch: float, yaw: float) -> None:
        obj = self.robot_parent.bge_object
        target = rotation_from_euler((roll, pitch, yaw), "XYZ")
        place, now = obj.world_pose()
        if max(map(abs, map(sub, target, now))) > _ALIKE:
            obj.set_pose(place, target)
        # a robot that does not turn is not driven, so that it can come to rest
        if obj.velocity()[1] != _STILL:
            obj.set_velocity(None, (0.0, 0.0, 0.0))
