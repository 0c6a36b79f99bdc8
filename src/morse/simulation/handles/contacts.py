"""What a robot or an object touches, apart from the floor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from morse.core.observer import Observer

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from morse.core.context import Context


@dataclass(slots=True)
class Contact:
    """A contact, from its begin to its end.

    Attributes:
        other: name of the other body.
        begin: simulated time of the end of the tick in which it began, s.
        end: likewise, of the first tick without the contact; None while it lasts.
        impulse: sum of the magnitudes of its impulses since the last `Simulation.step`, N·s.
    """

    other: str
    begin: float
    end: float | None = None
    impulse: float = 0.0


class Contacts(Observer):
    """The contacts of one body with anything but the floor since the begin of the last `Simulation.step`.

    The floor is what is static and carries the body from below: contacts whose normal is within 45 degrees of the
    vertical. Contacts are found in each step of the physics, 240 times per second, so that no touch is lost.

    Attributes:
        body: name of the robot or object.
        events: the contacts that lasted or began since then, in the order of their begins.
    """

    def __init__(self, context: Context, body: str) -> None:
        self.body = body
        self.events: list[Contact] = []
        self._context = context
        self._impulses: Mapping[str, float] = context.world.watch_touches(body)
        self._lasting: dict[str, Contact] = {}
        self._tick = context.clock.tick
        self._callbacks: list[Callable[[Contact], object]] = []

    @property
    def touched(self) -> bool:
        """Whether there was any contact."""
        return bool(self.events)

    @property
    def impulse(self) -> float:
        """The sum of the magnitudes of all impulses, N·s."""
        return sum(contact.impulse for contact in self.events)

    @property
    def waits(self) -> bool:
        """Whether nothing touches the body."""
        return not (self._lasting or self._impulses)

    @property
    def sees_steps(self) -> bool:
        """Whether nobody has subscribed."""
        return not self._callbacks

    def subscribe(self, callback: Callable[[Contact], object]) -> None:
        """Call ``callback(contact)`` after each tick in which a contact begins; one that fails is removed."""
        self._callbacks.append(callback)

    def unsubscribe(self, callback: Callable[[Contact], object]) -> None:
        """Remove a callback."""
        if callback in self._callbacks:
            self._callbacks.remove(callback)

    def begin(self) -> None:
        """Begin a step: contacts that have ended are forgotten."""
        self.events = list(self._lasting.values())
        for contact in self.events:
            contact.impulse = 0.0

    def after_tick(self) -> None:
        """Take the contacts of a tick."""
        clock, lasting, impulses = self._context.clock, self._lasting, self._impulses
        if clock.tick == self._tick or not (impulses or lasting):
            self._tick = clock.tick
            return
        self._tick = clock.tick
        for other in [other for other in lasting if other not in impulses]:
            lasting.pop(other).end = clock.time
        began = []
        for other, impulse in impulses.items():
            if other not in lasting:
                lasting[other] = Contact(other, clock.time)
                self.events.append(lasting[other])
                began.append(lasting[other])
            lasting[other].impulse += impulse
        if self._callbacks:
            self._tell(began)

    def _tell(self, began: Sequence[Contact]) -> None:
        guard, callbacks = self._context.guard, self._callbacks
        for contact in began:
            guard.each(
                list(callbacks),
                lambda callback, contact=contact: callback(contact),  # type: ignore[misc]
                lambda callback, error: guard.remove(callbacks, callback, error),
            )

    def part(self, name: str) -> None:
        """End the contacts of a body that has been placed: the next step begins without them."""
        lasting = self._lasting
        for other in list(lasting) if name == self.body else [name] if name in lasting else []:
            lasting.pop(other).end = self._context.clock.time

    def restarted(self) -> None:
        """Forget all contacts, because the simulation has restarted."""
        self.rearranged()
        self.events = []

    def rearranged(self) -> None:
        """Forget what lasts, because bodies may be elsewhere."""
        self._lasting.clear()

    def __repr__(self) -> str:
        others = ", ".join(contact.other for contact in self.events) or "nothing"
        return f"<Contacts of {self.body} with {others}, {self.impulse:.3g} N·s>"
