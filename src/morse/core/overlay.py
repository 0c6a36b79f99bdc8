"""An overlay shows a component through other services than its own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from morse.core.abstractobject import AbstractObject
from morse.core.state.attributes import replace

if TYPE_CHECKING:
    from collections.abc import Callable


class MorseOverlay(AbstractObject):
    """Base of overlays.

    Attributes:
        overlaid_object: the component behind it.
    """

    def __init__(self, overlaid_object: AbstractObject, **options: Any) -> None:
        super().__init__()
        self.overlaid_object = overlaid_object
        self.options = options

    #: attributes that are not part of the state: they are made from the scene
    not_state: ClassVar[tuple[str, ...]] = ("overlaid_object", "options", "on_completion")

    def get_state(self) -> dict[str, Any]:
        """All that determines what the overlay does next: its attributes, but for those in `not_state`."""
        return {name: value for name, value in vars(self).items() if name not in self.not_state}

    def set_state(self, state: dict[str, Any]) -> None:
        """Take a state from `get_state`."""
        replace(vars(self), self.get_state(), state)
        # who called a service that was under way is not there any more
        self.on_completion = None if self.running_service is None else _nobody

    def name(self) -> str:
        """Override it to offer the services under another name."""
        return self.overlaid_object.name()

    def chain_callback(self, fn: Callable[[Any], Any] | None = None) -> Callable[[Any], None]:
        """A callback that ends the running service of the overlay when that of the object ends.

        Args:
            fn: changes the outcome ``(status, result)`` on its way.
        """

        def done(outcome: Any) -> None:
            status, result = fn(outcome) if fn is not None else outcome
            self.completed(status, result)

        return done

    def interrupt(self) -> None:
        """Interrupt the object behind the overlay."""
        self.overlaid_object.interrupt()


def _nobody(_outcome: Any) -> None:
    """Nobody waits for the end of a service."""
