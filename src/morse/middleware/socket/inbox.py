"""Messages from the network thread to the simulation."""

from __future__ import annotations

import threading
from collections import deque
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.core.budget import Budget

_MAX_LINES = 64
_MAX_BYTES = 1 << 20


class Inbox:
    """Stores the latest messages of a stream until the next tick.

    If a client sends far more messages than a tick can process, the oldest messages are dropped,
    because newer messages supersede them.

    Attributes:
        budget: memory shared by all inboxes; a message that exceeds it is dropped.
        arrived: empty while there is nothing to take.
    """

    def __init__(self) -> None:
        self.budget: Budget | None = None
        self.arrived: set[bool] = set()
        self._lock = threading.Lock()
        self._lines: deque[bytes] = deque()
        self._bytes = 0
        self._dropped = 0

    def __bool__(self) -> bool:
        return bool(self._lines or self._dropped)

    def put(self, line: bytes) -> None:
        """Add a message."""
        with self._lock:
            self.arrived.add(True)
            if self.budget is not None and not self.budget.take(len(line)):
                self._dropped += 1
                return
            self._lines.append(line)
            self._bytes += len(line)
            while len(self._lines) > 1 and (len(self._lines) > _MAX_LINES or self._bytes > _MAX_BYTES):
                self._forget(len(self._lines.popleft()))
                self._dropped += 1

    def put_all(self, lines: list[bytes]) -> None:
        """Add messages, oldest first; of a flood, only the last ones are looked at."""
        if len(lines) > _MAX_LINES:
            with self._lock:
                self._dropped += len(lines) - _MAX_LINES
        for line in lines[-_MAX_LINES:]:
            self.put(line)

    def take(self) -> tuple[list[bytes], int]:
        """The messages since the last call, oldest first, and the number of dropped messages."""
        with self._lock:
            lines, dropped = list(self._lines), self._dropped
            self.arrived.clear()
            self._lines.clear()
            self._forget(self._bytes)
            self._dropped = 0
        return lines, dropped

    def _forget(self, count: int) -> None:
        self._bytes -= count
        if self.budget is not None:
            self.budget.give(count)
