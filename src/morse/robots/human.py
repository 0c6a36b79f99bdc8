"""A person."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.classes.builder_defaults import RobotDefaults
from morse.helpers.components import add_property
from morse.robots.grasping import GraspingRobot

if TYPE_CHECKING:
    from collections.abc import Sequence


class Human(GraspingRobot):
    """A person who walks and whose skeleton moves.

    Commands move the person without momentum, whatever the ``ControlType`` of the actuator is. The joints are those of
    the component ``skeleton``, an `Armature`; its targets for inverse kinematics are the head, the wrists and the feet.
    """

    _name = "Human"
    _short_desc = "A person who walks, and whose joints and hands can be commanded"
    _builder = RobotDefaults("human_rig")

    hand_bone = "wrist_R"

    add_property("_animations", True, "Animations", "bool", "Swing the legs and the arms while the person walks")

    _animations: bool

    def apply_speed(self, kind: str, linear_speed: Sequence[float], angular_speed: Sequence[float]) -> None:
        """Walk; see `Robot.apply_speed`. The control type is always ``Position``."""
        super().apply_speed("Position", linear_speed, angular_speed)
