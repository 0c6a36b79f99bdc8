"""Warnings about what clients do, which may happen thousands of times a second."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import logging
    from collections.abc import Callable

_PERIOD = 10.0
_MAX_KEYS = 1000


class Complaints:
    """Logs the first warning of a kind at once, and then at most one every ten seconds.

    Args:
        logger: where they go.
        now: a wall clock, s.
    """

    def __init__(self, logger: logging.Logger, now: Callable[[], float] = time.monotonic) -> None:
        self._logger = logger
        self._now = now
        self._last: dict[str, tuple[float, int]] = {}

    def warn(self, kind: str, message: str) -> None:
        """Log ``message``, unless there was one of the same ``kind`` a moment ago."""
        now = self._now()
        last, suppressed = self._last.get(kind, (-_PERIOD, 0))
        if now - last < _PERIOD:
            self._last[kind] = (last, suppressed + 1)
            return
        if len(self._last) >= _MAX_KEYS:
            self._last.clear()
        self._last[kind] = (now, 0)
        self._logger.warning("%s%s", message, f" ({suppressed} more of the kind)" if suppressed else "")
