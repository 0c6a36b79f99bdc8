"""The PR2 of Willow Garage."""

from __future__ import annotations

from typing import Annotated, Any

from morse.core.exceptions import MorseRPCInvokationError
from morse.core.services import service
from morse.core.validation.arguments import Range
from morse.robots.grasping import GraspingRobot

_LIFT = "torso_lift_joint"


class PR2(GraspingRobot):
    """A robot with a torso that rises, a head, and two arms; they are components of the robot (`Armature`)."""

    hand_bone = "r_wrist_roll_joint"

    @service(changes=False)
    def get_armatures(self) -> list[str]:
        """Return the full names of the armatures."""
        return [part.name for part in self.bge_object.childrenRecursive if part.node.bones]

    @service
    def set_torso(self, height: Annotated[float, Range(-1.0, 1.0, "m")]) -> None:
        """Set the height of the torso immediately, within its limits.

        Args:
            height: above its lowest position, m.
        """
        self._torso().set_translation(_LIFT, height)

    @service(changes=False)
    def get_torso(self) -> float:
        """Return the height of the torso above its lowest position, m."""
        torso = self._torso()
        return float(torso.joint_values[torso.joints.index(_LIFT)])

    @service(changes=False)
    def get_torso_minmax(self) -> list[float]:
        """Return the lowest and the highest position of the torso, m."""
        torso = self._torso()
        _, low, high = torso.chain.limits[torso.joints.index(_LIFT)]
        return [low, high]

    def _torso(self) -> Any:
        component: Any
        for component in self.context.components.values():
            moves = component.robot_parent is self and hasattr(component, "set_translation")
            if moves and _LIFT in component.joints:
                return component
        raise MorseRPCInvokationError(
            f"{self.name()} has no component that moves the torso: Armature(armature_name='torso_armature')"
        )
