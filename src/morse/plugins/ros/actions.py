"""The server of an action: goals, cancellation, status, feedback and result on the topics of actionlib.

Source: wiki.ros.org/actionlib/DetailedDescription. A new goal preempts the active one.
"""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.core.clients.complaints import Complaints, Waiting
from morse.core.status import FAILED, PREEMPTED, SUCCESS
from morse.plugins.ros.node import message, message_class, plain
from morse.rosmsgs.parts import time
from morse.rosmsgs.trajectories import TrajectoryGoals

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType

    from morse.core.clock import Clock
    from morse.core.request_manager import Outcome
    from morse.core.values import Value
    from morse.rosmsgs.actions import Feedback
    from morse.rosmsgs.topics.backend import RosClass, RosObject

#: constants of actionlib_msgs/GoalStatus
_ACTIVE, _PREEMPTED, _SUCCEEDED, _ABORTED, _REJECTED = 1, 2, 3, 4, 5
#: simulated seconds between two status messages, and for which the status of a finished goal is published
_STATUS_PERIOD, _KEPT = 0.2, 5.0
#: maximum number of goals that wait for a tick, and of finished goals whose status is published
_WAITING, _MOST_ENDED = 64, 64


class _Goal:
    def __init__(self, goal_id: RosObject, start: int) -> None:
        self.id, self.status, self.text = goal_id, _ACTIVE, ""
        self.begun = start
        self.is_canceled = False
        self.call: Any = None
        self.ended_at = float("inf")


class ActionServer:
    """Serves one action.

    Args:
        rospy: the module.
        path: name of the action.
        kind: class of the action.
        begin: begins the service with arguments and a callback for the outcome; returns the call if it is asynchronous.
        manager: aborts calls.
        feedback: makes the feedback of a running goal.
    """

    def __init__(
        self,
        rospy: ModuleType,
        path: str,
        kind: RosClass,
        begin: Callable[..., Any],
        manager: Any,
        feedback: Feedback,
    ) -> None:
        self._begin, self._manager = begin, manager
        action = kind()
        self._source = feedback
        self._feedback_class = type(action.action_feedback)
        self._stamped_result = type(action.action_result)
        self.result_class: type[Any] = type(action.action_result.result)
        complaints = Complaints(logging.getLogger(__name__))
        self._inbox: Waiting[tuple[str, Any]] = Waiting(_WAITING, complaints, f"ros: {path}", "goals")
        self._goals: list[_Goal] = []
        self._next = 0.0
        self._now = 0.0
        statuses = message_class("actionlib_msgs/GoalStatusArray")
        goal_id = message_class("actionlib_msgs/GoalID")
        self._status = rospy.Publisher(f"{path}/status", statuses, queue_size=10, latch=True)
        self._feedback = rospy.Publisher(f"{path}/feedback", type(action.action_feedback), queue_size=10)
        self._result = rospy.Publisher(f"{path}/result", self._stamped_result, queue_size=10)
        self._topics = [
            self._status,
            self._feedback,
            self._result,
            rospy.Subscriber(f"{path}/goal", type(action.action_goal), lambda m: self._inbox.append(("goal", m))),
            rospy.Subscriber(f"{path}/cancel", goal_id, lambda m: self._inbox.append(("cancel", m))),
        ]

    def accepts(self, goal: Any) -> bool:
        """Whether a goal may begin."""
        return True

    def arguments(self, goal: Any) -> list[Value]:
        """The arguments of the service for a goal."""
        return [goal]

    def result(self, outcome: Outcome, *, is_canceled: bool) -> Any:
        """The result of a goal whose service has ended; None for an empty one.

        Args:
            is_canceled: whether a client has asked for the end.
        """
        return outcome[1] if isinstance(outcome[1], self.result_class) else None

    def close(self) -> None:
        """Close the topics."""
        for topic in self._topics:
            topic.unregister()

    def act(self, clock: Clock) -> None:
        """Begin and cancel goals as requested, and publish the status."""
        self._now = clock.time
        self._stamp = clock.stamp()
        for _ in range(len(self._inbox)):
            what, content = self._inbox.popleft()
            if what == "goal":
                self._take(content)
            else:
                self._cancel(content)
        if not self._next - 2.0 * _STATUS_PERIOD <= self._now < self._next:
            self._tell()
        goals = [goal for goal in self._goals if goal.status == _ACTIVE]
        if goals and self._source.is_due(self._stamp):
            for goal in goals:
                self._tell_progress(goal)

    def _tell_progress(self, goal: _Goal) -> None:
        feedback = self._source.message(goal.begun, self._stamp)
        if feedback is not None:
            made = self._feedback_class()
            made.header = message("std_msgs/Header", {"stamp": time(self._stamp)})
            made.status.goal_id, made.status.status, made.feedback = goal.id, goal.status, feedback
            try:
                self._feedback.publish(made)
            except Exception as error:  # rospy checks the types of fields only when it sends a message
                self._source.failed(error)

    def _take(self, message: RosObject) -> None:
        present = next((goal for goal in self._goals if goal.id.id == message.goal_id.id), None)
        if present is not None:
            return  # a duplicate, or cancelled before it arrived
        if not self.accepts(message.goal):
            goal = _Goal(message.goal_id, self._stamp)
            self._goals.append(goal)
            self._close_goal(goal, _REJECTED, self.result((FAILED, "it does not fit"), is_canceled=False))
            return
        for running in [goal for goal in self._goals if goal.status == _ACTIVE and goal.call is not None]:
            self._manager.abort_request(running.call)
        self._manager.answer()
        goal = _Goal(message.goal_id, self._stamp)
        self._goals.append(goal)
        self._tell()
        goal.call = self._begin(self.arguments(message.goal), lambda outcome: self._ended(goal, outcome))

    def _cancel(self, message: RosObject) -> None:
        everything = not message.id and not message.stamp.to_sec()
        before = message.stamp.to_sec()
        for goal in list(self._goals):
            if goal.status != _ACTIVE or goal.call is None:
                continue
            if everything or goal.id.id == message.id or (before and goal.id.stamp.to_sec() <= before):
                goal.is_canceled = True
                self._manager.abort_request(goal.call)

    def _ended(self, goal: _Goal, outcome: Outcome) -> None:
        state, value = outcome
        if value is not None and not isinstance(value, self.result_class):
            goal.text = str(value)
        status = _SUCCEEDED if state == SUCCESS else _PREEMPTED if state == PREEMPTED else _ABORTED
        self._close_goal(goal, status, self.result(outcome, is_canceled=goal.is_canceled))

    def _close_goal(self, goal: _Goal, status: int, result: object) -> None:
        goal.status, goal.ended_at = status, self._now
        made = self._stamped_result()
        if result is not None:
            made.result = result
        made.header = message("std_msgs/Header", {"stamp": time(self._stamp)})
        made.status.goal_id, made.status.status, made.status.text = goal.id, goal.status, goal.text
        self._result.publish(made)
        self._tell()

    def _tell(self) -> None:
        self._next = self._now + _STATUS_PERIOD
        old = [goal for goal in self._goals if goal.status != _ACTIVE and self._now - goal.ended_at < _KEPT]
        self._goals = [*old[-_MOST_ENDED:], *(goal for goal in self._goals if goal.status == _ACTIVE)]
        status_array = message("actionlib_msgs/GoalStatusArray", {"header": {"stamp": time(self._stamp)}})
        for goal in self._goals:
            one = message("actionlib_msgs/GoalStatus", {})
            one.goal_id, one.status, one.text = goal.id, goal.status, goal.text
            status_array.status_list.append(one)
        self._status.publish(status_array)


class TrajectoryActionServer(TrajectoryGoals, ActionServer):
    """Serves the action ``control_msgs/FollowJointTrajectory`` of one armature, as a controller of ros_control does."""

    plain = staticmethod(plain)
