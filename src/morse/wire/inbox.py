"""Messages from the network thread to the simulation."""

from __future__ import annotations

import threading
from collections import deque
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.core.clients.budgets import Budget

_MAX_LINES = 64
_MAX_BYTES = 1 << 20


class Inbox:
    """Stores the latest messages of a stream until the next tick.

    If a client sends far more messages than a tick can process, the oldest messages are dropped,
    because newer messages supersede them.

    A message that arrives in the tick in which its sender was accepted waits for one more tick, as in 1.4, where a
    connection was accepted in one tick and read in the next.

    Attributes:
        budget: memory shared by all inboxes; a message that exceeds it is dropped.
        arrived: empty while there is nothing to take.
    """

    def __init__(self) -> None:
        self.budget: Budget | None = None
        self.arrived: set[bool] = set()
        self._lock = threading.Lock()
        self._lines: deque[bytes] = deque()
        self._early = 0
        self._bytes = 0
        self._losses = 0

    def __bool__(self) -> bool:
        return bool(self._lines or self._losses)

    def put(self, line: bytes, *, early: bool = False) -> None:
        """Add a message; an ``early`` one, and those after it, wait for one more tick."""
        with self._lock:
            self.arrived.add(True)
            if self.budget is not None and not self.budget.take(len(line)):
                self._losses += 1
                return
            self._lines.append(line)
            self._bytes += len(line)
            self._early += early or self._early > 0
            while len(self._lines) > 1 and (len(self._lines) > _MAX_LINES or self._bytes > _MAX_BYTES):
                self._forget(len(self._lines.popleft()))
                self._losses += 1
                self._early = min(self._early, len(self._lines))

    def put_all(self, lines: list[bytes], *, early: bool = False) -> None:
        """Add messages, oldest first; of a flood, only the last ones are looked at."""
        if len(lines) > _MAX_LINES:
            with self._lock:
                self._losses += len(lines) - _MAX_LINES
        for line in lines[-_MAX_LINES:]:
            self.put(line, early=early)

    def take(self) -> tuple[list[bytes], int]:
        """The messages since the last call, oldest first, and the number of dropped messages."""
        with self._lock:
            lines, losses = [self._lines.popleft() for _ in range(len(self._lines) - self._early)], self._losses
            if not self._early:
                self.arrived.clear()
            self._forget(sum(map(len, lines)))
            self._early = self._losses = 0
        return lines, losses

    def clear(self) -> None:
        """Discard all messages."""
        self.take()
        self.take()

    def _forget(self, count: int) -> None:
        self._bytes -= count
        if self.budget is not None:
            self.budget.give(count)
