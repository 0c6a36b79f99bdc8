"""A person."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.classes.builder_defaults import RobotDefaults
from morse.helpers.components import add_property, add_state
from morse.robots.grasping import GraspingRobot

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.robot import Robot
    from morse.core.world import Body


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

    add_state("_guided_at", int, "Tick in which a crowd has moved the person")

    _animations: bool

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._guided_at = -2

    def apply_speed(self, kind: str, linear_speed: Sequence[float], angular_speed: Sequence[float]) -> None:
        """Walk; see `Robot.apply_speed`. The control type is always ``Position``."""
        if not 0 <= self.clock.tick - self._guided_at <= 1:
            super().apply_speed("Position", linear_speed, angular_speed)

    def guide(self, linear_speed: Sequence[float], angular_speed: Sequence[float]) -> None:
        """Walk for a tick as another component decides, such as a crowd, instead of the own actuators.

        Commands of the own actuators have no effect in this tick and in the next one, so that the order in which
        components act does not matter.

        Args:
            linear_speed: m/s along the axes of the person.
            angular_speed: rad/s about the axes of the person.
        """
        self._guided_at = self.clock.tick
        super().apply_speed("Position", linear_speed, angular_speed)
