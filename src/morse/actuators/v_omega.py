"""Drives a robot by forward speed and yaw rate."""

from morse.actuators.speed_command import SpeedCommand
from morse.helpers.components import add_property


class MotionVW(SpeedCommand):
    """Applies a linear speed along X and an angular speed about Z to the robot."""

    _name = "Linear and angular speed (Vx, W) actuator"
    _short_desc = "Motion controller using linear and angular speeds"

    add_property(
        "_type", "Velocity", "ControlType", "string", "Velocity sets the speed, Position shifts the body each tick"
    )

    _type: str

    def default_action(self) -> None:
        """Apply the speeds."""
        data = self.local_data
        self.robot_parent.apply_speed(self._type, (data["v"], 0.0, 0.0), (0.0, 0.0, data["w"]))
