"""Time that passes by itself, or tick by tick as clients ask."""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, Any

from morse.core import status

if TYPE_CHECKING:
    from collections.abc import Callable

#: told how a series of ticks ended: status and result
Ended = "Callable[[tuple[str, Any]], object]"


class Stepping:
    """Who waits for how many ticks.

    Attributes:
        paused: no time passes but the ticks that somebody waits for.
        forced: the process itself has ticks done now.
    """

    def __init__(self) -> None:
        self.paused = self.forced = False
        self._series: OrderedDict[object, tuple[int, Callable[[tuple[str, Any]], object]]] = OrderedDict()
        self._left = 0

    @property
    def halted(self) -> bool:
        """Whether no tick is to be done now."""
        return self.paused and not self._left and not self.forced

    def add(self, ticks: int, ended: Callable[[tuple[str, Any]], object]) -> Callable[[], None]:
        """Have ``ended((status, None))`` called when that many more ticks are done, after those asked for before.

        Returns:
            What cancels them.
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
        ended((status.PREEMPTED, None))

    def _begin_next(self) -> None:
        self._left = next(iter(self._series.values()))[0] if self._series else 0

    def count(self) -> None:
        """A tick is done."""
        if not self._left:
            return
        self._left -= 1
        if not self._left:
            _, (_, ended) = self._series.popitem(last=False)
            self._begin_next()
            ended((status.SUCCESS, None))

    def end(self, outcome: str, reason: str | None = None) -> None:
        """Give up the ticks that are still wanted, and answer the requests that wait for the ticks."""
        self._left = 0
        series = list(self._series.values())
        self._series.clear()
        for _, ended in series:
            ended((outcome, reason))
