"""What actuators that take a forward speed and a yaw rate have in common."""

from morse.core.actuator import Actuator
from morse.core.services import service
from morse.helpers.components import add_data


class SpeedCommand(Actuator):
    """Holds a linear speed along X and an angular speed about Z."""

    add_data("v", 0.0, "float", "Linear speed along the X axis of the robot", unit="m/s")
    add_data("w", 0.0, "float", "Angular speed about the Z axis of the robot", unit="rad/s")

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
