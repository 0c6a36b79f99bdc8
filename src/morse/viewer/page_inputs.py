"""Requests of the driving page: commands, service calls, saved states."""

from __future__ import annotations

import bisect
import logging
import math
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from morse.core import status
from morse.core.actuator import Actuator, PendingCommands
from morse.core.declarations import properties
from morse.core.exceptions import MorseError
from morse.core.reports.faults import describe
from morse.core.request_manager import Outcome, RequestManager
from morse.viewer.feeds.components import cameras_of
from morse.viewer.view_messages import Answer, History, PropertyValue, Refused

if TYPE_CHECKING:
    import uuid
    from collections.abc import Callable

    from morse.core.context import Context
    from morse.core.interfaces import Offering
    from morse.core.values import JsonObject
    from morse.viewer import page_messages as page
    from morse.viewer.page import PageLeft
    from morse.viewer.server import ViewServer


# Data of actuators that the page sets: processed like the streams of clients.


class Commands:
    """Passes values of the driving page to actuators at their next action."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._pending: dict[str, PendingCommands] = {}

    def restarted(self) -> None:
        """The components were created again."""
        self._pending.clear()

    def set(self, name: str, fields: JsonObject) -> None:
        """Set fields of an actuator.

        Raises:
            ValueError: there is no such actuator, it has no such field, or a value is invalid.
        """
        component = self._context.components.get(name)
        if not isinstance(component, Actuator):
            raise ValueError(f"there is no actuator '{name}'")
        if name not in self._pending:
            self._pending[name] = PendingCommands(component)
        self._pending[name].give(fields)


# Calls of the driving page to components, by the same services that clients call.


class ServiceCalls(RequestManager):
    """Offers every service of every component to the live view."""

    title = "the live view"

    def __init__(self, context: Context, server: ViewServer, commands: Commands) -> None:
        super().__init__(context)
        self._server = server
        self._commands = commands
        self._pending: dict[uuid.UUID, int] = {}
        self._context = context
        self.register_all()

    def register_all(self) -> None:
        """Offer the services of the present components."""
        self._services.clear()
        context = self._context
        owners: list[tuple[str, Offering]] = [(obj.name(), obj) for obj in context.service_objects]
        owners += [*context.robots.items(), *context.components.items()]
        for name, obj in owners:
            for declaration in obj.services():
                method = getattr(obj, declaration.attribute)
                register = self.register_async_service if declaration.asynchronous else self.register_service
                register(declaration.component or name, method, declaration.name)

    def initialization(self) -> bool:
        """Nothing to do: the server of the view already runs."""
        return True

    def finalization(self) -> bool:
        """Nothing to do."""
        return True

    def main(self) -> None:
        """Nothing to do: requests are events of the view."""

    def on_service_completion(self, request_id: uuid.UUID, result: Outcome) -> None:
        """Send the outcome of a call to the page."""
        request = self._pending.pop(request_id, None)
        if request is not None:
            self._answer(request, result)

    def _answer(self, request: int, outcome: Outcome) -> None:
        state, value = outcome
        if state == status.SUCCESS:
            self._server.send(Answer(request, True, value))
        else:
            self._server.send(Answer(request, False, error=str(value or state)))

    def attempt(self, request: int, action: Callable[[], object]) -> bool:
        """Execute a request, and tell the page if it fails; returns whether it succeeded."""
        try:
            action()
        except Exception as error:
            text = str(error) if isinstance(error, (MorseError, ValueError)) else describe(error)
            self._server.send(Answer(request, False, error=text))
            return False
        return True

    def run(self, component: str, service: str, *arguments: object) -> Any:
        """The result of a synchronous service.

        Raises:
            MorseRPCInvokationError: there is no such service, or it refuses the call.
        """
        _, (_, value) = self.on_incoming_request(component, service, list(arguments))
        return value

    def call(self, event: page.CallService) -> None:
        """Call a service."""
        self.attempt(event.request, lambda: self._begin(event))

    def _begin(self, event: page.CallService) -> None:
        is_complete, value = self.on_incoming_request(event.component, event.service, event.arguments)
        if is_complete:
            self._answer(event.request, value)
        else:
            self._pending[value] = event.request

    def cancel(self, event: page.CancelService) -> None:
        """Interrupt a running service."""
        for request_id, request in list(self._pending.items()):
            if request == event.request:
                self.abort_request(request_id)

    def forget(self, event: PageLeft) -> None:
        """End the running services of a page that has disconnected, if they are only for that page."""
        for request_id, request in list(self._pending.items()):
            if request in event.requests:
                self.abandon(request_id)

    def set_property(self, event: page.SetProperty) -> bool:
        """Change a property; returns whether that was possible."""
        if self.attempt(event.request, lambda: self.run(event.component, "set_property", event.name, event.value)):
            value = self._property(event.component, event.name)
            # sent even if the value has not changed: the field of the page may show another value
            self._server.send(PropertyValue(event.component, event.name, value))
            self._server.send(Answer(event.request, True, value))
            return True
        return False

    def _property(self, component: str, name: str) -> object:
        owner: object = self._context.component(component)
        declarations = properties(type(owner)).items()
        return next((getattr(owner, python_name) for python_name, p in declarations if p.name == name), None)

    def command(self, event: page.Command) -> None:
        """Set data of an actuator."""
        if self.attempt(event.request, lambda: self._commands.set(event.component, event.fields)):
            self._server.send(Answer(event.request, True))

    def toggle_capturing(self, _event: page.ToggleCapturing) -> None:
        """Let all cameras capture images, or stop them if any of them does."""
        cameras = cameras_of(self._context)
        if not cameras:
            self._server.send(Refused("toggle_capturing", "No robot has a camera."))
            return
        active = not any(camera.capturing for camera in cameras)
        for camera in cameras:
            declaration = properties(type(camera)).get("capturing")
            if declaration is None:
                camera.capturing = active
            else:
                self.run(camera.name(), "set_property", declaration.name, active)

    def activate(self, event: page.Activate) -> None:
        """Activate or deactivate a component."""
        service = "activate" if event.active else "deactivate"
        if self.attempt(event.request, lambda: self.run("simulation", service, event.component)):
            self._server.send(Answer(event.request, True))


# Saves states of the simulation, so that the driving page can restore them.

_S = TypeVar("_S")

logger = logging.getLogger(__name__)

#: simulated seconds between two saved states while time runs; seconds for which they are kept, simulated and wall-clock
_EVERY, _SPAN = 0.5, 60.0
#: largest share of the time that is spent on saving states while time runs
_SHARE = 0.01
#: approximate size of all states together, bytes; of larger states fewer are kept
_MOST_BYTES = 64 * 1024 * 1024
#: simulated times that differ by less count as equal, s
_ROUNDING = 1e-9
#: approximate overhead of a value, bytes
_OVERHEAD = 64


class Restorable(Protocol[_S]):
    """The part of a simulation that the history uses."""

    def save(self) -> _S:
        """The state, as plain data."""

    def restore(self, state: _S) -> None:
        """Restore a state."""

    def pause(self) -> None:
        """Stop time."""


@dataclass(frozen=True, slots=True)
class _Kept(Generic[_S]):
    time: float
    state: _S
    size: int
    wall: float


def _time_of(entry: _Kept[_S]) -> float:
    return entry.time


class Rewinder(Generic[_S]):
    """A ring of states: every half second of the last minute, and every single tick.

    A simulation that runs much faster than real time is saved less often, so that its ticks are not slowed.

    Args:
        now: simulated seconds.
        wall: wall-clock seconds.
    """

    def __init__(
        self,
        simulation: Restorable[_S],
        now: Callable[[], float],
        server: ViewServer,
        wall: Callable[[], float] = time.monotonic,
    ) -> None:
        self._simulation = simulation
        self._now = now
        self._wall = wall
        self._rest_until = -math.inf
        self._is_warned = False
        self._server = server
        self._moments: list[_Kept[_S]] = []
        self._bytes = 0
        self._last_times: list[float] = []
        #: the time of the present state of the simulation
        self._at = -1.0

    def keep(self, *, paused: bool) -> None:
        """A tick has ended: save the state if it is time."""
        now = self._now()
        if now == self._at:
            return
        self._at = now
        if self._moments and self._moments[-1].time >= now:
            # time continues from an earlier state: the states after it are invalid
            self._cut(bisect.bisect_left(self._moments, now, key=_time_of))
            self.tell()
        if paused or not self._moments or (now - self._moments[-1].time >= _EVERY - _ROUNDING and self._may_save()):
            self._save(now)
            self.tell()

    def _may_save(self) -> bool:
        return self._wall() >= self._rest_until

    def _save(self, now: float) -> None:
        begin = self._wall()
        try:
            state = self._simulation.save()
        except MorseError as error:  # from ``get_state`` of a component of the user
            if not self._is_warned:
                self._is_warned = True
                logger.warning("the live view cannot return to this time: %s", error)
            self._rest_until = self._wall() + _EVERY
            return
        self._add(_Kept(now, state, size_of(state), begin))
        end = self._wall()
        self._rest_until = end + (end - begin) * (1.0 / _SHARE - 1.0)

    def _add(self, entry: _Kept[_S]) -> None:
        self._moments.append(entry)
        self._bytes += entry.size
        first = 0
        while first < len(self._moments) - 1 and (
            self._bytes > _MOST_BYTES or self._is_old(self._moments[first], entry)
        ):
            self._bytes -= self._moments[first].size
            first += 1
        del self._moments[:first]

    @staticmethod
    def _is_old(entry: _Kept[_S], newest: _Kept[_S]) -> bool:
        return entry.time < newest.time - _SPAN and entry.wall < newest.wall - _SPAN

    def _cut(self, length: int) -> None:
        del self._moments[length:]
        self._bytes = sum(entry.size for entry in self._moments)

    def rewind(self, time: float) -> None:
        """Restore the state saved for that time, or the last one before it, and pause."""
        if self._moments:
            self._go(max(bisect.bisect_right(self._moments, time + _ROUNDING, key=_time_of) - 1, 0))

    def step_back(self) -> None:
        """Restore the last state saved before the present time, and pause."""
        i = bisect.bisect_left(self._moments, self._now() - _ROUNDING, key=_time_of) - 1
        if i >= 0:
            self._go(i)

    def _go(self, index: int) -> None:
        self._simulation.pause()
        try:
            self._simulation.restore(self._moments[index].state)
        except MorseError as error:  # e.g. robots were added or removed since
            self._server.send(Refused("rewind", str(error)))
        self._at = self._now()

    def restarted(self) -> None:
        """Delete all states, because the simulation has restarted."""
        self._cut(0)
        self._at = -1.0
        self.tell()

    def tell(self) -> None:
        """Tell the pages the times of the saved states."""
        times = [entry.time for entry in self._moments]
        if times != self._last_times:
            self._last_times = times
            self._server.send(History(times))


def size_of(state: object) -> int:
    """Approximate size of plain data, bytes."""
    state = getattr(state, "parts", state)  # the parts of a `State`
    size = getattr(state, "nbytes", None)
    if isinstance(size, int):
        return size + _OVERHEAD
    if isinstance(state, (str, bytes)):
        return len(state) + _OVERHEAD
    if isinstance(state, dict):
        return _OVERHEAD + sum(size_of(value) + len(str(key)) for key, value in state.items())
    if isinstance(state, (list, tuple)):
        return _OVERHEAD + sum(size_of(value) for value in state)
    return 32
