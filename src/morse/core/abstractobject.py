"""The base class of all objects that offer services."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.core import status as _status
from morse.core.declarations import add_state
from morse.core.services import ServiceDeclaration, declared_services

if TYPE_CHECKING:
    from collections.abc import Callable, Sized

    from morse.core.services import Outcome
    from morse.core.values import Fields

logger = logging.getLogger(__name__)


class AbstractObject:
    """Base of components and of the objects behind the services of the simulation.

    Attributes:
        local_data: the data fields, by name; kept between ticks.
        on_completion: called when the running asynchronous service ends, or None.
        running_service: name of the running asynchronous service, or None.
        waiting: of an object that offers services: a collection that is empty while `action` has nothing to do, always
            the same; None if this is not known.
    """

    waiting: Sized | None = None

    add_state("local_data", object, "Values of the data fields")
    add_state("running_service", str | None, "Name of the service that runs")

    def __init__(self) -> None:
        self.local_data: Fields = {}
        self.on_completion: Callable[[Outcome], object] | None = None
        self.running_service: str | None = None

    def name(self) -> str:
        """The name under which the services are offered."""
        return type(self).__name__

    def services(self) -> list[ServiceDeclaration]:
        """The services this object offers."""
        return list(declared_services(type(self)))

    def completed(self, status: str, result: object = None) -> None:
        """End the running asynchronous service.

        Args:
            status: ``SUCCESS``, ``FAILED`` or ``PREEMPTED`` (`morse.core.status`).
            result: sent to the caller; anything that can be written as JSON.
        """
        callback, self.on_completion = self.on_completion, None
        self.running_service = None
        if callback is None:
            logger.warning("%s completed a service while none was running; the result is ignored", self.name())
            return
        callback((status, result))

    def interrupt(self) -> None:
        """End the running asynchronous service as preempted.

        Override it to stop the work of the service, and call this method at the end.
        """
        if self.on_completion is not None:
            self.completed(_status.PREEMPTED)

    def progress(self) -> Fields:
        """Return the progress of the running service for the feedback of actions; empty if it is not known.

        Keys are the names of fields of feedback messages, such as ``distance_remaining`` (`morse.core.calls`).
        """
        return {}

    def default_action(self) -> None:
        """Perform the work of a tick."""

    def action(self) -> None:
        """Perform one tick."""
        self.default_action()

    @property
    def is_idle(self) -> bool:
        """Whether its action does nothing."""
        cls = type(self)
        return (
            cls.action is AbstractObject.action
            and cls.default_action is AbstractObject.default_action
            and not vars(self).keys() & {"action", "default_action"}
        )

    def restart(self) -> None:
        """Reset the object, because the simulation starts again at tick 0."""

    def get_state(self) -> object:
        """Return the state that determines the future of the object, as plain data; None without a state."""
        return None

    def set_state(self, state: Any) -> None:
        """Restore a state that `get_state` returned."""

    def finalize(self) -> None:
        """Release resources at the end of the simulation."""
