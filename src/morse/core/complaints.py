"""Warnings about what clients do, which may happen thousands of times a second."""

from __future__ import annotations

import logging
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

_PERIOD = 10.0
#: kinds of which each may have a line in a period; clients may choose the kind, by the names that they send
_MAX_KINDS = 20


class Complaints:
    """Logs the first warning of a kind at once, and then at most one every ten seconds.

    All kinds together have at most 20 lines in ten seconds. What is not logged is counted.

    Args:
        logger: where they go.
        now: a wall clock, s.
    """

    def __init__(self, logger: logging.Logger, now: Callable[[], float] = time.monotonic) -> None:
        self._logger = logger
        self._now = now
        #: when a kind was logged, and how often it was not since then
        self._last: dict[str, tuple[float, int]] = {}
        self._others = 0

    def warn(self, kind: str, message: str) -> None:
        """Log ``message``, unless there was one of the same ``kind`` a moment ago."""
        self.log(logging.WARNING, kind, message)

    def log(self, level: int, kind: str, message: str) -> None:
        """The same with a level of the log."""
        now = self._now()
        last = self._last.get(kind)
        if last is not None and now - last[0] < _PERIOD:
            self._last[kind] = (last[0], last[1] + 1)
            return
        if last is None and len(self._last) >= _MAX_KINDS and not self._forget(now):
            self._others += 1
            return
        self._last[kind] = (now, 0)
        counted = last[1] if last is not None else 0
        remark = f" ({counted} more of the kind)" if counted else ""
        if self._others:
            remark += f" ({self._others} complaints of other kinds are left out)"
            self._others = 0
        self._logger.log(level, "%s%s", message, remark)

    def _forget(self, now: float) -> bool:
        """Make room for new kinds; False if all are of the present period."""
        old = [kind for kind, (when, _) in self._last.items() if now - when >= _PERIOD]
        for kind in old:
            self._others += self._last.pop(kind)[1]
        return bool(old)
