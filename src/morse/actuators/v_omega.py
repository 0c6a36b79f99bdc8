"""Drives a robot by forward speed and yaw rate."""

from morse.core.actuator import Actuator
from morse.core.declarations import BuilderDefaults
from morse.core.services import service
from morse.helpers.components import add_data, add_property


class MotionVW(Actuator):
    """Applies a linear speed along X and an angular speed about Z to the robot."""

    _name = "Linear and angular speed (Vx, W) actuator"
    _short_desc = "Motion controller using linear and angular speeds"
    _builder = BuilderDefaults()

    add_data("v", 0.0, "float", "Linear speed along the X axis of the robot", unit="m/s")
    add_data("w", 0.0, "float", "Angular speed about the Z axis of the robot", unit="rad/s")
    add_property(
        "_type",
        "Velocity",
        "ControlType",
        "string",
        "Velocity sets the speed of the body, Position shifts it each tick",
    )

    _type: str

    @service
    def set_speed(self, v: float, w: float) -> None:
        """Set both speeds.

        Args:
            v: linear speed, m/s.
            w: angular speed, rad/s.
        """
        self.local_data["v"] = v
        self.local_data["w"] = w

    @service
    def stop(self) -> None:
        """Come to a halt."""
        self.local_data["v"] = 0.0
        self.local_data["w"] = 0.0

    def default_action(self) -> None:
        """Apply the speeds."""
        data = self.local_data
        self.robot_parent.apply_speed(self._type, (data["v"], 0.0, 0.0), (0.0, 0.0, data["w"]))
