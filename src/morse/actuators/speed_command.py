"""The base class of actuators with forward speed and yaw rate."""

from morse.actuators.limited_motion import LimitedMotion
from morse.core.limits import SPEED, TURN_RATE, Speed, TurnRate
from morse.core.services import service
from morse.helpers.components import add_data, add_kind


class SpeedCommand(LimitedMotion):
    """Receives a linear speed along X and an angular speed about Z."""

    add_data("v", 0.0, "float", "Linear speed along the X axis", frame="robot", **SPEED)
    add_data("w", 0.0, "float", "Turning rate about the Z axis", frame="robot", **TURN_RATE)
    add_kind("twist", linear=("v", None, None), angular=(None, None, "w"))

    def commanded(self) -> tuple[tuple[float], float]:
        """See `LimitedMotion.commanded`."""
        return (self.local_data["v"],), self.local_data["w"]

    @service
    def set_speed(self, v: Speed, w: TurnRate) -> None:
        """Set both speeds.

        Args:
            v: linear speed, m/s.
            w: angular speed, rad/s.
        """
        self.local_data["v"] = v
        self.local_data["w"] = w

    @service
    def stop(self) -> None:
        """Set both speeds to 0."""
        self.local_data["v"] = 0.0
        self.local_data["w"] = 0.0
