"""An overlay shows a component through other services than its own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.abstractobject import AbstractObject

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
