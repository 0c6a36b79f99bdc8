"""Controls the velocity of a rotorcraft."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.actuators.rotorcraft import BankingRotorcraft
from morse.core.limits import SPEED, TURN_RATE, AbsoluteSpeed, Speed, TurnRate
from morse.core.services import service
from morse.helpers.components import add_data, add_kind, add_property, add_state

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body


class RotorcraftVelocity(BankingRotorcraft):
    """Controls the velocity of a rotorcraft by banking and thrust.

    The velocity is given along level axes that turn with the yaw of the robot: X forward, Y left, Z up. The robot banks
    by kp (v wanted - v) - kd dv/dt. As in MORSE 1.4, the yaw rate is about the downward axis: a positive rate turns to
    the right.
    """

    _name = "Rotorcraft velocity motion controller"
    _short_desc = "Motion controller using force and torque to fly a rotorcraft at a velocity"

    add_data("vx", 0.0, "float", "Speed forward, level", frame="own", **SPEED)
    add_data("vy", 0.0, "float", "Speed to the left, level", frame="own", **SPEED)
    add_data("vz", 0.0, "float", "Speed upward", frame="own", **SPEED)
    add_data("vyaw", 0.0, "float", "Yaw rate; positive to the right", frame="frd", **TURN_RATE)
    add_data(
        "tolerance",
        0.2,
        "float",
        "Tolerance of the speed; exists for scripts of 1.4, without effect",
        unit="m/s",
        low=0.0,
    )
    add_property("_v_dgain", 2.0, "VerticalDgain", "float", "Exists for scripts of 1.4, without effect", low=0.0)
    add_property("_yaw_dgain", 8.0, "YawDgain", "float", "Derivative gain of the yaw", unit="1/s", low=0.0)
    add_property("_max_velocity", 2.0, "MaxVelocity", "float", "Exists for scripts of 1.4, without effect", unit="m/s")
    add_kind("twist", linear=("vx", "vy", "vz"), angular=(None, None, "vyaw"))

    add_state("_velocity", tuple | None, "Velocity at the last action", unit="m/s")
    add_state("_yaw_wanted", float | None, "Setpoint of the yaw", unit="rad")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._yaw_wanted = self._angles()[2]
        self._velocity: tuple[float, float] | None = None

    @service
    def setvel(self, vx: Speed, vy: Speed, vz: Speed, vyaw: TurnRate, tolerance: AbsoluteSpeed = 0.1) -> None:
        """Set the velocity.

        Args:
            vx: m/s forward.
            vy: m/s to the left.
            vz: m/s upward.
            vyaw: rad/s to the right.
            tolerance: m/s; without effect.
        """
        new = {"vx": vx, "vy": vy, "vz": vz, "vyaw": vyaw, "tolerance": tolerance}
        self.local_data.update((name, float(value)) for name, value in new.items())

    def default_action(self) -> None:
        """Apply the thrust and the torques."""
        data = self.local_data
        angles = self._angles()
        yaw = angles[2]
        x, y, z = self._velocity_of_mass()
        c, s = math.cos(yaw), math.sin(yaw)
        before = (x, y) if self._velocity is None else self._velocity
        self._velocity = x, y
        kp, kd = self._h_pgain, self._h_dgain * self.frequency
        command_x = kp * (c * data["vx"] - s * data["vy"] - x) - kd * (x - before[0])
        command_y = kp * (s * data["vx"] + c * data["vy"] - y) - kd * (y - before[1])
        self._yaw_wanted = math.remainder(self._yaw_wanted - data["vyaw"] / self.frequency, 2.0 * math.pi)
        self._bank(command_x, command_y, self._v_pgain * (data["vz"] - z), self._yaw_wanted, angles)
