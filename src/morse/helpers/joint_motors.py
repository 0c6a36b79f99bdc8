"""The motors of joints of a robot, for actuators that turn some of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Self

from morse.core.reports.hints import nearest
from morse.scene import Control
from morse.scene.joint_wheels import rolling_wheels

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.values import Fields
    from morse.core.world import Body, Joints
    from morse.scene.joint_wheels import JointWheel

#: unit and range of the properties of drives that are lengths of wheels, or between wheels
WHEEL_LENGTH: Fields = {"unit": "m", "low": 0.0, "high": 100.0}


def joint_names(text: str) -> tuple[str, ...]:
    """The names in a property: ``front_left, rear_left``."""
    return tuple(name.strip() for name in text.split(",") if name.strip())


class JointMotors:
    """Motors of joints of a robot, all in one control mode, or in their own ones.

    Args:
        robot: the body of the robot.
        names: of joints of one armature.
        control: what the motors control; None to keep that.

    Raises:
        ValueError: the robot has no such joint, or none that the physics moves.
    """

    def __init__(self, robot: Body, names: Sequence[str], control: Control | None) -> None:
        self.names = tuple(names)
        armatures = [robot, *robot.childrenRecursive]
        bones = [bone.name for body in armatures for bone in body.node.bones]
        for name in self.names:
            if name not in bones:
                raise ValueError(f"the robot has no joint '{name}'{nearest(name, bones)}")
        holder = next(body for body in armatures if any(bone.name == self.names[0] for bone in body.node.bones))
        joints = holder.joints()
        if joints is None:
            raise ValueError(f"the joint '{self.names[0]}' has no motor: its armature is not dynamic")
        self._joints: Joints = joints
        for name in self.names if control is not None else ():
            joints.set_control(name, control, 0.0)

    @classmethod
    def of_wheels(cls, robot: Body, names: Sequence[str], wheels: Sequence[JointWheel]) -> Self:
        """The motors of driven wheels; other wheels on the ground roll freely.

        Args:
            wheels: all joints of the robot that turn.
        """
        if rolling := rolling_wheels(wheels, names):
            cls(robot, rolling, Control.EFFORT)
        return cls(robot, names, Control.VELOCITY)

    def tell(self, values: Sequence[float]) -> None:
        """Set the commands, rad or rad/s."""
        self._joints.tell(self.names, values)

    def positions(self) -> list[float]:
        """The measured positions, rad."""
        return self._joints.positions(self.names)
