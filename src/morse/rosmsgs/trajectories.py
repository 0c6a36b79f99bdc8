"""Trajectories of joints: ``JointTrajectory``, and the action ``control_msgs/FollowJointTrajectory`` of armatures.

Both become the argument of the service ``trajectory``. The action is that of a joint trajectory controller: goals that
do not fit the joints are rejected, a new goal preempts the active one, and joints that a goal does not name keep their
setpoints.
"""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.core.exceptions import MorseRPCInvokationError
from morse.core.status import SUCCESS

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from morse.core.kinds import BoundKind
    from morse.core.request_manager import Outcome
    from morse.core.values import DecodedMessage, RosMessage
    from morse.rosmsgs.topics.backend import RosObject

logger = logging.getLogger(__name__)

#: name of the action below the name of the armature, and of the service of the armature that serves it
TRAJECTORY_ACTION, TRAJECTORY_SERVICE = "follow_joint_trajectory", "trajectory"

_SECOND = 1e9
_QUANTITIES = ("positions", "velocities", "accelerations")


def seconds(time: Mapping[str, int]) -> float:
    """A time or a duration, s."""
    return float(time["sec"] + time["nanosec"] / _SECOND)


def service_call(message: DecodedMessage, bound: BoundKind) -> tuple[str, list[object]] | None:
    """The service that a trajectory calls, and its arguments; None for a single point at once, which is a command.

    Raises:
        ValueError: it has no points, or its joints do not follow trajectories.
    """
    points = message["points"]
    if not len(points):
        raise ValueError("0 points, expected at least one")
    if len(points) == 1 and not seconds(points[0]["time_from_start"]):
        return None
    if not hasattr(bound.component, "trajectory"):
        raise ValueError(f"{len(points)} points for {bound.component.name()}, expected one with time_from_start 0")
    return "trajectory", [trajectory_of(message)]


def trajectory_of(message: DecodedMessage) -> RosMessage:
    """The trajectory of some joints; the other joints keep their setpoints.

    It starts at the stamp of its header, or now if that is 0.

    Raises:
        ValueError: a point has another number of values than of joints.
    """
    joints = [str(name) for name in message["joint_names"]]
    trajectory = {"joints": joints, "points": [_point(point, len(joints)) for point in message["points"]]}
    start = seconds(message["header"]["stamp"])
    return {"starttime": start, **trajectory} if start else trajectory


def goal_of(goal: DecodedMessage) -> RosMessage:
    """The trajectory of a goal of ``control_msgs/FollowJointTrajectory``, with its tolerances.

    Raises:
        ValueError: a point has another number of values than of joints.
    """
    trajectory = trajectory_of(goal["trajectory"])
    for key in ("path_tolerance", "goal_tolerance"):
        tolerances = {str(one["name"]): _tolerance(one) for one in goal[key]}
        if tolerances:
            trajectory[key] = tolerances
    late = seconds(goal["goal_time_tolerance"])
    if late > 0.0:
        trajectory["goal_time_tolerance"] = late
    return trajectory


def _tolerance(tolerance: DecodedMessage) -> dict[str, float]:
    """The tolerances of a joint: 0 means none is set, a negative number removes it."""
    return {name: tolerance[name] for name in ("position", "velocity") if tolerance[name] > 0.0}


def _point(point: DecodedMessage, count: int) -> RosMessage:
    result: DecodedMessage = {"time_from_start": seconds(point["time_from_start"])}
    for quantity in _QUANTITIES:
        values = point[quantity]
        if not len(values) and quantity != "positions":
            continue
        if len(values) != count:
            raise ValueError(f"a point has {len(values)} {quantity} for {count} joint_names")
        result[quantity] = [float(value) for value in values]
    return result


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

    def arguments(self, goal: RosObject) -> list[object]:
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
