"""Persons."""

from __future__ import annotations

from morse.builder.components.armatures import Armature
from morse.builder.components.robot import GroundRobot
from morse.builder.creator import SensorCreator
from morse.middleware import registry

#: bones with a target for inverse kinematics
_TARGETS = ("head", "wrist_L", "wrist_R", "foot_L", "foot_R")


class _Skeleton(Armature):
    _classpath = "morse.actuators.walking_skeleton.WalkingSkeleton"


class _JointStates(SensorCreator):
    _classpath = "morse.sensors.armature_pose.ArmaturePose"


class Human(GroundRobot):
    """A person; the component class is `morse.robots.human.Human`.

    Args:
        filename: name of the model in ``robots``.
        name: its name, if it differs from the name of the variable that refers to it.

    Attributes:
        skeleton: the `Armature` of the person, with targets for the head, the wrists and the feet.
        joint_states: the `ArmaturePose` of the skeleton.
    """

    _classpath = "morse.robots.human.Human"

    def __init__(self, filename: str = "human_rig", name: str | None = None) -> None:
        super().__init__(filename, name)
        self.skeleton = _Skeleton(armature_name="HumanSkeleton")
        self.append(self.skeleton)
        self.skeleton.create_ik_targets(_TARGETS)
        self.joint_states = _JointStates()
        self.skeleton.append(self.joint_states)
        self.skeleton.name, self.joint_states.name = "skeleton", "joint_states"

    def add_interface(self, interface: str, **kwargs: object) -> None:
        """Connect the skeleton and its joint values to a middleware.

        Args:
            interface: name of a middleware.
            **kwargs: options of the streams.

        Raises:
            MorseMiddlewareError: unknown middleware.
        """
        registry.middleware(interface)
        self.skeleton.add_interface(interface, **kwargs)
        self.joint_states.add_interface(interface, **kwargs)
