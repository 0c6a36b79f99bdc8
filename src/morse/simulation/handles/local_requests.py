"""Service calls from within the process."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.context import acting
from morse.core.exceptions import MorseError, MorseRPCNbArgsError
from morse.core.reports.faults import summary
from morse.core.request_manager import OfferedService, Outcome, RequestManager
from morse.simulation.handles.futures import LocalFuture

if TYPE_CHECKING:
    import uuid
    from collections.abc import Callable

    from morse.core.abstractobject import AbstractObject
    from morse.core.context import Context
    from morse.core.interfaces import Offering


class LocalRequests(RequestManager):
    """Offers all services of all components to the process; services are looked up when they are called.

    Args:
        tick: function that runs one tick, for a caller that waits for the end of a service.
    """

    title = "this simulation"
    waiting = ()

    def __init__(self, context: Context, tick: Callable[[], object]) -> None:
        super().__init__(context)
        self._context = context
        self._tick = tick
        self._entries: dict[tuple[str, str], tuple[AbstractObject, OfferedService]] = {}
        self._futures: dict[uuid.UUID, LocalFuture] = {}

    def initialization(self) -> bool:
        """Do nothing: no ports or connections are needed."""
        return True

    def finalization(self) -> bool:
        """Do nothing: there is nothing to release."""
        return True

    def main(self) -> None:
        """Do nothing: requests are executed when they are made."""

    def call(self, component: str, service: str, *arguments: object) -> LocalFuture:
        """Call a service.

        Raises:
            TypeError: the number of arguments is wrong.
            pymorse.MorseServiceFailed: there is no such service, the arguments are wrong, or the service failed.
        """
        with acting(self._context):
            try:
                is_complete, outcome = self.on_incoming_request(component, service, list(arguments))
            except MorseRPCNbArgsError as error:
                raise TypeError(str(error)) from None
            except Exception as error:
                from pymorse.errors import MorseServiceFailed

                text = str(error) if isinstance(error, MorseError) else summary(error)
                raise MorseServiceFailed(text) from error
        future = LocalFuture(self._tick, self._context.clock, self._context.guard)
        if is_complete:
            future.finish(outcome)
        else:
            self._futures[outcome] = future
            future.abort = lambda: self._abort(outcome)
            self.answer()  # the service may already have ended
        return future

    def _abort(self, request_id: uuid.UUID) -> None:
        with acting(self._context):
            self.abort_request(request_id)
            self.answer()

    def _ended(self, request_id: uuid.UUID, outcome: object) -> None:
        super()._ended(request_id, outcome)
        if request_id in self._futures:
            self.answer()

    def on_service_completion(self, request_id: uuid.UUID, result: Outcome) -> None:
        """Set the outcome of a service that has ended."""
        future = self._futures.pop(request_id, None)
        if future is not None:
            future.finish(result)

    # -- looking up services ---------------------------------------------------------------

    def find(self, component: str, service: str) -> OfferedService | None:
        """Return the present service of a component."""
        owner, entry = self._entries.get((component, service), (None, None))
        if owner is not None and any(owner is obj for obj in self._objects(component)):
            return entry
        for obj in self._objects(component):
            for declaration in obj.services():
                if declaration.name == service:
                    entry = OfferedService.of(getattr(obj, declaration.attribute), service, declaration.asynchronous)
                    self._entries[component, service] = obj, entry
                    return entry
        return None

    def _objects(self, name: str) -> list[AbstractObject]:
        component = self._context.component(name) or self._context.overlays.get(name)
        return [component] if component is not None else [o for o in self._context.service_objects if o.name() == name]

    def services(self) -> dict[str, list[str]]:
        """The services by component."""
        context = self._context
        listing: dict[str, list[str]] = {}
        everything: dict[str, Offering] = {**context.robots, **context.components, **context.overlays}
        for name, obj in [*everything.items(), *((o.name(), o) for o in context.service_objects)]:
            listing.setdefault(name, []).extend(declaration.name for declaration in obj.services())
        return listing
