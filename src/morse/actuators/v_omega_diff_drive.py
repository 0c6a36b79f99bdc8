"""Drives a robot by the speeds of its wheels."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.actuators.speed_command import SpeedCommand
from morse.core.wheeled_robot import PhysicsDifferentialRobot, drives_wheels
from morse.helpers.components import add_property, while_same
from morse.helpers.joint_motors import WHEEL_LENGTH, JointMotors, differential_drive, joint_list, joint_names
from morse.scene.joint_wheels import joint_wheels

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body


class MotionVWDiff(SpeedCommand):
    """Turns the wheels of a robot so that it drives and turns at the commanded speeds.

    The robot is one of MORSE with wheels, or has joints as wheels. These are found: joints that turn without limits
    about a lateral axis and carry a round shape next to the ground, in pairs. Casters and steered wheels are left out.
    ``left`` and ``right`` name other joints, as in ``MotionVWDiff(left="left_wheel", right="right_wheel")``.

    Wheels that are joints turn at (v - w s / 2) / r on the left and (v + w s / 2) / r on the right, with the separation
    s and the radius r, which are those of the shapes unless ``WheelSeparation`` and ``WheelRadius`` are set. Wheels in
    front of others slide sideways in a turn; s is then the distance at which the forces of friction are in balance:
    T + 4 b^2 / T with the track T, wheels at distances b in front and behind, and the centre of mass in the middle.
    """

    _name = "Differential Driver Actuator: Linear and angular speed (Vx, W) actuator"
    _short_desc = "Motion controller using linear and angular speeds, by the wheels"

    add_property("_left", "", "LeftWheels", "string", "Joints of the wheels on the left, separated by commas")
    add_property("_right", "", "RightWheels", "string", "Joints of the wheels on the right")
    add_property(
        "_radius", 0.0, "WheelRadius", "float", "Radius of wheels that are joints; 0: of their shapes", **WHEEL_LENGTH
    )
    add_property(
        "_separation",
        0.0,
        "WheelSeparation",
        "float",
        "Distance between left and right wheels that are joints; 0: computed from the middles of their shapes",
        **WHEEL_LENGTH,
    )

    turns_wheels = True

    _left: str
    _right: str
    _radius: float
    _separation: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._wheels: JointMotors | None = None
        if not self._left and not self._right and isinstance(parent, PhysicsDifferentialRobot):
            return
        body = self.robot_parent.bge_object
        drive = differential_drive(body, joint_names(self._left), joint_names(self._right))
        if drive is None:
            raise TypeError(
                f"{self.robot_parent.name()} ({type(parent).__name__}) has no wheels to drive: use MotionVW, or a "
                "wheeled robot such as Pioneer3DX or SegwayRMP400, or name the joints of its wheels: "
                f"MotionVWDiff(left='left_wheel', right='right_wheel'); {joint_list(body)}"
            )
        self._wheels = JointMotors.of_wheels(body, drive.joints, joint_wheels(body.node))
        self._radii = [self._radius or radius for radius in drive.radii]
        half = 0.5 * (self._separation or drive.separation)
        self._levers = [side * half for side in drive.sides]
        if not half or not all(self._radii):
            raise ValueError(
                f"the wheels {', '.join(drive.joints)} have no shapes whose radius and distance could be measured: "
                "properties(WheelRadius=0.1, WheelSeparation=0.4)"
            )
        self._signs = drive.signs
        for text in drive.hindrances:
            self.context.complaints.warn(f"{self.name()}: {text}", f"{self.name()}: {text}")

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
        columns = zip(self._signs, self._levers, self._radii, strict=True)
        self._wheels.tell([sign * (v + lever * w) / radius for sign, lever, radius in columns])
