"""Odometry."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind, add_level, add_state, computed, euler, on_read
from morse.helpers.transformation import Transformation3d

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.robot import Robot
    from morse.core.world import Body

_DIFF = ["differential"]
_FULL = ["integrated"]
_INTEGRATED = ("x", "y", "z", "yaw", "pitch", "roll", "vx", "vy", "vz", "wz", "wy", "wx")


def _body_rates(data: Mapping[str, float]) -> list[float]:
    """Return the angular velocity in body axes, rad/s, from the rates of the Euler angles.

    J. Diebel, "Representing Attitude: Euler Angles, Unit Quaternions, and Rotation Vectors" (2006), equation 75.
    """
    sin_roll, cos_roll = math.sin(data["roll"]), math.cos(data["roll"])
    sin_pitch, cos_pitch = math.sin(data["pitch"]), math.cos(data["pitch"])
    roll_rate, pitch_rate, yaw_rate = data["wx"], data["wy"], data["wz"]
    return [
        roll_rate - sin_pitch * yaw_rate,
        cos_roll * pitch_rate + sin_roll * cos_pitch * yaw_rate,
        -sin_roll * pitch_rate + cos_roll * cos_pitch * yaw_rate,
    ]


class Odometry(Sensor):
    """Measures exact displacement; see the modifiers for the errors of real odometry.

    The integrated level contains the pose relative to the start pose, and the displacement per second in body axes.
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

    add_data("dS", 0.0, "float", "Curvilinear distance since the last tick", level="raw", unit="m", low=0.0)
    add_data("dx", 0.0, "float", "Change of X", level=_DIFF, unit="m", frame="start")
    add_data("dy", 0.0, "float", "Change of Y", level=_DIFF, unit="m", frame="start")
    add_data("dz", 0.0, "float", "Change of Z", level=_DIFF, unit="m", frame="start")
    add_data("dyaw", 0.0, "float", "Change of yaw", level=_DIFF, unit="rad", frame="start", angle=True)
    add_data("dpitch", 0.0, "float", "Change of pitch", level=_DIFF, unit="rad", frame="start", angle=True)
    add_data("droll", 0.0, "float", "Change of roll", level=_DIFF, unit="rad", frame="start", angle=True)
    add_data("x", 0.0, "float", "X in the frame of the start pose", level=_FULL, unit="m", frame="start")
    add_data("y", 0.0, "float", "Y in the frame of the start pose", level=_FULL, unit="m", frame="start")
    add_data("z", 0.0, "float", "Z in the frame of the start pose", level=_FULL, unit="m", frame="start")
    add_data("yaw", 0.0, "float", "Rotation about Z", level=_FULL, unit="rad", frame="start", angle=True)
    add_data("pitch", 0.0, "float", "Rotation about Y", level=_FULL, unit="rad", frame="start", angle=True)
    add_data("roll", 0.0, "float", "Rotation about X", level=_FULL, unit="rad", frame="start", angle=True)
    add_data("vx", 0.0, "float", "Velocity along its X axis", level=_FULL, unit="m/s", frame="own")
    add_data("vy", 0.0, "float", "Velocity along its Y axis", level=_FULL, unit="m/s", frame="own")
    add_data("vz", 0.0, "float", "Velocity along its Z axis", level=_FULL, unit="m/s", frame="own")
    add_data("wz", 0.0, "float", "Rate of the rotation about Z", level=_FULL, unit="rad/s", frame="start")
    add_data("wy", 0.0, "float", "Rate of the rotation about Y", level=_FULL, unit="rad/s", frame="start")
    add_data("wx", 0.0, "float", "Rate of the rotation about X", level=_FULL, unit="rad/s", frame="start")

    add_kind(
        "odometry",
        level="integrated",
        position=("x", "y", "z"),
        orientation=euler("roll", "pitch", "yaw"),
        linear=("vx", "vy", "vz"),
        angular=computed(_body_rates, axes=("wx", "wy", "wz")),
    )

    add_state("original_pos", Transformation3d, "Pose at the start, or where reset() was called")
    add_state("previous_pos", Transformation3d, "Pose at the last measurement")
    add_state("_time", float, "Time of the last measurement", unit="s")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self.original_pos = Transformation3d(obj)
        self.previous_pos = self.original_pos.transformation3d_with(self.original_pos)
        self._time = self.clock.time

    def relative_pose(self) -> Transformation3d:
        """The present pose in the frame of the start pose."""
        return self.original_pos.transformation3d_with(self.position_3d)

    def placed(self) -> None:
        """The next displacement is that from the present pose."""
        self.previous_pos = self.original_pos.transformation3d_with(Transformation3d(self.bge_object))
        self._time = self.clock.time

    def default_action(self) -> None:
        """Measure the displacement since the last tick."""
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
        """Measure the distance since the last tick."""
        pose = self.relative_pose()
        self.local_data["dS"] = pose.distance(self.previous_pos)
        self.previous_pos = pose


class IntegratedOdometry(Odometry):
    """Measures the pose relative to the start, and velocities."""

    @on_read
    def default_action(self) -> None:
        """Measure the pose relative to the start, and the displacement per second."""
        pose = self.relative_pose()
        now = self.local_data["timestamp"]
        rate = _rate(self.frequency, now - self._time)
        self.local_data.update(zip(_INTEGRATED, _numbers(pose, self.previous_pos, rate), strict=True))
        self.previous_pos, self._time = pose, now

    def remember(self) -> None:
        """Set the pose from which the next displacement is measured."""
        self.previous_pos, self._time = self.relative_pose(), self.local_data["timestamp"]


def _rate(frequency: float, duration: float) -> float:
    """Return the inverse of the time since the last measurement, Hz: a program may measure between two periods."""
    is_regular = duration <= 0.0 or abs(duration * frequency - 1.0) < 1e-6
    return frequency if is_regular else 1.0 / duration


def _numbers(pose: Transformation3d, before: Transformation3d, rate: float) -> tuple[float, ...]:
    """Return the fields `_INTEGRATED`, from two poses relative to the start, with a rate in Hz."""
    step = before.transformation3d_with(pose)
    x, y, z, yaw, pitch, roll = pose.numbers()
    _, _, _, old_yaw, old_pitch, old_roll = before.numbers()
    rates = [_shortest(b - a) * rate for a, b in ((old_yaw, yaw), (old_pitch, pitch), (old_roll, roll))]
    return x, y, z, yaw, pitch, roll, step.x * rate, step.y * rate, step.z * rate, *rates


def _shortest(angle: float) -> float:
    return math.remainder(angle, 2.0 * math.pi)
