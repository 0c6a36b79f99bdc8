"""Offers services and actions over rospy."""

from __future__ import annotations

import logging
import threading
from collections import deque
from typing import TYPE_CHECKING, Any

from morse.core.calls import AnsweredRequests
from morse.core.clients.budgets import TimeShare
from morse.core.clients.complaints import Complaints
from morse.core.status import FAILED, SUCCESS
from morse.plugins.ros.actions import ActionServer, TrajectoryActionServer
from morse.plugins.ros.node import join, message, message_class
from morse.rosmsgs.actions import Feedback
from morse.rosmsgs.names import cleaned
from morse.rosmsgs.services import SET_BOOL, TRIGGER, Call, ros_action, ros_service
from morse.rosmsgs.trajectories import TRAJECTORY_ACTION, TRAJECTORY_SERVICE

if TYPE_CHECKING:
    import uuid
    from collections.abc import Callable, Set
    from types import ModuleType

    from morse.core.context import Context
    from morse.core.request_manager import Outcome
    from morse.rosmsgs.topics.backend import RosClass, RosObject

# scripts of 1.4 import the decorators from here
__all__ = ["RosRequestManager", "ros_action", "ros_service"]

#: maximum number of calls that are begun in one tick
_EACH_TICK = 64
#: interval in which a waiting thread checks whether the simulation has ended, s
_LOOK = 0.5
_INSTALL = "sudo apt install ros-noetic-control-msgs"


class _Waiting:
    """A call on which a thread of rospy waits."""

    def __init__(self, begin: Callable[[Callable[[Outcome], object]], object]) -> None:
        self.begin = begin
        self.done = threading.Event()
        self.outcome: Outcome = (FAILED, "the simulation has ended")

    def end(self, outcome: Outcome) -> None:
        self.outcome = outcome
        self.done.set()


class RosRequestManager(AnsweredRequests):
    """Services and actions of ROS 1.

    Methods with `ros_service` and `ros_action` have the declared types. All other services without arguments are
    ``std_srvs/Trigger``, those with one boolean ``std_srvs/SetBool``.
    """

    classpath = "morse.middleware.ros_request_manager.RosRequestManager"
    title = "ROS service manager"

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        self._context = context
        self._rospy: ModuleType
        self._servers: dict[tuple[str, str], Any] = {}
        self._actions: dict[tuple[str, str], ActionServer] = {}
        self._queue: deque[_Waiting] = deque()
        self._share = TimeShare(context.time_shares)
        self._is_closed = False
        self._complaints = Complaints(logging.getLogger(__name__))

    def initialization(self) -> bool:
        """Become a node.

        Raises:
            MorseMiddlewareError: rospy cannot be imported, or there is no master.
        """
        self._rospy = join(self._context.scene.settings.node_name)
        return True

    def finalization(self) -> bool:
        """Remove all services and actions."""
        self._is_closed = True
        for server in self._servers.values():
            server.shutdown("the simulation has ended")
        for action in self._actions.values():
            action.close()
        self._servers.clear()
        self._actions.clear()
        return True

    # -- services ----------------------------------------------------------------------------

    def _register(self, component: str, callback: Callable[..., object], name: str, *, is_async: bool) -> None:
        super()._register(component, callback, name, is_async=is_async)
        key, path = (component, name), f"/{cleaned(component)}/{cleaned(name)}"
        self._withdraw(key)
        action = getattr(callback, "_ros_action_type", None)
        if name == TRAJECTORY_SERVICE and hasattr(getattr(callback, "__self__", None), "plan"):
            self._offer_trajectories(component, callback)
        if action is not None:
            feedback = _feedback_of(callback, action)
            self._actions[key] = ActionServer(self._rospy, path, action, self._begin(component, name), self, feedback)
            return
        service_type = getattr(callback, "_ros_service_type", None)
        call = Call(callback)
        kind = service_type or (message_class(call.type) if call.type in (TRIGGER, SET_BOOL) else None)
        if kind is None:
            return
        answer = _declared(kind) if service_type is not None else _standard(kind, call)
        arguments = (
            _fields if service_type is not None else lambda request: [request.data] if call.type == SET_BOOL else []
        )

        def serve(request: RosObject) -> object:
            begin = self._begin(component, name)
            waiting = _Waiting(lambda on_end: begin(arguments(request), on_end))
            self._queue.append(waiting)
            self._context.wake()
            while not waiting.done.wait(_LOOK) and not self._is_closed:
                pass
            return answer(*waiting.outcome)

        self._servers[key] = self._rospy.Service(path, kind, serve)

    def _offer_trajectories(self, component: str, callback: Callable[..., object]) -> None:
        """Offer the action of an armature that follows trajectories."""
        key, action = (component, TRAJECTORY_ACTION), message_class("control_msgs/FollowJointTrajectoryAction")
        self._withdraw(key)
        if action is None:
            text = f"ros: there is no action {TRAJECTORY_ACTION}, because control_msgs is not installed: {_INSTALL}"
            self._complaints.log(logging.INFO, TRAJECTORY_ACTION, text)
            return
        begin = self._begin(component, TRAJECTORY_SERVICE)
        server = TrajectoryActionServer(
            self._rospy,
            f"/{cleaned(component)}/{TRAJECTORY_ACTION}",
            action,
            begin,
            self,
            _feedback_of(callback, action),
        )
        server.armature = callback.__self__  # type: ignore[attr-defined]
        self._actions[key] = server

    def _withdraw(self, key: tuple[str, str]) -> None:
        if key in self._servers:
            self._servers.pop(key).shutdown("replaced")
        if key in self._actions:
            self._actions.pop(key).close()

    def withdrawn(self, component_name: str, services: Set[str]) -> None:
        """See `RequestManager.withdrawn`."""
        for name in [*services, *([TRAJECTORY_ACTION] if TRAJECTORY_SERVICE in services else [])]:
            self._withdraw((component_name, name))

    # -- the tick ----------------------------------------------------------------------------

    def main(self) -> None:
        """See `RequestManager.main`."""
        if self._queue and self._share.begin():
            for _ in range(min(len(self._queue), _EACH_TICK)):
                waiting = self._queue.popleft()
                waiting.begin(waiting.end)
                if self._share.end_request():
                    break
        for action in list(self._actions.values()):
            action.act(self._context.clock)

    def _begin(self, component: str, service: str) -> Callable[..., uuid.UUID | None]:
        def begin(arguments: list[object], on_end: Callable[[Outcome], object]) -> uuid.UUID | None:
            return self.call(component, service, arguments, on_end)

        return begin


def _feedback_of(callback: Callable[..., object], action: RosClass) -> Feedback:
    kind = type(action().action_feedback.feedback)
    kinds = dict(zip(kind.__slots__, kind._slot_types, strict=True))
    return Feedback(callback, kind, kinds, lambda fields: message(kind._type, fields))


def _fields(request: RosObject) -> list[object]:
    return [getattr(request, name) for name in request.__slots__]


def _declared(kind: RosClass) -> Callable[[str, object], object]:
    """The response of a service with a declared type; an exception makes rospy report a failure to the caller."""
    response = kind._response_class

    def answer(state: str, result: object) -> Any:
        if state != SUCCESS:
            raise RuntimeError(f"{state}: {result}" if result else state)
        if result is None:
            return response()
        return result if isinstance(result, (response, tuple, list, dict)) else [result]

    return answer


def _standard(kind: RosClass, call: Call) -> Callable[[str, Any], object]:
    return lambda state, result: kind._response_class(**call.answer(state, result))
