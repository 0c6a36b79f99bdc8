"""The server of an action: goals, cancellation, results, status and feedback as in rcl_action.

Source: design.ros2.org/articles/actions.html. Messages are those of the declared class of the action.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.clients.budgets import ENTRY, Budget
from morse.core.status import PREEMPTED, SUCCESS
from morse.rosmsgs.table import Qos
from morse.rosmsgs.trajectories import TrajectoryGoals

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.clock import Clock
    from morse.rosmsgs.actions import Progress
    from morse.rosmsgs.topics.backend import Backend, RosClass, RosObject

#: constants of action_msgs/GoalStatus
_UNKNOWN, _EXECUTING, _SUCCEEDED, _CANCELED, _ABORTED = 0, 2, 4, 5, 6
#: constants of action_msgs/srv/CancelGoal
_NONE, _REJECTED, _UNKNOWN_GOAL = 0, 1, 2
#: maximum number of goals whose result is kept
_KEPT = 64
_EACH_TICK = 16
_SECOND = 10**9


class _Goal:
    def __init__(self, number: bytes, stamp: int) -> None:
        self.number, self.stamp, self.status = number, stamp, _EXECUTING
        self.call: Any = None
        self.is_canceled = False
        self.result: Any = None
        self.waiting: list[object] = []


class ActionServer:
    """Serves one action.

    Args:
        backend: provides typed services.
        path: absolute name of the action.
        kind: class of the action, such as ``nav2_msgs.action.NavigateToPose``.
        begin: begins the service with arguments and a callback for the outcome; returns the call if it is asynchronous.
        abort: ends a call.
        feedback: makes the feedback of a running goal.
    """

    def __init__(
        self,
        backend: Backend,
        path: str,
        kind: RosClass,
        begin: Callable[..., object],
        abort: Callable[[Any], object],
        feedback: Progress,
    ) -> None:
        from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
        from action_msgs.srv import CancelGoal

        self.kind, self._begin, self._abort, self.plain = kind, begin, abort, backend.plain
        self.result_class: type[Any] = kind.Result
        self._info, self._one, self._array = GoalInfo, GoalStatus, GoalStatusArray
        self._goals: dict[bytes, _Goal] = {}
        self._memory = Budget()
        self._source, self._message = feedback, kind.Impl.FeedbackMessage
        impl = kind.Impl
        self._send = backend.typed_service(f"{path}/_action/send_goal", impl.SendGoalService)
        self._cancel = backend.typed_service(f"{path}/_action/cancel_goal", CancelGoal)
        self._result = backend.typed_service(f"{path}/_action/get_result", impl.GetResultService)
        self._feedback = backend.typed_publisher(f"{path}/_action/feedback", impl.FeedbackMessage, Qos())
        self._status = backend.typed_publisher(f"{path}/_action/status", GoalStatusArray, Qos(1, latched=True))

    def accepts(self, goal: RosObject) -> bool:
        """Whether a goal may begin."""
        return True

    def arguments(self, goal: RosObject) -> list[object]:
        """The arguments of the service for a goal."""
        return [goal]

    def result(self, outcome: tuple[str, object], *, is_canceled: bool) -> RosObject | None:
        """The result of a goal whose service has ended; None for an empty one.

        Args:
            is_canceled: whether a client has asked for the end.
        """
        return outcome[1] if isinstance(outcome[1], self.result_class) else None

    def close(self) -> None:
        """End it."""
        for one in (self._send, self._cancel, self._result, self._feedback, self._status):
            one.close()

    def act(self, clock: Clock) -> None:
        """Begin and cancel goals as requested."""
        stamp = clock.stamp()
        for caller, request in self._send.take_messages(_EACH_TICK):
            self._take(caller, request, stamp)
        for caller, request in self._cancel.take_messages(_EACH_TICK):
            self._give_up(caller, request)
        for caller, request in self._result.take_messages(_EACH_TICK):
            goal = self._goals.get(bytes(request.goal_id.uuid))
            if goal is None:
                self._answer(caller, _UNKNOWN, None)
            elif goal.status == _EXECUTING:
                if self._memory.take(ENTRY):
                    goal.waiting.append(caller)
                else:
                    self._answer(caller, _UNKNOWN, None)
            else:
                self._answer(caller, goal.status, goal.result)
        goals = [goal for goal in self._goals.values() if goal.status == _EXECUTING]
        if goals and self._source.is_due(stamp):
            for goal in goals:
                self._tell_progress(goal, stamp)

    def _tell_progress(self, goal: _Goal, stamp: int) -> None:
        feedback = self._source.message(goal.stamp, stamp)
        if feedback is not None:
            message = self._message()
            message.goal_id.uuid = list(goal.number)
            message.feedback = feedback
            self._feedback.publish(message)

    def _take(self, caller: object, request: RosObject, stamp: int) -> None:
        answer = self.kind.Impl.SendGoalService.Response()
        number = bytes(request.goal_id.uuid)
        answer.accepted = number not in self._goals and self.accepts(request.goal)
        answer.stamp.sec, answer.stamp.nanosec = stamp // _SECOND, stamp % _SECOND
        self._send.answer_message(caller, answer)
        if not answer.accepted:
            return
        goal = self._goals[number] = _Goal(number, stamp)
        goal.call = self._begin(self.arguments(request.goal), lambda outcome: self._ended(goal, outcome))
        finals = [one for one in self._goals.values() if one.status != _EXECUTING]
        for old in finals[: max(0, len(finals) - _KEPT)]:
            del self._goals[old.number]
        self._tell()

    def _give_up(self, caller: object, request: RosObject) -> None:
        number, stamp = bytes(request.goal_info.goal_id.uuid), request.goal_info.stamp
        before = stamp.sec * _SECOND + stamp.nanosec
        going = [goal for goal in self._goals.values() if goal.status == _EXECUTING and goal.call is not None]
        everything = not any(number) and not before
        goals = [g for g in going if everything or g.number == number or (before and g.stamp <= before)]
        answer = self._cancel.new_response()
        answer.goals_canceling = [self._info_of(goal) for goal in goals]
        exists = any(number) and number in self._goals
        answer.return_code = _NONE if goals or not any(number) else _REJECTED if exists else _UNKNOWN_GOAL
        self._cancel.answer_message(caller, answer)
        for goal in goals:
            goal.is_canceled = True
            self._abort(goal.call)

    def _info_of(self, goal: _Goal) -> object:
        info = self._info()
        info.goal_id.uuid = list(goal.number)
        info.stamp.sec, info.stamp.nanosec = goal.stamp // _SECOND, goal.stamp % _SECOND
        return info

    def _ended(self, goal: _Goal, outcome: tuple[str, object]) -> None:
        state, _ = outcome
        goal.status = _SUCCEEDED if state == SUCCESS else _CANCELED if state == PREEMPTED else _ABORTED
        goal.result = self.result(outcome, is_canceled=goal.is_canceled)
        for caller in goal.waiting:
            self._answer(caller, goal.status, goal.result)
        self._memory.give(ENTRY * len(goal.waiting))
        goal.waiting.clear()
        self._tell()

    def _answer(self, caller: object, status: int, result: object) -> None:
        response = self.kind.Impl.GetResultService.Response()
        response.status = status
        if result is not None:
            response.result = result
        self._result.answer_message(caller, response)

    def _tell(self) -> None:
        status_array = self._array()
        for goal in self._goals.values():
            one = self._one()
            one.goal_info, one.status = self._info_of(goal), goal.status
            status_array.status_list.append(one)
        self._status.publish(status_array)


#: installs the class of the action of armatures
INSTALL = "sudo apt install ros-$ROS_DISTRO-control-msgs"


def trajectory_action() -> RosClass | None:
    """The class ``control_msgs/FollowJointTrajectory``; None if its package is not installed."""
    try:
        from control_msgs.action import FollowJointTrajectory
    except ImportError:
        return None
    action: RosClass = FollowJointTrajectory
    return action


class TrajectoryActionServer(TrajectoryGoals, ActionServer):
    """Serves the action of one armature."""
