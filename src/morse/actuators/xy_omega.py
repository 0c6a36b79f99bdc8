"""Drives a robot that can move sideways."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.core.limits import SPEED, TURN_RATE
from morse.core.robot import drives_body
from morse.helpers.components import add_data, add_kind, add_property

if TYPE_CHECKING:
    from morse.core.group import Group


class MotionXYW(Actuator):
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

    _type: str

    def default_action(self) -> None:
        """Apply the speeds."""
        data = self.local_data
        self.robot_parent.apply_speed(self._type, (data["x"], data["y"], 0.0), (0.0, 0.0, data["w"]))

    @classmethod
    def act_together(cls, group: Group) -> None:
        """Apply the speeds of all members."""
        group.drive(group.attributes("_type"), group.read("x"), group.read("y"), group.read("w"))

    def may_act_together(self) -> bool:
        """Only with a robot that is driven as one body."""
        return drives_body(self.robot_parent)
