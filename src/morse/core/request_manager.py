"""Request managers, which offer services over a middleware, and `MorseServices`, the list of the managers."""

from __future__ import annotations

import logging
import uuid
from abc import ABC, abstractmethod
from itertools import count
from types import FunctionType, MethodType
from typing import TYPE_CHECKING, Final, NamedTuple, Protocol
from weakref import WeakKeyDictionary

from morse.core import status
from morse.core.abstractobject import AbstractObject
from morse.core.exceptions import (
    MorseMethodNotFoundError,
    MorseRPCInvokationError,
    MorseServiceError,
)
from morse.core.journal import CANCEL, SERVICE
from morse.core.reports.faults import ENDINGS, attribute, describe, name_of, summary
from morse.core.reports.quoting import nearest, quoted, short
from morse.core.services import Outcome, ServiceDeclaration
from morse.core.streams.extent import TooLarge, check_result
from morse.core.validation.arguments import Arguments

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Set, Sized

    from morse.core.guard import Guard
    from morse.core.journal import Journal
    from morse.core.values import Value

logger = logging.getLogger(__name__)


class OfferedService(NamedTuple):
    """A service that a manager offers.

    Attributes:
        callback: the function that implements the service.
        is_async: whether the service ends later; it then calls its first argument.
        accepted: validation of its arguments.
        changes: whether a call may change the simulation; other calls are not recorded in the journal.
    """

    callback: Callable[..., object]
    is_async: bool
    accepted: Arguments
    changes: bool

    @classmethod
    def of(cls, callback: Callable[..., object], name: str, is_async: bool) -> OfferedService:
        """A service from the method behind it."""
        declaration = getattr(callback, "_morse_service", None)
        changes = declaration.changes if isinstance(declaration, ServiceDeclaration) else True
        return cls(callback, is_async, _accepted_by(callback, name), changes)


#: validation of the arguments of methods, by function and name of the service: signatures are read once, not whenever a
#: robot is spawned or the simulation is reset
_known_arguments: WeakKeyDictionary[FunctionType, dict[str, Arguments]] = WeakKeyDictionary()


def _accepted_by(callback: Callable[..., object], name: str) -> Arguments:
    function = callback.__func__ if isinstance(callback, MethodType) else None
    if not isinstance(function, FunctionType):
        return Arguments(callback, name)
    cache = _known_arguments.setdefault(function, {})
    if name not in cache:
        cache[name] = Arguments(callback, name)
    return cache[name]


class Journaling(Protocol):
    """The part of a simulation (`morse.core.context.Context`) that every request manager needs."""

    @property
    def journal(self) -> Journal:
        """The journal of input from outside."""

    def component(self, name: str) -> object | None:
        """The component or robot of that name; None if there is none."""


class RequestManager(ABC):
    """Offers services over one middleware.

    A subclass reads requests in `main`, hands each to `on_incoming_request`, and sends the
    outcome of asynchronous ones when `on_service_completion` is called.

    Attributes:
        classpath: the name under which summaries and clients know it.
        waiting: a collection that is empty while `main` has nothing to do, the same from the start to the end; by
            default it always may have.
    """

    classpath: str = ""
    waiting: Sized = (True,)

    def __init__(self, context: Journaling | None = None) -> None:
        self.context = context
        self._services: dict[tuple[str, str], OfferedService] = {}
        self._running: dict[uuid.UUID, tuple[AbstractObject | None, str, str]] = {}
        self._arrivals: list[tuple[uuid.UUID, Outcome]] = []
        #: numbers of the running calls in the journal
        self._orders: dict[uuid.UUID, int] = {}
        self._cancellations: dict[uuid.UUID, Callable[[], object]] = {}
        if not self.classpath:
            self.classpath = f"{type(self).__module__}.{type(self).__name__}"

    @abstractmethod
    def initialization(self) -> bool:
        """Open ports and connections; return False if that failed."""

    @abstractmethod
    def finalization(self) -> bool:
        """Release the resources of `initialization`."""

    def post_registration(self, component_name: str, service: str, is_async: bool) -> bool:
        """Announce a new service to the middleware; return False if it cannot be offered."""
        return True

    @abstractmethod
    def on_service_completion(self, request_id: uuid.UUID, result: Outcome) -> None:
        """Called when an asynchronous call has ended."""

    @abstractmethod
    def main(self) -> None:
        """Read the requests that arrived; called at the beginning of every tick, and while the simulation waits."""

    def update(self) -> None:
        """One tick: process requests, then send the outcomes of the calls that ended since the last tick."""
        self.main()
        self.answer()

    @property
    def is_busy(self) -> bool:
        """Whether a call is running, or has ended without an answer."""
        return bool(self._running or self._arrivals)

    def finish(self) -> None:
        """Send the last outcomes and stop."""
        self.answer()
        self.finalization()

    def answer(self) -> None:
        """Send the outcomes of the calls that have ended."""
        arrivals = self._arrivals[:]
        del self._arrivals[: len(arrivals)]  # other threads may append
        for request_id, outcome in arrivals:
            self.on_service_completion(request_id, outcome)

    def register_service(
        self, component_name: str, callback: Callable[..., object], service_name: str | None = None
    ) -> None:
        """Offer a function that returns its result."""
        self._register(component_name, callback, service_name or callback.__name__, is_async=False)

    def register_async_service(
        self, component_name: str, callback: Callable[..., object], service_name: str | None = None
    ) -> None:
        """Offer a function whose first argument is called with the outcome."""
        self._register(component_name, callback, service_name or callback.__name__, is_async=True)

    def _register(self, component: str, callback: Callable[..., object], name: str, *, is_async: bool) -> None:
        if not callable(callback):
            raise MorseServiceError(f"'{name}' of {component} is not callable, it cannot be a service")
        if self.post_registration(component, name, is_async):
            self._services[component, name] = OfferedService.of(callback, name, is_async)

    def unregister(self, owner: object) -> None:
        """Stop offering the services of an object; those of other objects with the same name remain."""
        gone = [key for key, entry in self._services.items() if _owner_of(entry.callback) is owner]
        for key in gone:
            del self._services[key]
        for component in dict.fromkeys(component for component, _ in gone):
            self.withdrawn(component, {service for name, service in gone if name == component})

    def withdrawn(self, component_name: str, services: Set[str]) -> None:
        """Called when services of a component are no longer offered."""

    def services(self) -> dict[str, list[str]]:
        """The services by component, in the order of registration."""
        listing: dict[str, list[str]] = {}
        for component, name in self._services:
            listing.setdefault(component, []).append(name)
        return listing

    def find(self, component: str, service: str) -> OfferedService | None:
        """The service of that name, or None."""
        return self._services.get((component, service))

    def on_incoming_request(self, component: str, service: str, params: list[object] | None) -> tuple[bool, Value]:
        """Run a service.

        Returns:
            ``(True, (status, result))`` if the service has ended, ``(False, request_id)`` if it continues.

        Raises:
            MorseRPCInvokationError: there is no such service, the arguments are wrong, or the service failed.
        """
        entry = self.find(component, service)
        if entry is None:
            raise MorseMethodNotFoundError(self._unknown(component, service))
        arguments = list(params or [])
        entry.accepted.check(arguments)
        if not entry.changes or self.context is None:
            return self._start(entry, component, service, arguments, None)
        order = self.context.journal.note(SERVICE, component, (service, arguments))
        try:
            is_complete, outcome = self._start(entry, component, service, arguments, order)
        except BaseException as error:
            if order is not None:
                self.context.journal.refuse(component, order, error)
            raise
        if is_complete and order is not None and outcome[1] is not None:
            self.context.journal.conclude(component, order, *outcome)
        return is_complete, outcome

    def _start(
        self, entry: OfferedService, component: str, service: str, arguments: list[object], order: int | None
    ) -> tuple[bool, Value]:
        """Run a service, or begin to; see `on_incoming_request`."""
        if not entry.is_async:
            return True, (status.SUCCESS, _result(entry.callback, *arguments))
        request_id = uuid.UUID(int=next(_numbers))
        owner = _owner_of(entry.callback)
        self._running[request_id] = (owner if isinstance(owner, AbstractObject) else None, component, service)
        if order is not None:
            self._orders[request_id] = order
        try:
            cancel = _result(entry.callback, lambda outcome: self._ended(request_id, outcome), *arguments)
        except BaseException:
            self._running.pop(request_id, None)
            self._orders.pop(request_id, None)
            raise
        if request_id in self._running and getattr(entry.callback, "_morse_concurrent", False) and callable(cancel):
            self._cancellations[request_id] = cancel
        return False, request_id

    def _unknown(self, component: str, service: str) -> str:
        services = self.services()
        text = f"The request {short(service)} has not been registered in {self.title}"
        if component in services:
            return text + nearest(service, services[component])
        if self.context is not None and self.context.component(component) is not None:
            method = f"{component.rpartition('.')[2]}.add_service()"
            return f"{text}: services of {quoted(component)} are not offered here; {method} in the script offers them"
        return f"{text}: there is no component {quoted(component)}{nearest(component, sorted(services))}"

    #: name of this manager in messages to clients
    title = "the service manager"

    def _ended(self, request_id: uuid.UUID, outcome: object) -> None:
        running = self._running.pop(request_id, _GONE)
        if running is _GONE:
            return
        self._cancellations.pop(request_id, None)
        if not isinstance(outcome, tuple):
            outcome = (status.SUCCESS, outcome)
        elif len(outcome) != 2 or not isinstance(outcome[0], str) or outcome[0] not in status.ALL:
            expected = f"a status ({', '.join(status.ALL)}) and a result"
            outcome = (status.FAILED, f"the service {running[2]} ended with {quoted(outcome)}, expected {expected}")
        try:
            check_result(running[0], outcome)
        except TooLarge as error:
            outcome = status.FAILED, str(error)
        self._arrive(request_id, running[1], outcome)

    def _arrive(self, request_id: uuid.UUID, component: str, outcome: Outcome) -> None:
        order = self._orders.pop(request_id, None)
        if self.context is not None and order is not None:
            self.context.journal.conclude(component, order, *outcome)
        self._arrivals.append((request_id, outcome))

    def hand_over(self, before: AbstractObject, after: AbstractObject) -> None:
        """Transfer the running calls of an object to the object that replaces it."""
        for request_id, (owner, component, service) in list(self._running.items()):
            if owner is before:
                self._running[request_id] = (after, component, service)

    def abort_request(self, request_id: uuid.UUID) -> None:
        """Interrupt a running asynchronous call; its caller gets ``PREEMPTED``."""
        if request_id not in self._running:
            return
        owner, component, service = self._running[request_id]
        entry = self.find(component, service)
        if self.context is not None and (entry is None or entry.changes):
            self.context.journal.note(CANCEL, component, (service, self._orders.get(request_id, -1)))
        cancel = self._cancellations.pop(request_id, None)
        if cancel is not None:
            cancel()
        elif owner is not None:
            owner.interrupt()
        if self._running.pop(request_id, _GONE) is not _GONE:
            self._arrive(request_id, component, (status.PREEMPTED, None))

    def abandon(self, request_id: uuid.UUID) -> None:
        """Cancel a call whose client has disconnected, if the service is only for that client: `concurrent_service`."""
        if request_id in self._cancellations:
            self.abort_request(request_id)

    def preempt(self, spared: Collection[AbstractObject]) -> None:
        """Interrupt every running asynchronous call except those of the ``spared`` objects."""
        for request_id, (owner, _, _) in list(self._running.items()):
            if owner is not None and owner in spared:
                continue
            try:
                self.abort_request(request_id)
            except ENDINGS:
                raise
            except BaseException as error:
                # code of the user failed to interrupt the service; the client gets an answer nevertheless
                logger.error("%s could not interrupt its service: %s", name_of(owner), describe(error))
                self._ended(request_id, (status.PREEMPTED, None))


_GONE: Final[tuple[AbstractObject | None, str, str]] = (None, "", "")
#: of all requests of this process
_numbers = count(1)


def _result(service: Callable[..., object], *arguments: object) -> object:
    """Call a service.

    Raises:
        RuntimeError: the service has raised an error that is not an `Exception`, and that would end the managers.
    """
    try:
        result = service(*arguments)
        check_result(service.__self__ if type(service) is MethodType else attribute(service, "__self__"), result)
        return result
    except (Exception, *ENDINGS):
        raise
    except BaseException as error:
        raise RuntimeError(summary(error)).with_traceback(error.__traceback__) from error


def _owner_of(callback: Callable[..., object]) -> object:
    """The object whose method implements a service; None for a function."""
    return attribute(callback, "__self__")


def _answer(manager: RequestManager) -> None:
    manager.answer()


def _update(manager: RequestManager) -> None:
    manager.update()


class MorseServices:
    """All request managers, and the mapping of components to managers."""

    def __init__(self, managers: Iterable[RequestManager] = ()) -> None:
        self._managers: dict[str, RequestManager] = {manager.classpath: manager for manager in managers}
        self._mapping: dict[str, list[str]] = {}
        self._internal: list[RequestManager] = []
        #: of the simulation
        self.guard: Guard | None = None
        self._look()

    def add_internal(self, manager: RequestManager) -> None:
        """Add a manager for service calls within the process; summaries do not list it."""
        self._internal.append(manager)
        self._look()

    def add_request_manager(self, manager: RequestManager) -> None:
        """Add a manager and start it.

        Raises:
            MorseServiceError: the manager cannot start.
        """
        if not manager.initialization():
            raise MorseServiceError(f"the request manager {manager.classpath} could not start")
        self._managers[manager.classpath] = manager
        self._look()

    def request_managers(self) -> dict[str, RequestManager]:
        """The managers by class path."""
        return self._managers

    def register_request_manager_mapping(self, component: str, manager: str) -> None:
        """Let ``manager`` offer the services of ``component``."""
        if manager not in self._managers:
            raise MorseServiceError(f"no request manager '{manager}'{nearest(manager, sorted(self._managers))}")
        names = self._mapping.setdefault(component, [])
        if manager not in names:
            names.append(manager)

    def managers_of(self, component: str) -> list[RequestManager]:
        """The managers that offer the services of a component."""
        return [self._managers[name] for name in self._mapping.get(component, [])]

    def register_object(self, name: str, obj: AbstractObject) -> None:
        """Offer all services that an object declares, with the managers mapped to ``name``."""
        for declaration in obj.services():
            component = declaration.component or name
            method = getattr(obj, declaration.attribute)
            for manager in self.managers_of(component) or self.managers_of(name):
                if declaration.asynchronous:
                    manager.register_async_service(component, method, declaration.name)
                else:
                    manager.register_service(component, method, declaration.name)

    def _everybody(self) -> list[RequestManager]:
        return [*self._managers.values(), *self._internal]

    def unregister(self, obj: AbstractObject) -> None:
        """Stop offering the services of a component or of an overlay that was deleted."""
        for manager in self._everybody():
            manager.unregister(obj)
        name = obj.name()
        if not any(name in manager.services() for manager in self._managers.values()):
            self._mapping.pop(name, None)

    def replace(self, name: str, before: AbstractObject, after: AbstractObject) -> None:
        """Replace an object by another object, which takes over its services and its running calls."""
        for manager in self._everybody():
            manager.unregister(before)
            manager.hand_over(before, after)
        self.register_object(name, after)

    def _look(self) -> None:
        #: collections that are empty while no manager has anything to do
        self._work: list[Sized] = [
            sign for manager in self._everybody() for sign in (manager.waiting, manager._arrivals)
        ]

    def has_work(self) -> bool:
        """Whether a request has arrived, or a call has ended."""
        return any(self._work)

    def process(self) -> None:
        """One tick of every manager; one that fails is stopped."""
        if self.guard is None:
            raise RuntimeError("the services do not belong to a simulation")
        if busy := self._busy(self._everybody()):
            self.guard.each(busy, _update, self._stop)

    @staticmethod
    def _busy(managers: Iterable[RequestManager]) -> list[RequestManager]:
        """Return the managers with requests or outcomes, in a list of their own: a service may add managers."""
        return [manager for manager in managers if manager.waiting or manager._arrivals]

    def _stop(self, manager: RequestManager, error: BaseException) -> None:
        assert self.guard is not None
        guard, who = self.guard, f"the request manager {manager.classpath}"
        guard.failed(manager, who, "is stopped", error)
        self._managers = {name: one for name, one in self._managers.items() if one is not manager}
        self._internal = [one for one in self._internal if one is not manager]
        self._look()
        self._mapping = {
            component: [name for name in names if name in self._managers] for component, names in self._mapping.items()
        }
        guard.run(manager.finalization, lambda again: guard.failed(manager, who, "is left as it is", again))

    @property
    def is_quiet(self) -> bool:
        """Whether no client can call, and no call is running."""
        return not self._managers and not any(manager.is_busy for manager in self._internal)

    def answer(self) -> None:
        """Send the outcomes of the calls that have ended in this tick."""
        if self.guard is not None and (busy := self._busy(self._managers.values())):
            self.guard.each(busy, _answer, self._stop)

    def preempt(self, spared: Collection[AbstractObject]) -> None:
        """Interrupt every running asynchronous call except those of the ``spared`` objects."""
        for manager in self._everybody():
            manager.preempt(spared)

    def everybody(self) -> list[RequestManager]:
        """All managers, also those for calls within the process."""
        return self._everybody()

    def finalize(self) -> None:
        """Send the last outcomes and stop every manager."""
        for manager in self._everybody():
            manager.finish()


__all__ = ["MorseRPCInvokationError", "MorseServices", "OfferedService", "Outcome", "RequestManager"]
