"""How far a study is."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.many.values import Row


class Progress:
    """Counts runs and failures, and estimates the remaining time.

    Args:
        total: number of runs.
        done: number of runs that were done before.
        failed: number of those that have failed.
    """

    def __init__(self, total: int, done: int, failed: int) -> None:
        self.total, self.done, self.failed = total, done, failed
        self._before, self._begin = done, time.monotonic()

    def add(self, row: Row) -> None:
        """Count a run."""
        self.done += 1
        self.failed += bool(row["error"])

    def remaining(self) -> float | None:
        """Wall-clock time until the end, s; None if it is not known yet."""
        now = self.done - self._before
        if not now:
            return None
        return (self.total - self.done) * (time.monotonic() - self._begin) / now

    def __str__(self) -> str:
        text = f"{self.done:,} of {self.total:,} runs are done, {self.failed:,} failed"
        remaining = self.remaining()
        if remaining is None or self.done == self.total:
            return text
        return f"{text}, {duration(remaining)} left"


def duration(seconds: float) -> str:
    """``2 h 5 min``, ``3 min 20 s``, ``12 s``."""
    whole = round(seconds)
    hours, minutes = whole // 3600, whole // 60 % 60
    if hours:
        return f"{hours} h {minutes} min"
    return f"{minutes} min {whole % 60} s" if minutes else f"{whole} s"
