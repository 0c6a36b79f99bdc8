"""Drives a robot by the speeds of its wheels."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.actuators.speed_command import SpeedCommand
from morse.core.wheeled_robot import PhysicsDifferentialRobot, drives_wheels
from morse.helpers.components import add_property, while_same
from morse.helpers.joint_motors import JointMotors, joint_names
from morse.scene import Control

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body


class MotionVWDiff(SpeedCommand):
    """Turns the wheels of a robot so that it drives and turns at the commanded speeds.

    The robot is one of MORSE with wheels, or has joints as wheels, which the properties ``LeftWheels`` and
    ``RightWheels`` name. Wheels that are joints turn at (v - w s / 2) / r on the left and (v + w s / 2) / r on the
    right, with the separation s and the radius r.
    """

    _name = "Differential Driver Actuator: Linear and angular speed (Vx, W) actuator"
    _short_desc = "Motion controller using linear and angular speeds, by the wheels"

    add_property("_left", "", "LeftWheels", "string", "Joints of the wheels on the left, separated by commas")
    add_property("_right", "", "RightWheels", "string", "Joints of the wheels on the right")
    add_property(
        "_radius", 0.1, "WheelRadius", "float", "Radius of wheels that are joints", unit="m", low=1e-3, high=100.0
    )
    add_property(
        "_separation",
        0.5,
        "WheelSeparation",
        "float",
        "Distance between left and right wheels that are joints",
        unit="m",
        low=1e-3,
        high=100.0,
    )

    turns_wheels = True

    _left: str
    _right: str
    _radius: float
    _separation: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._wheels: JointMotors | None = None
        left, right = joint_names(self._left), joint_names(self._right)
        self._sides = (-1.0,) * len(left) + (1.0,) * len(right)
        if left and right:
            self._wheels = JointMotors(self.robot_parent.bge_object, left + right, Control.VELOCITY)
        elif not isinstance(parent, PhysicsDifferentialRobot):
            raise TypeError(
                f"{self.robot_parent.name()} ({type(parent).__name__}) has no wheels to drive: "
                "use MotionVW, or a wheeled robot such as Pioneer3DX or SegwayRMP400, or name the joints of its "
                "wheels: properties(LeftWheels='left_wheel', RightWheels='right_wheel')"
            )

    def may_wait(self) -> bool:
        """Whether the wheels are no joints, and turn at the same speeds until the next command, without limits."""
        return self._wheels is None and drives_wheels(self.robot_parent) and not self.is_limited()

    @while_same("v", "w")
    def default_action(self) -> None:
        """Turn the wheels."""
        (v,), w = self.speeds()
        if self._wheels is None:
            robot = self.robot_parent
            assert isinstance(robot, PhysicsDifferentialRobot)
            robot.apply_vw_wheels(v, w)
            return
        half, radius = 0.5 * self._separation, self._radius
        self._wheels.tell([(v + side * w * half) / radius for side in self._sides])
