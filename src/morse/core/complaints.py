"""Rate-limited warnings about clients, because a client may repeat a mistake thousands of times per second."""

from __future__ import annotations

import logging
import time
from typing import TYPE_CHECKING

from morse.core.faults import place, summary

if TYPE_CHECKING:
    from collections.abc import Callable

_PERIOD = 10.0
#: number of kinds that are logged per period; the number is limited, because clients can create kinds by the names that
#: they send
_MAX_KINDS = 20


class Complaints:
    """Logs the first warning of a kind immediately, and then at most one every ten seconds.

    All kinds together have at most 20 lines in ten seconds. Suppressed warnings are counted.

    Args:
        logger: receives the warnings.
        now: function that returns wall-clock time, s.
    """

    def __init__(self, logger: logging.Logger, now: Callable[[], float] = time.monotonic) -> None:
        self._logger = logger
        self._now = now
        #: kind to the time of its last line, and the number of warnings suppressed since then
        self._last: dict[str, tuple[float, int]] = {}
        self._others = 0

    def warn(self, kind: str, message: str) -> None:
        """Log ``message``, unless a message of the same ``kind`` was logged in the last ten seconds."""
        self.log(logging.WARNING, kind, message)

    def log(self, level: int, kind: str, message: str) -> None:
        """Log ``message`` at ``level``, with the same limits as `warn`."""
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
        remark = f" ({counted} more of this kind)" if counted else ""
        if self._others:
            remark += f" ({self._others} warnings of other kinds were suppressed)"
            self._others = 0
        self._logger.log(level, "%s%s", message, remark)

    def service_failed(self, name: str, error: Exception) -> str:
        """Log the exception of a service, with the line that raised it.

        Args:
            name: of the service, for the log and as the kind of the message.
            error: as it was caught.

        Returns:
            The type and the message of the exception, for the client.
        """
        what = summary(error)
        self.log(logging.ERROR, name, f"{name} failed: {what}\n{place(error)}")
        return what

    def _forget(self, now: float) -> bool:
        """Free entries for new kinds; return False if all kinds belong to the present period."""
        old = [kind for kind, (when, _) in self._last.items() if now - when >= _PERIOD]
        for kind in old:
            self._others += self._last.pop(kind)[1]
        return bool(old)
