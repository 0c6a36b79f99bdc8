"""The base class of overlays, which offer the services of a component in another form."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from morse.core.abstractobject import AbstractObject
from morse.core.state.attributes import replace, state_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.services import Outcome
    from morse.core.values import JsonObject, StateData


class MorseOverlay(AbstractObject):
    """Base of overlays.

    Attributes:
        overlaid_object: the component whose services are replaced.
    """

    def __init__(self, overlaid_object: AbstractObject, **options: object) -> None:
        super().__init__()
        self.overlaid_object = overlaid_object
        self.options = options

    #: attributes that are not part of the state: they are created from the scene
    not_state: ClassVar[tuple[str, ...]] = ("overlaid_object", "options", "on_completion")

    def get_state(self) -> StateData:
        """Return the state of the overlay: its attributes, except those in `not_state`."""
        return state_of(self)

    def set_state(self, state: StateData) -> None:
        """Restore a state that `get_state` returned."""
        replace(self, self.get_state(), state)
        # the client that called a running service may have disconnected
        self.on_completion = None if self.running_service is None else _nobody

    def name(self) -> str:
        """Override it to offer the services under another name."""
        return self.overlaid_object.name()

    def chain_callback(self, fn: Callable[[Outcome], Outcome] | None = None) -> Callable[[Outcome], None]:
        """A callback that ends the running service of the overlay when the service of the object ends.

        Args:
            fn: maps the outcome ``(status, result)`` of the object to that of the overlay.
        """

        def done(outcome: Outcome) -> None:
            status, result = fn(outcome) if fn is not None else outcome
            self.completed(status, result)

        return done

    def progress(self) -> JsonObject:
        """Return the progress of the overlaid object."""
        return self.overlaid_object.progress()

    def interrupt(self) -> None:
        """Interrupt the overlaid object."""
        self.overlaid_object.interrupt()


def _nobody(_outcome: object) -> None:
    """Completion callback of a service whose client has disconnected."""
