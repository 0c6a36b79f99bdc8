"""The parts of the physics that act before and after the steps of the engine in a tick."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence


class Part(Protocol):
    """A part of the physics with work in some ticks."""

    @property
    def has_work(self) -> bool:
        """Whether the part acts in the next ticks. The part calls `Tick.rearrange` when this changes."""

    def before_step(self) -> None:
        """Called at the beginning of a tick."""

    def after_step(self) -> None:
        """Called at the end of a tick."""


class Tick:
    """Calls the parts that have work.

    Attributes:
        before, after: what is called at the beginning and at the end of a tick.
    """

    def __init__(self) -> None:
        self._order: tuple[Sequence[Part], Sequence[Part]] = (), ()
        self.before: Sequence[Callable[[], None]] = ()
        self.after: Sequence[Callable[[], None]] = ()

    def arrange(self, before: Sequence[Part], after: Sequence[Part]) -> None:
        """Set the parts that act before and after the steps of the engine, in the order in which they act."""
        self._order = before, after
        self.rearrange()

    def rearrange(self) -> None:
        """Find the parts again that have work."""
        before, after = self._order
        self.before = [part.before_step for part in before if part.has_work]
        self.after = [part.after_step for part in after if part.has_work]
