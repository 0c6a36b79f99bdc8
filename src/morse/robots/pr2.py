"""The PR2 of Willow Garage."""

from __future__ import annotations

from typing import Annotated, Any

from morse.core.exceptions import MorseRPCInvokationError
from morse.core.services import service
from morse.core.validation.arguments import Range
from morse.robots.grasping import GraspingRobot

_LIFT = "torso_lift_joint"
_CASTERS = [
    f"{corner}_caster_{part}_joint"
    for corner in ("fl", "fr", "bl", "br")
    for part in ("rotation", "l_wheel", "r_wheel")
]
_ARM = (
    *("shoulder_pan", "shoulder_lift", "upper_arm_roll", "elbow_flex", "forearm_roll", "wrist_flex", "wrist_roll"),
    *("gripper", "gripper_l_finger", "gripper_r_finger", "gripper_r_finger_tip", "gripper_l_finger_tip"),
    *("gripper_motor_screw", "gripper_motor_slider"),
)
#: the joints of a real one, in the order of MORSE 1.4
_JOINTS = (
    *_CASTERS,
    *("torso_lift_joint", "torso_lift_motor_screw_joint"),
    *("head_pan_joint", "head_tilt_joint", "laser_tilt_mount_joint"),
    *(f"{side}_{part}_joint" for side in ("r", "l") for part in _ARM),
)


class PR2(GraspingRobot):
    """A robot with a torso that rises, a head, and two arms; they are components of the robot (`Armature`).

    Attributes:
        all_joints: names of the joints of a real PR2, for messages that have all of them; not all are simulated.
    """

    all_joints = _JOINTS

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
