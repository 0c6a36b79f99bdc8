"""The action ``control_msgs/FollowJointTrajectory`` of armatures, as of a joint trajectory controller of ros2_control.

Goals that do not fit the joints are rejected. A new goal preempts the active one. Joints that a goal does not name keep
their setpoints.
"""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.core.exceptions import MorseRPCInvokationError
from morse.core.status import SUCCESS
from morse.middleware.ros2.actions import ActionServer
from morse.rosmsgs.trajectories import goal_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.request_manager import Outcome
    from morse.core.values import RosMessage
    from morse.rosmsgs.objects import RosClass, RosObject

logger = logging.getLogger(__name__)

#: name of the action below the name of the armature, and of the service of the armature that serves it
NAME, SERVICE = "follow_joint_trajectory", "trajectory"
INSTALL = "sudo apt install ros-$ROS_DISTRO-control-msgs"


def action_type() -> RosClass | None:
    """The class of the action; None if its package is not installed."""
    try:
        from control_msgs.action import FollowJointTrajectory
    except ImportError:
        return None
    action: RosClass = FollowJointTrajectory
    return action


class TrajectoryGoals:
    """The goals and results of the action of one armature, for action servers of ROS 1 and ROS 2.

    Attributes:
        armature: a component with the methods ``plan`` and ``trajectory``.
        plain: a message as a dictionary with the names of ROS 2.
        result_class: class of the results.
    """

    armature: Any
    plain: Callable[[RosObject], RosMessage]
    result_class: type[Any]

    def arguments(self, goal: RosObject) -> list[Any]:
        """See `ActionServer.arguments`.

        Raises:
            ValueError: the goal does not fit itself.
        """
        return [goal_of(self.plain(goal))]

    def accepts(self, goal: RosObject) -> bool:
        """See `ActionServer.accepts`."""
        try:
            self.armature.plan(*self.arguments(goal))
        except (ValueError, MorseRPCInvokationError) as error:
            logger.warning("a trajectory for %s was rejected: %s", self.armature.name(), error)
            return False
        return True

    def result(self, outcome: Outcome, *, is_canceled: bool) -> RosObject:
        """See `ActionServer.result`."""
        state, text = outcome
        result: RosObject = self.result_class()
        if state == SUCCESS or is_canceled:
            return result
        code, _, _ = str(text).partition(":")
        result.error_code = getattr(result, code, result.INVALID_GOAL)
        result.error_string = str(text or "another command has taken over the joints")
        return result


class TrajectoryActionServer(TrajectoryGoals, ActionServer):
    """Serves the action of one armature."""
