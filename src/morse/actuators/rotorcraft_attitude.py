"""Controls the attitude of a rotorcraft."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.actuators.rotorcraft import Rotorcraft
from morse.core.limits import ANGLE
from morse.helpers.components import add_data, add_kind, add_property, add_state, euler
from morse.helpers.geodesy import angle_against_north

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.robot import Robot
    from morse.core.world import Body


def _by_rate(actuator: RotorcraftAttitude) -> bool:
    return actuator._yaw_rate_control


def _by_angle(actuator: RotorcraftAttitude) -> bool:
    return not actuator._yaw_rate_control


class RotorcraftAttitude(Rotorcraft):
    """Controls roll, pitch and yaw of a rotorcraft, and its thrust as a share of the largest thrust.

    The angles are those of MAVLink and of autopilots, with X forward, Y right and Z down: a positive pitch raises the
    nose, a positive yaw turns to the right. The torque is I (kp e + kd de/dt) thrust. Without thrust the rotors do not
    turn, and the attitude is not controlled.
    """

    _name = "Rotorcraft attitude motion controller"
    _short_desc = "Motion controller using force and torque to hold the attitude of a rotorcraft"

    add_data("roll", 0.0, "float", "Roll", frame="ned", **ANGLE)
    add_data("pitch", 0.0, "float", "Pitch", frame="ned", **ANGLE)
    add_data("yaw", 0.0, "float", "Yaw rate, rad/s; the angle itself without YawRateControl", frame="ned", **ANGLE)
    add_data("thrust", 0.0, "float", "Share of the largest thrust", low=0.0, high=1.0)
    add_property("_rp_pgain", 100.0, "RollPitchPgain", "float", "Proportional gain of roll and pitch", unit="1/s^2")
    add_property("_rp_dgain", 20.0, "RollPitchDgain", "float", "Derivative gain of roll and pitch", unit="1/s")
    add_property("_yaw_pgain", 16.0, "YawPgain", "float", "Proportional gain of the yaw", unit="1/s^2")
    add_property("_yaw_dgain", 4.0, "YawDgain", "float", "Derivative gain of the yaw", unit="1/s")
    add_property("_thrust_factor", 40.0, "ThrustFactor", "float", "Largest thrust", unit="N", low=0.0)
    add_property("_linear_thrust", True, "LinearThrust", "bool", "Thrust is linear in the command; otherwise quadratic")
    add_property("_yaw_rate_control", True, "YawRateControl", "bool", "yaw is a rate; otherwise it is the angle")
    add_property(
        "_use_angle_against_north",
        False,
        "UseAngleAgainstNorth",
        "bool",
        "Measure the yaw clockwise from north; otherwise from the X axis of the world",
    )
    add_kind(
        "attitude", when=_by_rate, orientation=euler("roll", "pitch", None), rates=(None, None, "yaw"), thrust="thrust"
    )
    add_kind("attitude", when=_by_angle, orientation=euler("roll", "pitch", "yaw"), thrust="thrust")

    add_state("_yaw_wanted", float | None, "Setpoint of the yaw", unit="rad")

    _rp_pgain: float
    _rp_dgain: float
    _yaw_pgain: float
    _yaw_dgain: float
    _thrust_factor: float
    _linear_thrust: bool
    _yaw_rate_control: bool
    _use_angle_against_north: bool

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._yaw_wanted: float | None = None

    @property
    def field_changes(self) -> Mapping[str, Mapping[str, object]]:
        """Return the unit of the yaw field, which depends on the property YawRateControl."""
        return {"yaw": {"unit": "rad/s"}} if self._yaw_rate_control else {}

    def _heading(self, yaw: float) -> float:
        """Return the yaw about the downward axis, rad, from the yaw of the robot."""
        if self._use_angle_against_north:
            # the yaw is measured from the X axis of the world, which is rotated from east by that angle
            return math.pi / 2.0 - yaw - angle_against_north(self.context.scene.properties)
        return -yaw

    def default_action(self) -> None:
        """Apply the thrust and the torques."""
        data = self.local_data
        thrust = data["thrust"]
        if not thrust > 0.0:
            self._yaw_wanted = self._errors = None
            return
        roll, pitch, yaw = self._angles()
        heading = self._heading(yaw)
        if self._yaw_rate_control:
            yaw_before = heading if self._yaw_wanted is None else self._yaw_wanted
            yaw_goal = math.remainder(yaw_before + data["yaw"] / self.frequency, 2.0 * math.pi)
            self._yaw_wanted = yaw_goal
        else:
            yaw_goal = data["yaw"]
        errors = (
            math.remainder(data["roll"] - roll, 2.0 * math.pi),
            math.remainder(data["pitch"] + pitch, 2.0 * math.pi),
            math.remainder(yaw_goal - heading, 2.0 * math.pi),
        )
        kp = (self._rp_pgain, self._rp_pgain, self._yaw_pgain)
        kd = (self._rp_dgain, self._rp_dgain, self._yaw_dgain)
        x, y, z = self._torque(errors, kp, kd, thrust)
        self._push((thrust if self._linear_thrust else thrust * thrust) * self._thrust_factor, (x, -y, -z))
