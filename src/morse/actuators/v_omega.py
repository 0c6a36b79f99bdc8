"""Drives a robot by forward speed and yaw rate."""

from __future__ import annotations

from morse.actuators.speed_command import SpeedCommand
from morse.core.robot import drives_body
from morse.helpers.components import add_property, while_same


class MotionVW(SpeedCommand):
    """Applies a linear speed along X and an angular speed about Z to the robot."""

    _name = "Linear and angular speed (Vx, W) actuator"
    _short_desc = "Motion controller using linear and angular speeds"

    add_property(
        "_type",
        "Velocity",
        "ControlType",
        "string",
        "Velocity sets the speed, Position shifts the body each tick",
        choices=("Velocity", "Position"),
    )

    _type: str

    @while_same("v", "w")
    def default_action(self) -> None:
        """Apply the speeds."""
        (v,), w = self.speeds()
        self.robot_parent.apply_speed(self._type, (v, 0.0, 0.0), (0.0, 0.0, w))

    def may_wait(self) -> bool:
        """Whether the robot is driven as one body and the speeds have no limits."""
        return drives_body(self.robot_parent) and not self.is_limited()
