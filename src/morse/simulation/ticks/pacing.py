"""Synchronizes simulated time with the wall clock."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

from morse.core.clock import SLOWEST

if TYPE_CHECKING:
    from collections.abc import Callable

#: delay above which lost time is dropped, because the simulation would run too fast to catch up
_GIVE_UP = 0.25
#: interval of warnings that the simulation falls behind, wall-clock seconds
_REPORT_EVERY = 10.0
#: share of lost time below which no warning is logged
_WORTH_A_WORD = 0.05
#: interval at which waits check whether the simulation was asked to end, wall-clock seconds
_NAP = 0.05


def _nothing() -> None:
    return None


def _go_on() -> bool:
    return True


class Pacer:
    """Waits between ticks.

    Args:
        period: simulated seconds per tick.
        before_sleep: called before each wait that takes time.

    Attributes:
        while_waiting: called repeatedly during long waits, which occur if simulated time runs slowly; the wait ends if
            it returns False.
        speed: simulated seconds per wall-clock second; ``inf`` for as fast as possible, at least `SLOWEST`.
        lost: wall-clock seconds dropped since the last report.
    """

    def __init__(self, period: float, speed: float, before_sleep: Callable[[], None] = _nothing) -> None:
        self.period = period
        self.speed = max(speed, SLOWEST)
        self.while_waiting: Callable[[], bool] = _go_on
        self._before_sleep = before_sleep
        self.lost = 0.0
        self._due = time.perf_counter()
        self._stopped = False
        self._last_report = -math.inf
        self._window = (time.perf_counter(), 0)
        self._ticks = 0
        self.real_time_factor = 0.0

    def restart(self) -> None:
        """Restart the synchronization after a pause or a change of speed."""
        self._due = time.perf_counter()
        self.lost = 0.0

    def set_speed(self, speed: float) -> None:
        """Change the speed."""
        self.speed = max(speed, SLOWEST)
        self.restart()

    def stop(self) -> None:
        """End every wait; may be called from signal handlers."""
        self._stopped = True

    def start(self) -> None:
        """Allow waits again, after `stop`."""
        self._stopped = False

    def wait(self) -> None:
        """Wait until the next tick is due."""
        self._count()
        if math.isinf(self.speed):
            return
        self._due += self.period / self.speed
        late = time.perf_counter() - self._due
        if late > _GIVE_UP:
            self.lost += late
            self._due += late
        elif late < 0:
            self._sleep()

    def _sleep(self) -> None:
        self._before_sleep()
        while not self._stopped and (remaining := self._due - time.perf_counter()) > 0:
            time.sleep(min(remaining, _NAP))
            if remaining > _NAP and not self.while_waiting():
                return
            # a callback may have changed the speed, so that the next tick is due earlier

    def _count(self) -> None:
        self._ticks += 1
        now = time.perf_counter()
        since, ticks = self._window
        if now - since >= 0.5:
            self.real_time_factor = (self._ticks - ticks) * self.period / (now - since)
            self._window = (now, self._ticks)

    def report_due(self) -> float:
        """Return the lost time in seconds if a warning is due, else 0."""
        now = time.perf_counter()
        since = min(now - self._last_report, _REPORT_EVERY)
        if now - self._last_report < _REPORT_EVERY:
            return 0.0
        self._last_report = now
        delay, self.lost = self.lost, 0.0
        return delay if delay > _WORTH_A_WORD * since else 0.0

    @property
    def keeps_up(self) -> bool:
        """Whether no time was lost since the last report, during at least one reporting interval."""
        return self.lost == 0.0 and time.perf_counter() - self._last_report > _REPORT_EVERY
