"""How far the sensor has moved."""

from __future__ import annotations

import math
from typing import Any

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_level
from morse.helpers.transformation import Transformation3d

_DIFFERENTIAL = ["differential"]
_INTEGRATED = ["integrated"]


class Odometry(Sensor):
    """Measures displacement, exactly; see the modifiers for the errors of real odometry.

    The integrated level gives the pose relative to the one at the start, and the displacement
    of the body in its own axes per second.
    """

    _name = "Odometry"
    _short_desc = "An odometry sensor that returns raw, partially integrated or fully integrated displacement"
    _builder = BuilderDefaults(visual=Visual("cylinder", (0.02, 0.02, 0.02), (0.1, 0.1, 0.8)))

    add_level("raw", "morse.sensors.odometry.RawOdometry", "raw odometry: only the distance since the last tick")
    add_level(
        "differential",
        None,
        "differential odometry: the displacement since the last tick, in the axes of the start pose",
    )
    add_level(
        "integrated",
        "morse.sensors.odometry.IntegratedOdometry",
        "integrated odometry: the pose relative to the start pose, and velocities",
        default=True,
    )

    add_data("dS", 0.0, "float", "Curvilinear distance since the last tick", level="raw", unit="m")
    add_data("dx", 0.0, "float", "Change of X", level=_DIFFERENTIAL, unit="m")
    add_data("dy", 0.0, "float", "Change of Y", level=_DIFFERENTIAL, unit="m")
    add_data("dz", 0.0, "float", "Change of Z", level=_DIFFERENTIAL, unit="m")
    add_data("dyaw", 0.0, "float", "Change of the rotation about Z", level=_DIFFERENTIAL, unit="rad")
    add_data("dpitch", 0.0, "float", "Change of the rotation about Y", level=_DIFFERENTIAL, unit="rad")
    add_data("droll", 0.0, "float", "Change of the rotation about X", level=_DIFFERENTIAL, unit="rad")
    add_data("x", 0.0, "float", "X in the frame of the start pose", level=_INTEGRATED, unit="m")
    add_data("y", 0.0, "float", "Y in the frame of the start pose", level=_INTEGRATED, unit="m")
    add_data("z", 0.0, "float", "Z in the frame of the start pose", level=_INTEGRATED, unit="m")
    add_data("yaw", 0.0, "float", "Rotation about Z since the start", level=_INTEGRATED, unit="rad")
    add_data("pitch", 0.0, "float", "Rotation about Y since the start", level=_INTEGRATED, unit="rad")
    add_data("roll", 0.0, "float", "Rotation about X since the start", level=_INTEGRATED, unit="rad")
    add_data("vx", 0.0, "float", "Velocity along its X axis", level=_INTEGRATED, unit="m/s")
    add_data("vy", 0.0, "float", "Velocity along its Y axis", level=_INTEGRATED, unit="m/s")
    add_data("vz", 0.0, "float", "Velocity along its Z axis", level=_INTEGRATED, unit="m/s")
    add_data("wz", 0.0, "float", "Rate of the rotation about Z", level=_INTEGRATED, unit="rad/s")
    add_data("wy", 0.0, "float", "Rate of the rotation about Y", level=_INTEGRATED, unit="rad/s")
    add_data("wx", 0.0, "float", "Rate of the rotation about X", level=_INTEGRATED, unit="rad/s")

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        self.original_pos = Transformation3d(obj)
        self.previous_pos = self.original_pos.transformation3d_with(self.original_pos)

    def relative_pose(self) -> Transformation3d:
        """The present pose in the frame of the start pose."""
        return self.original_pos.transformation3d_with(self.position_3d)

    def default_action(self) -> None:
        """Take the displacement since the last tick."""
        pose, before = self.relative_pose(), self.previous_pos
        data = self.local_data
        data["dx"], data["dy"], data["dz"] = pose.x - before.x, pose.y - before.y, pose.z - before.z
        data["dyaw"] = _shortest(pose.yaw - before.yaw)
        data["dpitch"] = _shortest(pose.pitch - before.pitch)
        data["droll"] = _shortest(pose.roll - before.roll)
        self.previous_pos = pose


class RawOdometry(Odometry):
    """Measures only the distance since the last tick."""

    def default_action(self) -> None:
        """Take the distance since the last tick."""
        pose = self.relative_pose()
        self.local_data["dS"] = pose.distance(self.previous_pos)
        self.previous_pos = pose


class IntegratedOdometry(Odometry):
    """Measures the pose relative to the start, and velocities."""

    def default_action(self) -> None:
        """Take the pose relative to the start, and the displacement per second."""
        pose, before, data = self.relative_pose(), self.previous_pos, self.local_data
        data["x"], data["y"], data["z"] = pose.x, pose.y, pose.z
        data["yaw"], data["pitch"], data["roll"] = pose.yaw, pose.pitch, pose.roll
        step = before.transformation3d_with(pose)
        rate = self.frequency
        data["vx"], data["vy"], data["vz"] = step.x * rate, step.y * rate, step.z * rate
        data["wz"] = _shortest(pose.yaw - before.yaw) * rate
        data["wy"] = _shortest(pose.pitch - before.pitch) * rate
        data["wx"] = _shortest(pose.roll - before.roll) * rate
        self.previous_pos = pose


def _shortest(angle: float) -> float:
    return math.remainder(angle, 2.0 * math.pi)
