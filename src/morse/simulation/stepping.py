"""Time that passes by itself, or tick by tick as clients ask."""

from __future__ import annotations

from collections import deque
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
    """

    def __init__(self) -> None:
        self.paused = False
        self._series: deque[tuple[int, Callable[[tuple[str, Any]], object]]] = deque()
        self._left = 0

    @property
    def halted(self) -> bool:
        """Whether no tick is to be done now."""
        return self.paused and not self._left

    def add(self, ticks: int, ended: Callable[[tuple[str, Any]], object]) -> None:
        """Have ``ended((status, None))`` called when that many more ticks are done, after those asked for before."""
        self._series.append((ticks, ended))
        self._left = self._left or ticks

    def count(self) -> None:
        """A tick is done."""
        if not self._left:
            return
        self._left -= 1
        if not self._left:
            _, ended = self._series.popleft()
            self._left = self._series[0][0] if self._series else 0
            ended((status.SUCCESS, None))

    def end(self, outcome: str, reason: str | None = None) -> None:
        """Do no more of the ticks that were asked for, and tell those who wait."""
        self._left = 0
        series = list(self._series)
        self._series.clear()
        for _, ended in series:
            ended((outcome, reason))
