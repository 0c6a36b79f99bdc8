"""Drives a robot that can move sideways."""

from morse.core.actuator import Actuator
from morse.helpers.components import add_data, add_property


class MotionXYW(Actuator):
    """Applies linear speeds along X and Y and an angular speed about Z to the robot."""

    _name = "Linear and angular speed (Vx, Vy, W) actuator"
    _short_desc = "Motion controller using linear (Vx, Vy) and angular speeds"

    add_data("x", 0.0, "float", "Linear speed along the X axis of the robot", unit="m/s")
    add_data("y", 0.0, "float", "Linear speed along the Y axis of the robot", unit="m/s")
    add_data("w", 0.0, "float", "Angular speed about the Z axis of the robot", unit="rad/s")
    add_property(
        "_type",
        "Velocity",
        "ControlType",
        "string",
        "Velocity sets the speed of the body, Position shifts it each tick",
    )

    _type: str

    def default_action(self) -> None:
        """Apply the speeds."""
        data = self.local_data
        self.robot_parent.apply_speed(self._type, (data["x"], data["y"], 0.0), (0.0, 0.0, data["w"]))
