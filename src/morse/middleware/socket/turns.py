"""The scheduling of requests."""

from __future__ import annotations

import heapq
import itertools
import threading
from collections import deque
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from collections.abc import Iterable

_Client = TypeVar("_Client")
_Request = TypeVar("_Request")

#: seconds: clients whose used times differ by less are served in the order of their requests
_GRAIN = 0.005


class Turns(Generic[_Client, _Request]):
    """The queue of requests. The client that has used the least time is served next.

    Among clients with about the same used time, the request that arrived first is served next, so that clients with
    cheap requests are served in the order of arrival. A new client starts with the used time of the client that was
    served last.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._numbers = itertools.count()
        self._waiting: dict[_Client, deque[tuple[int, _Request]]] = {}
        self._last_turns: dict[_Client, float] = {}
        self._order: list[tuple[int, int, _Client]] = []
        self._now = 0.0
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def extend(self, requests: Iterable[tuple[_Client, _Request]]) -> None:
        """Add received requests."""
        with self._lock:
            for client, line in requests:
                number = next(self._numbers)
                queue = self._waiting.get(client)
                if queue is None:
                    queue = self._waiting[client] = deque()
                    self._last_turns[client] = max(self._last_turns.get(client, 0.0), self._now)
                    heapq.heappush(self._order, (int(self._last_turns[client] / _GRAIN), number, client))
                queue.append((number, line))
                self._count += 1

    def next(self) -> tuple[_Client, _Request] | None:
        """The next request, or None; must be followed by `served`."""
        with self._lock:
            while self._order:
                _, _, client = heapq.heappop(self._order)
                queue = self._waiting.get(client)
                if queue:
                    self._count -= 1
                    self._now = max(self._now, self._last_turns[client])
                    return client, queue.popleft()[1]
            return None

    def served(self, client: _Client, seconds: float) -> None:
        """Account for the time of a request of that client."""
        with self._lock:
            queue = self._waiting.get(client)
            if queue is None:
                return
            self._last_turns[client] += seconds
            if queue:
                heapq.heappush(self._order, (int(self._last_turns[client] / _GRAIN), queue[0][0], client))
            else:
                del self._waiting[client]
                if self._last_turns[client] <= self._now:
                    del self._last_turns[client]

    def forget(self, client: _Client, *, with_requests: bool) -> int:
        """Remove a disconnected client; returns the number of its dropped requests."""
        with self._lock:
            losses = 0
            if with_requests:
                losses = len(self._waiting.pop(client, ()))
                self._count -= losses
            if client not in self._waiting:
                self._last_turns.pop(client, None)
            return losses
