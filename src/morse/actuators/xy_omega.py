"""Drives an omnidirectional robot."""

from __future__ import annotations

from morse.actuators.limited_motion import LimitedMotion
from morse.core.limits import SPEED, TURN_RATE
from morse.core.robot import drives_body
from morse.helpers.components import add_data, add_kind, add_property, while_same


class MotionXYW(LimitedMotion):
    """Applies linear speeds along X and Y and an angular speed about Z to the robot."""

    _name = "Linear and angular speed (Vx, Vy, W) actuator"
    _short_desc = "Motion controller using linear (Vx, Vy) and angular speeds"

    add_data("x", 0.0, "float", "Linear speed along the X axis", frame="robot", **SPEED)
    add_data("y", 0.0, "float", "Linear speed along the Y axis", frame="robot", **SPEED)
    add_data("w", 0.0, "float", "Turning rate about the Z axis", frame="robot", **TURN_RATE)
    add_kind("twist", linear=("x", "y", None), angular=(None, None, "w"))
    add_property(
        "_type",
        "Velocity",
        "ControlType",
        "string",
        "Velocity sets the speed of the body, Position shifts it each tick",
        choices=("Velocity", "Position"),
    )

    linear_axes = 2
    _type: str

    @while_same("x", "y", "w")
    def default_action(self) -> None:
        """Apply the speeds."""
        (x, y), w = self.speeds()
        self.robot_parent.apply_speed(self._type, (x, y, 0.0), (0.0, 0.0, w))

    def commanded(self) -> tuple[tuple[float, float], float]:
        """See `LimitedMotion.commanded`."""
        return (self.local_data["x"], self.local_data["y"]), self.local_data["w"]

    def may_wait(self) -> bool:
        """Whether the robot is driven as one body and the speeds have no limits."""
        return drives_body(self.robot_parent) and not self.is_limited()
