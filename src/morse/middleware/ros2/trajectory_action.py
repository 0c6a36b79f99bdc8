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
from morse.rosmsgs.trajectories import seconds, trajectory_of

if TYPE_CHECKING:
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


class TrajectoryActionServer(ActionServer):
    """Serves the action of one armature.

    Attributes:
        armature: a component with the methods ``plan`` and ``trajectory``.
    """

    armature: Any

    def arguments(self, goal: RosObject) -> list[Any]:
        """See `ActionServer.arguments`.

        Raises:
            ValueError, MorseRPCInvokationError: the goal does not fit the joints.
        """
        message = self._plain(goal)
        trajectory = trajectory_of(message["trajectory"])
        for key in ("path_tolerance", "goal_tolerance"):
            tolerances = {str(one["name"]): _given(one) for one in message[key]}
            if tolerances:
                trajectory[key] = tolerances
        late = seconds(message["goal_time_tolerance"])
        if late > 0.0:
            trajectory["goal_time_tolerance"] = late
        return [trajectory]

    def accepts(self, goal: RosObject) -> bool:
        """See `ActionServer.accepts`."""
        try:
            self.armature.plan(*self.arguments(goal))
        except (ValueError, MorseRPCInvokationError) as error:
            logger.warning("ros2: a trajectory was rejected: %s", error)
            return False
        return True

    def result(self, outcome: Outcome, *, is_canceled: bool) -> RosObject:
        """See `ActionServer.result`."""
        state, text = outcome
        result: RosObject = self.kind.Result()
        if state == SUCCESS or is_canceled:
            return result
        code, _, _ = str(text).partition(":")
        result.error_code = getattr(result, code, result.INVALID_GOAL)
        result.error_string = str(text or "another command has taken over the joints")
        return result


def _given(tolerance: RosMessage) -> dict[str, float]:
    """The tolerances of a joint: 0 means none is set, a negative number removes it."""
    return {name: tolerance[name] for name in ("position", "velocity") if tolerance[name] > 0.0}
