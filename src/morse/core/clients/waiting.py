"""Queues of what has arrived from outside, and waits for the simulation."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from morse.core.clients.complaints import Complaints

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
