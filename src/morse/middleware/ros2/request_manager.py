"""Offers services as services of ROS 2."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any, NamedTuple

from morse.core.calls import AnsweredRequests
from morse.core.clients.budgets import TimeShare
from morse.core.exceptions import MorseError
from morse.core.status import FAILED, SUCCESS
from morse.middleware.ros2 import INSTALL_ROS, simulation_steps
from morse.middleware.ros2.actions import INSTALL, ActionServer, TrajectoryActionServer, trajectory_action
from morse.middleware.ros2.domain import join, options_of
from morse.middleware.ros2.parameters import Parameters
from morse.middleware.ros2.simulation_interfaces import SimulationInterfaces
from morse.rosmsgs.actions import Feedback
from morse.rosmsgs.cdr import CdrError
from morse.rosmsgs.names import Names, cleaned
from morse.rosmsgs.services import Call
from morse.rosmsgs.topics.backend import announce
from morse.rosmsgs.trajectories import TRAJECTORY_ACTION, TRAJECTORY_SERVICE

if TYPE_CHECKING:
    import uuid
    from collections.abc import Callable, Set

    from morse.core.context import Context
    from morse.core.request_manager import Outcome
    from morse.core.values import RosMessage
    from morse.middleware.ros2.domain import Served
    from morse.rosmsgs.topics.backend import Backend, ServiceServer

logger = logging.getLogger(__name__)

#: maximum number of calls that a service takes in one tick
_EACH_TICK = 16


class _Offer(NamedTuple):
    server: ServiceServer
    call: Call


class Ros2RequestManager(AnsweredRequests):
    """Services of components as services of ROS 2, below the topics of the component.

    They need a backend with services: rclpy. Types are those of `morse.rosmsgs.services`. The services of the
    simulation are below ``/simulation`` and ``/time``, and available as `simulation_interfaces` as far as possible.
    """

    classpath = "morse.middleware.ros2.request_manager.Ros2RequestManager"
    title = "ROS 2 service manager"

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        self._context = context
        self._offers: dict[tuple[str, str], _Offer] = {}
        self._types: dict[tuple[str, str], Any] = {}
        self._actions: dict[tuple[str, str], Any] = {}
        self._share = TimeShare(context.time_shares)
        self._turn = self._next_offer = 0
        self._backend: Backend | None = None
        self._servers: list[Served] = []

    def initialization(self) -> bool:
        """Join the domain.

        Raises:
            MorseMiddlewareError: no backend is installed, or it cannot join.
        """
        options = options_of(self._context)
        self._names = Names(options)
        self._backend = join(self._context, options)
        announce(self._backend, "ros2")
        if not self._backend.has_services:
            logger.warning(
                "ros2: %s has topics, but no services, actions and parameters of ROS: services are on the "
                "socket. rclpy has all of them: %s",
                self._backend.name,
                INSTALL_ROS,
            )
        else:
            self._servers.append(Parameters(self._context, self._backend, self._settable, self.call))
        return True

    def finalization(self) -> bool:
        """Remove all services."""
        for offer in self._offers.values():
            offer.server.close()
        self._offers.clear()
        for key in [*self._types, *self._actions]:
            self._withdraw(key)
        for server in self._servers:
            server.close()
        self._servers.clear()
        if self._backend is not None:
            self._backend.release()
            self._backend = None
        return True

    # -- services ----------------------------------------------------------------------------

    def post_registration(self, component_name: str, service: str, is_async: bool) -> bool:
        """See `RequestManager.post_registration`: whether the backend has services."""
        return self._backend is not None and self._backend.has_services

    def _register(self, component: str, callback: Callable[..., object], name: str, *, is_async: bool) -> None:
        super()._register(component, callback, name, is_async=is_async)
        if (component, name) not in self._services or self._backend is None:
            return
        if name == TRAJECTORY_SERVICE and hasattr(getattr(callback, "__self__", None), "plan"):
            self._offer_trajectories(component, callback, self._backend)
        if self._offer_typed(component, callback, name, self._backend):
            return
        offer = self._offers.pop((component, name), None)
        call = Call(callback)
        if offer is not None and offer.call.type == call.type:
            self._offers[component, name] = offer._replace(call=call)
            return
        if offer is not None:
            offer.server.close()
        server = self._backend.service(f"{self._base(component)}/{cleaned(name)}", call.type)
        if server is not None:
            self._offers[component, name] = _Offer(server, call)
        if component == "simulation" and name == "pause" and len(self._servers) == 1:
            self._servers.append(SimulationInterfaces(self._context, self._backend, self.call))
            steps = simulation_steps.action_type()
            if steps is not None:
                self._actions[component, simulation_steps.NAME] = simulation_steps.StepsServer(
                    self._context, self._backend, steps, self.call, self.abort_request
                )

    def _offer_trajectories(self, component: str, callback: Callable[..., object], backend: Backend) -> None:
        """Offer the action of an armature that follows trajectories."""
        key, kind = (component, TRAJECTORY_ACTION), trajectory_action()
        self._withdraw(key)
        if kind is None:
            text = f"ros2: there is no action {TRAJECTORY_ACTION}, because control_msgs is not installed: {INSTALL}"
            self._complaints.log(logging.INFO, TRAJECTORY_ACTION, text)
            return

        def begin(arguments: list[object], on_end: Callable[[Outcome], object]) -> uuid.UUID | None:
            return self.call(component, TRAJECTORY_SERVICE, arguments, on_end)

        server = TrajectoryActionServer(
            backend, f"{self._base(component)}/{TRAJECTORY_ACTION}", kind, begin, self.abort_request,
            _feedback_of(callback, kind, backend),
        )  # fmt: skip
        server.armature = callback.__self__  # type: ignore[attr-defined]
        self._actions[key] = server

    def _offer_typed(self, component: str, callback: Callable[..., object], name: str, backend: Backend) -> bool:
        """Offer a service or an action with its own type; False if it has none."""
        key, path = (component, name), f"{self._base(component)}/{cleaned(name)}"
        action, kind = getattr(callback, "_ros_action_type", None), getattr(callback, "_ros_service_type", None)
        if action is None and kind is None:
            return False
        self._withdraw(key)

        def begin(arguments: list[object], on_end: Callable[[Outcome], object]) -> uuid.UUID | None:
            return self.call(component, name, arguments, on_end)

        if action is not None:
            feedback = _feedback_of(callback, action, backend)
            self._actions[key] = ActionServer(backend, path, action, begin, self.abort_request, feedback)
        else:
            server = backend.typed_service(path, kind)
            if server is not None:
                self._types[key] = server
        return True

    def _withdraw(self, key: tuple[str, str]) -> None:
        for table in (self._actions, self._types):
            server = table.pop(key, None)
            if server is not None:
                server.close()

    def _base(self, component: str) -> str:
        part = self._context.component(component)
        if part is None:
            return f"/{cleaned(component)}"
        if part.robot_parent is None:
            return self._names.namespace(part)
        return self._names.topic(part, {"namespace": None, "topic": None})

    def withdrawn(self, component_name: str, services: Set[str]) -> None:
        """See `RequestManager.withdrawn`."""
        for name in [*services, *([TRAJECTORY_ACTION] if TRAJECTORY_SERVICE in services else [])]:
            key = component_name, name
            if key in self._offers:
                self._offers.pop(key).server.close()
            self._withdraw(key)

    # -- the tick ----------------------------------------------------------------------------

    def main(self) -> None:
        """Serve the received requests within the time share of a tick; actions always continue."""
        if self._share.begin():
            kinds = (self._serve_offers, self._serve_typed, self._serve_node)
            for number in range(self._turn, self._turn + len(kinds)):
                if kinds[number % len(kinds)]():
                    # a flood of one kind must not hold up the other kinds
                    self._turn = (number + 1) % len(kinds)
                    break
        for action in list(self._actions.values()):
            action.act(self._context.clock)

    def _serve_offers(self) -> bool:
        """Serve services of components; return whether the share of this tick is used."""
        offers = list(self._offers.items())
        first = self._next_offer % len(offers) if offers else 0
        for number, ((component, service), offer) in enumerate(offers[first:] + offers[:first], first + 1):
            for _ in range(_EACH_TICK):
                requests = offer.server.take(1)
                if not requests:
                    break
                self._handle(component, service, offer, *requests[0])
                if self._share.end_request():
                    self._next_offer = number
                    return True
        return False

    def _serve_typed(self) -> bool:
        for (component, service), server in list(self._types.items()):
            for _ in range(_EACH_TICK):
                requests = server.take_messages(1)
                if not requests:
                    break
                caller, request = requests[0]
                arguments = [getattr(request, name) for name in request.get_fields_and_field_types()]
                self.call(component, service, arguments, _typed_answer(server, caller))
                if self._share.end_request():
                    return True
        return False

    def _serve_node(self) -> bool:
        return any(server.serve(self._share.end_request) for server in self._servers)

    def _settable(self) -> list[str]:
        """The components whose properties may be set."""
        return [component for component, name in self._services if name == "set_property"]

    def _handle(self, component: str, service: str, offer: _Offer, caller: object, request: RosMessage) -> None:
        def answer(outcome: Outcome) -> None:
            state, result = outcome
            try:
                offer.server.answer(caller, offer.call.answer(state, result))
            except (ValueError, TypeError, RecursionError) as error:
                text = f"the result has no JSON representation: {error}"
                offer.server.answer(caller, offer.call.answer(FAILED, text))

        try:
            arguments = offer.call.arguments(request)
        except (MorseError, CdrError, KeyError) as error:
            answer((FAILED, str(error)))
            return
        self.call(component, service, arguments, answer)


def _feedback_of(callback: Callable[..., object], action: Any, backend: Backend) -> Feedback:
    kinds = action.Feedback.get_fields_and_field_types()
    return Feedback(callback, action.Feedback, kinds, lambda fields: backend.filled(action.Feedback(), fields))


def _typed_answer(server: Any, caller: Any) -> Callable[[Outcome], object]:
    """The response of a service with its own type: the returned value, or nothing if it has failed."""

    def ended(outcome: Outcome) -> None:
        state, result = outcome
        response = server.new_response()
        fields = list(response.get_fields_and_field_types())
        if isinstance(result, type(response)):
            response = result
        elif state == SUCCESS and result is not None:
            values = result if isinstance(result, (tuple, list)) and len(fields) > 1 else [result]
            try:
                for name, value in zip(fields, values, strict=False):
                    setattr(response, name, value)
            except (AssertionError, ValueError, TypeError) as error:
                logger.error("ros2: a service returned a value that does not fit its response: %s", error)
        elif state != SUCCESS:
            logger.warning("ros2: a service has failed (%s): %s", state, result)
        server.answer_message(caller, response)

    return ended
