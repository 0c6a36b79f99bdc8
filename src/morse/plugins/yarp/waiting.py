"""Bottles that wait for the simulation."""

from __future__ import annotations

import threading
from collections import deque
from typing import TYPE_CHECKING, Generic, TypeVar

from morse.core.clients.budget import ENTRY, PARSED, Budget

if TYPE_CHECKING:
    from morse.core.clients.complaints import Complaints

_T = TypeVar("_T")


class WaitingBottles(Generic[_T]):
    """A queue that drops the oldest bottles if there are too many, or if their values take too much memory.

    Args:
        most: maximum number of bottles.
        complaints: logs and counts the losses; None without a log.
        what: name of the bottles in the log.
    """

    def __init__(self, most: int, complaints: Complaints | None = None, what: str = "bottles") -> None:
        self._most, self._memory = most, Budget()
        self._complaints = complaints
        self._text = f"{what} arrive faster than they are read: the oldest are lost"
        self._lock = threading.Lock()
        self._queue: deque[tuple[_T, int]] = deque()

    def __len__(self) -> int:
        return len(self._queue)

    def append(self, bottle: _T, count: int) -> None:
        """Add a bottle.

        Args:
            bottle: its values.
            count: number of bytes from which they were read.
        """
        size = PARSED * count + ENTRY
        with self._lock:
            while self._queue and (len(self._queue) >= self._most or size > self._memory.left):
                self._memory.give(self._queue.popleft()[1])
                if self._complaints is not None:
                    self._complaints.warn(self._text, self._text)
            self._memory.force(size)
            self._queue.append((bottle, size))

    def popleft(self) -> _T:
        """Remove the oldest bottle, and return it.

        Raises:
            IndexError: there is none.
        """
        with self._lock:
            bottle, size = self._queue.popleft()
            self._memory.give(size)
            return bottle
