"""Drives a robot by the speeds of its wheels."""

from typing import Any

from morse.core.actuator import Actuator
from morse.core.services import service
from morse.core.wheeled_robot import PhysicsDifferentialRobot
from morse.helpers.components import add_data


class MotionVWDiff(Actuator):
    """Turns the wheels of a robot so that it drives and turns at the speeds asked for."""

    _name = "Differential Driver Actuator: Linear and angular speed (Vx, W) actuator"
    _short_desc = "Motion controller using linear and angular speeds, by the wheels"

    add_data("v", 0.0, "float", "Linear speed along the X axis of the robot", unit="m/s")
    add_data("w", 0.0, "float", "Angular speed about the Z axis of the robot", unit="rad/s")

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        if not isinstance(parent, PhysicsDifferentialRobot):
            raise TypeError(
                f"{parent.name()} ({type(parent).__name__}) has no wheels to drive: "
                "use MotionVW, or a wheeled robot such as Pioneer3DX or SegwayRMP400"
            )

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
        """Turn the wheels."""
        self.robot_parent.apply_vw_wheels(self.local_data["v"], self.local_data["w"])
