"""Counts log lines that repeat, and tells the counts."""

from __future__ import annotations

import atexit
import logging
import re
import threading
import time
from typing import TYPE_CHECKING, Protocol
from weakref import WeakSet

if TYPE_CHECKING:
    from collections.abc import Callable

PERIOD = 10.0
"""Wall-clock time in which equal lines are counted, s."""

#: equal lines in a period that are written, from warnings on and below: a component may log a line in each tick
_MOST_WARNINGS, _MOST_OTHERS = 10, 1000
#: number of different lines that are told apart, and the compared length
_MOST_KINDS, _COMPARED = 256, 200
_NUMBER = re.compile(r"0[xX][0-9a-fA-F]+|\d+(?:\.\d+)?(?:[eE][+-]?\d+)?")
#: wall-clock seconds between two looks at the counts
_LOOK = 1.0


class Counting(Protocol):
    """Something that counts what it does not log."""

    def tell(self, *, now: bool) -> bool:
        """Log the counts whose period is over, or all ``now``; False if none are left."""


class _Teller:
    """Lets the counts be told after their periods, and at the end of the process."""

    def __init__(self) -> None:
        self._counting: WeakSet[Counting] = WeakSet()
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None
        atexit.register(self._tell, now=True)

    def remind(self, counting: Counting) -> None:
        """Call ``counting.tell`` later."""
        with self._lock:
            self._counting.add(counting)
            if self._thread is not None and self._thread.is_alive():
                return
            self._thread = threading.Thread(target=self._look, name="morse-log", daemon=True)
        try:
            self._thread.start()
        except RuntimeError:
            self._thread = None  # no thread can be started: the end of the process tells the counts

    def _look(self) -> None:
        while True:
            time.sleep(_LOOK)
            self._tell(now=False)
            with self._lock:
                if not self._counting:
                    self._thread = None
                    return

    def _tell(self, *, now: bool) -> None:
        with self._lock:
            counting = list(self._counting)
        for one in counting:
            if not one.tell(now=now):
                with self._lock:
                    self._counting.discard(one)


TELLER = _Teller()
"""That of the process."""


class Folding(logging.Filter):
    """Passes the first lines of a kind in a period, counts the others, and logs their number at the end of the period.

    Lines are of one kind if they are equal but for numbers.

    Args:
        handler: writes the lines; this filter is added to it.
        clock: wall-clock time, s.
    """

    def __init__(self, handler: logging.Handler, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__()
        self._handler, self._clock = handler, clock
        self._lock = threading.Lock()
        #: begin of the period, number of lines, and the last line that was not written
        self._kinds: dict[tuple[str, int, str], tuple[float, int, logging.LogRecord | None]] = {}
        handler.addFilter(self)

    def filter(self, record: logging.LogRecord) -> bool:
        """See `logging.Filter`."""
        if getattr(record, "is_count", False):
            return True
        now = self._clock()
        kind = (record.name, record.levelno, _NUMBER.sub("0", _beginning(record)))
        most = _MOST_WARNINGS if record.levelno >= logging.WARNING else _MOST_OTHERS
        with self._lock:
            begin, count, _ = self._kinds.get(kind, (now, 0, None))
            is_over = now - begin >= PERIOD
        if is_over:
            self._tell_kind(kind)
            begin, count = now, 0
        with self._lock:
            if kind not in self._kinds and len(self._kinds) >= _MOST_KINDS:
                self._forget(now)
                if len(self._kinds) >= _MOST_KINDS:
                    kind = (record.name, record.levelno, "")  # they are counted together
                    begin, count, _ = self._kinds.get(kind, (now, 0, None))
            count += 1
            self._kinds[kind] = (begin, count, record if count > most else None)
        if count > most:
            TELLER.remind(self)
            return False
        return True

    def tell(self, *, now: bool) -> bool:
        """See `Counting`."""
        time = self._clock()
        with self._lock:
            kinds = [kind for kind, (begin, _, last) in self._kinds.items() if last and (now or time - begin >= PERIOD)]
        for kind in kinds:
            self._tell_kind(kind)
        with self._lock:
            return any(last is not None for _, _, last in self._kinds.values())

    def _tell_kind(self, kind: tuple[str, int, str]) -> None:
        with self._lock:
            begin, count, last = self._kinds.pop(kind, (0.0, 0, None))
        if last is None:
            return
        most = _MOST_WARNINGS if last.levelno >= logging.WARNING else _MOST_OTHERS
        seconds = max(1, round(self._clock() - begin))
        text = f"{_beginning(last)} (repeated {count - most} times in {seconds} s)"
        record = logging.LogRecord(last.name, last.levelno, last.pathname, last.lineno, text, None, None)
        record.is_count = True
        self._handler.handle(record)

    def _forget(self, now: float) -> None:
        for kind, (begin, _, last) in list(self._kinds.items()):
            if last is None and now - begin >= PERIOD:
                del self._kinds[kind]


def _beginning(record: logging.LogRecord) -> str:
    try:
        text = record.getMessage()
    except Exception:  # the handler reports wrong arguments
        text = str(record.msg)
    return text.partition("\n")[0][:_COMPARED]
