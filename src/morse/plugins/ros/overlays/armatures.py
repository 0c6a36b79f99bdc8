"""The action of a controller of joint trajectories, for armatures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.overlay import MorseOverlay
from morse.core.services import interruptible
from morse.plugins.ros.node import join, plain
from morse.plugins.ros.overlays import action_type
from morse.rosmsgs.names import cleaned
from morse.rosmsgs.services import ros_action
from morse.rosmsgs.trajectories import trajectory_of

if TYPE_CHECKING:
    from morse.rosmsgs.topics.backend import RosObject


JointTrajectoryAction = action_type("JointTrajectoryAction", "control_msgs", "pr2_controllers_msgs")


class ArmatureController(MorseOverlay):
    """Offers ``trajectory`` of an `Armature` as the action ``joint_trajectory_action``.

    The parameter ``<name>/joints`` of the parameter server lists the joints.

    Args:
        overlaid_object: the armature.
        namespace: prefix of the name of the parameter; None for none.
    """

    def __init__(self, overlaid_object: Any, namespace: str | None = None) -> None:
        super().__init__(overlaid_object)
        self.namespace = namespace
        name = cleaned(self.name())
        rospy = join(overlaid_object.context.scene.settings.node_name)
        rospy.set_param(f"{namespace}/{name}/joints" if namespace else f"{name}/joints", self._joints())

    def _joints(self) -> list[str]:
        armature: Any = self.overlaid_object
        return list(armature.joints)

    @interruptible
    @ros_action(type=JointTrajectoryAction)  # type: ignore[untyped-decorator]
    def joint_trajectory_action(self, goal: RosObject) -> None:
        """Move some or all joints along a trajectory; they may be in any order."""
        armature: Any = self.overlaid_object
        armature.trajectory(self.chain_callback(_without_result), trajectory_of(plain(goal.trajectory)))


def _without_result(outcome: tuple[str, object]) -> tuple[str, None]:
    # the result of the action has no fields
    return outcome[0], None
