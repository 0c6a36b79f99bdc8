"""Controls a quadrotor by the speeds of its four rotors."""

from __future__ import annotations

import math

from morse.core.actuator import Actuator
from morse.core.limits import FORCE, LENGTH, TORQUE
from morse.helpers import air
from morse.helpers.components import add_data, add_kind, add_property


class QuadrotorDynamicControl(Actuator):
    """Applies the thrust F and the torques tx, ty, tz that result from the speeds w1..w4 of four rotors.

    F = b (w1^2 + w2^2 + w3^2 + w4^2), tz = d (-w1^2 + w2^2 - w3^2 + w4^2). With the configuration ``+`` (rotors behind,
    right, ahead, left) tx = b l (-w2^2 + w4^2), ty = b l (w1^2 - w3^2). With ``x`` (rotors ahead left, ahead right,
    behind right, behind left) tx = b l (w1^2 - w2^2 - w3^2 + w4^2) / sqrt(2), ty = b l (-w1^2 - w2^2 + w3^2 + w4^2) /
    sqrt(2). b is the ThrustFactor, d the DragFactor, l the Lever. The thrust is limited to 1e6 N, the torques to 1e6
    N m.
    """

    applies_forces = True
    _name = "Quadrotor dynamic control"
    _short_desc = "Motion controller using the speeds of the rotors of a quadrotor"
    _source = "thrust and drag of a rotor are proportional to the square of its speed (momentum theory)"

    add_data("engines", [0.0, 0.0, 0.0, 0.0], "list", "Speed of each rotor", unit="rad/s", shape=4, low=-1e5, high=1e5)
    # those of real rotors are below 1e-2
    add_property(
        "_thrust_factor", 9.169e-6, "ThrustFactor", "float", "Thrust of a rotor", unit="N·s^2", low=0.0, high=1.0
    )
    add_property(
        "_drag_factor", 2.4e-7, "DragFactor", "float", "Counter torque of a rotor", unit="N·m·s^2", low=0.0, high=1.0
    )
    add_property("_lever", 0.18, "Lever", "float", "Distance of the rotors from the centre", **LENGTH)
    add_property("_configuration", "+", "Configuration", "string", "Arrangement of the rotors", choices=("+", "x"))
    add_kind("actuators", values="engines")

    _thrust_factor: float
    _drag_factor: float
    _lever: float
    _configuration: str

    def default_action(self) -> None:
        """Apply the thrust and the torques."""
        w1, w2, w3, w4 = (speed * speed for speed in self.local_data["engines"])
        thrust = self._thrust_factor * (w1 + w2 + w3 + w4)
        if not thrust:
            return
        arm = self._thrust_factor * self._lever
        if self._configuration == "+":
            x, y = arm * (w4 - w2), arm * (w1 - w3)
        else:
            arm *= math.sqrt(0.5)
            x, y = arm * (w1 - w2 - w3 + w4), arm * (w3 + w4 - w1 - w2)
        z = self._drag_factor * (w2 - w1 + w4 - w3)
        turning = [min(max(torque, TORQUE["low"]), TORQUE["high"]) for torque in (x, y, z)]
        body = self.robot_parent.bge_object
        lifting = min(thrust * air.thrust(self.context, body), FORCE["high"])
        body.wrench((0.0, 0.0, lifting), turning, True)
