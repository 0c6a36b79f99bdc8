"""Drives a robot by the speeds of its wheels."""

from typing import Any

from morse.actuators.speed_command import SpeedCommand
from morse.core.wheeled_robot import PhysicsDifferentialRobot


class MotionVWDiff(SpeedCommand):
    """Turns the wheels of a robot so that it drives and turns at the commanded speeds."""

    _name = "Differential Driver Actuator: Linear and angular speed (Vx, W) actuator"
    _short_desc = "Motion controller using linear and angular speeds, by the wheels"

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        if not isinstance(parent, PhysicsDifferentialRobot):
            raise TypeError(
                f"{parent.name()} ({type(parent).__name__}) has no wheels to drive: "
                "use MotionVW, or a wheeled robot such as Pioneer3DX or SegwayRMP400"
            )

    def default_action(self) -> None:
        """Turn the wheels."""
        (v,), w = self.speeds()
        self.robot_parent.apply_vw_wheels(v, w)
