"""Requests of clients for a number of ticks."""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING

from morse.core import status

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.guard import Guard
    from morse.core.services import Outcome

#: callback for the end of a request, with status and result
Ended = "Callable[[Outcome], object]"


class Stepping:
    """The queue of requested ticks.

    Attributes:
        paused: whether only requested ticks are executed.
        forced: whether the process itself executes ticks now.
    """

    def __init__(self, guard: Guard) -> None:
        self._guard = guard
        self.paused = self.forced = False
        self._series: OrderedDict[object, tuple[int, Callable[[Outcome], object]]] = OrderedDict()
        self._left = 0

    @property
    def halted(self) -> bool:
        """Whether no tick may be executed now."""
        return self.paused and not self._left and not self.forced

    @property
    def is_idle(self) -> bool:
        """Whether no ticks are requested."""
        return not self._left

    def add(self, ticks: int, ended: Callable[[Outcome], object]) -> Callable[[], None]:
        """Request ``ticks`` ticks, after earlier requests; ``ended((status, None))`` is called after the last tick.

        Returns:
            A function that cancels the request.
        """
        key = object()
        self._series[key] = (ticks, ended)
        self._left = self._left or ticks
        return lambda: self._cancel(key)

    def _cancel(self, key: object) -> None:
        if key not in self._series:
            return
        first = key is next(iter(self._series))
        _, ended = self._series.pop(key)
        if first:
            self._begin_next()
        self._guard.call([ended], (status.PREEMPTED, None))

    def _begin_next(self) -> None:
        self._left = next(iter(self._series.values()))[0] if self._series else 0

    def count(self) -> None:
        """Count a tick that was executed."""
        if not self._left:
            return
        self._left -= 1
        if not self._left:
            _, (_, ended) = self._series.popitem(last=False)
            self._begin_next()
            self._guard.call([ended], (status.SUCCESS, None))

    def end(self, outcome: str, reason: str | None = None) -> None:
        """Cancel all requested ticks, and answer the requests."""
        self._left = 0
        series = list(self._series.values())
        self._series.clear()
        self._guard.call([ended for _, ended in series], (outcome, reason))
