"""Drives a robot by the speeds of its wheels."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.actuators.speed_command import SpeedCommand
from morse.core.wheeled_robot import PhysicsDifferentialRobot, drives_wheels
from morse.helpers.components import while_same

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body


class MotionVWDiff(SpeedCommand):
    """Turns the wheels of a robot so that it drives and turns at the commanded speeds."""

    _name = "Differential Driver Actuator: Linear and angular speed (Vx, W) actuator"
    _short_desc = "Motion controller using linear and angular speeds, by the wheels"

    robot_parent: PhysicsDifferentialRobot
    turns_wheels = True

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        if not isinstance(parent, PhysicsDifferentialRobot):
            raise TypeError(
                f"{self.robot_parent.name()} ({type(parent).__name__}) has no wheels to drive: "
                "use MotionVW, or a wheeled robot such as Pioneer3DX or SegwayRMP400"
            )

    @while_same("v", "w")
    def default_action(self) -> None:
        """Turn the wheels."""
        (v,), w = self.speeds()
        self.robot_parent.apply_vw_wheels(v, w)

    def may_wait(self) -> bool:
        """Whether the wheels turn at the same speeds until the next command, and the speeds have no limits."""
        return drives_wheels(self.robot_parent) and not self.is_limited()
