"""Rate-limited warnings about clients, because a client may repeat a mistake thousands of times per second."""

from __future__ import annotations

import logging
import threading
import time
from collections import deque
from typing import TYPE_CHECKING, TypeVar

from morse.core.reports.faults import place, summary
from morse.core.reports.log import PERIOD as _PERIOD
from morse.core.reports.log import TELLER

if TYPE_CHECKING:
    from collections.abc import Callable


#: number of kinds that are logged per period; the number is limited, because clients can create kinds by the names that
#: they send
_MAX_KINDS = 20
#: number of lines of a kind that begins anew, in a period
_MOST_BEGINNINGS = 10


class Complaints:
    """Logs the first warning of a kind immediately, and then at most one every ten seconds.

    What begins anew is logged at once, up to ten times in ten seconds. All kinds together have at most 20 lines in ten
    seconds, and those that begin anew. Suppressed warnings are counted; the number is logged with
    the next warning of the kind, or after ten seconds.

    Args:
        logger: receives the warnings.
        now: function that returns wall-clock time, s.
    """

    def __init__(self, logger: logging.Logger, now: Callable[[], float] = time.monotonic) -> None:
        self._logger = logger
        self._now = now
        self._lock = threading.Lock()
        #: kind to the begin of its period, the number of warnings suppressed since then, the last of them, and the
        #: number of times that the problem began anew
        self._last: dict[str, tuple[float, int, tuple[int, str], int]] = {}
        self._others = 0
        self._others_since = 0.0

    def warn(self, kind: str, message: str, *, begins: bool = False) -> None:
        """Log ``message``, unless a message of the same ``kind`` was logged in the last ten seconds.

        Args:
            begins: whether the problem was over since the last message of the kind: this is then a new one.
        """
        self.log(logging.WARNING, kind, message, begins=begins)

    def log(self, level: int, kind: str, message: str, *, begins: bool = False) -> None:
        """Log ``message`` at ``level``, with the same limits as `warn`."""
        now = self._now()
        with self._lock:
            last = self._last.get(kind)
            if last is not None and now - last[0] < _PERIOD:
                is_told = begins and last[3] < _MOST_BEGINNINGS
                self._last[kind] = (last[0], last[1] + (not is_told), (level, message), last[3] + begins)
                line = message if is_told else None
            elif last is None and len(self._last) >= _MAX_KINDS and not self._forget(now):
                self._others_since = self._others_since if self._others else now
                self._others += 1
                line = None
            else:
                self._last[kind] = (now, 0, (level, message), 0)
                count = last[1] if last is not None else 0
                line = message + (f" ({count} more of this kind)" if count else "")
                if self._others:
                    line += self._counted_others()
        if line is None:
            TELLER.remind(self)
        else:
            self._logger.log(level, "%s", line)

    def tell(self, *, now: bool) -> bool:
        """Log how many warnings were suppressed in the periods that are over; see `folding.Counting`."""
        lines: list[tuple[int, str]] = []
        with self._lock:
            time = self._now()
            for kind, (when, count, (level, message), _) in list(self._last.items()):
                if count and (now or time - when >= _PERIOD):
                    self._last[kind] = (time, 0, (level, message), 0)
                    lines.append((level, f"{message} ({count} more of this kind)"))
            if self._others and (now or time - self._others_since >= _PERIOD):
                lines.append((logging.WARNING, self._counted_others().strip(" ()")))
            has_more = bool(self._others) or any(count for _, count, *_ in self._last.values())
        for level, line in lines:
            self._logger.log(level, "%s", line)
        return has_more

    def _counted_others(self) -> str:
        count, self._others = self._others, 0
        return f" ({count} warnings of other kinds were suppressed)"

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
        old = [kind for kind, (when, *_) in self._last.items() if now - when >= _PERIOD]
        for kind in old:
            self._others += self._last.pop(kind)[1]
        return bool(old)


_T = TypeVar("_T")


class Waiting(deque[_T]):
    """A queue that loses its oldest entry when it is full, and says so; any thread may append.

    Args:
        most: largest number of entries.
        complaints: logs and counts the losses.
        name: of the receiver, in the log.
        what: name of the entries in the plural.
    """

    def __init__(self, most: int, complaints: Complaints, name: str, what: str) -> None:
        super().__init__(maxlen=most)
        self._complaints = complaints
        self._text = f"{name}: {what} arrive faster than they are read: the oldest of more than {most} are lost"

    def append(self, entry: _T, /) -> None:
        """Add an entry at the end."""
        if len(self) == self.maxlen:
            self._complaints.warn(self._text, self._text)
        super().append(entry)
