"""The file descriptors of the process, and how many of them its clients may use."""

from __future__ import annotations

import contextlib
import os
import threading
import time

#: maximum number of connections; on Windows, `select` takes 512 sockets
_MOST = 1 << 14 if os.name == "posix" else 384
#: part of the limit that the process keeps for recordings, files and reloads, and the bounds of this reserve
_PART, _LEAST_RESERVE, _LARGEST_RESERVE = 4, 16, 128
#: wall-clock seconds for which a measurement is valid
_LASTING = 0.25
#: where the system lists the descriptors of a process
_LISTS = ("/proc/self/fd", "/dev/fd")


class Descriptors:
    """Divides the descriptors between the connections of clients and everything else.

    The limit applies to the process, so that all servers of all its simulations share one budget. Any thread may use
    it.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._clients = 0
        self._allowed = 0
        self._until = 0.0

    def has_room(self, *, measure: bool = False) -> bool:
        """Whether one more connection may be opened.

        Args:
            measure: whether to count the descriptors now, not only four times per second.
        """
        with self._lock:
            now = time.monotonic()
            if measure or now >= self._until:
                self._until = now + _LASTING
                self._allowed = self._measured()
            return self._clients < self._allowed

    def enter(self) -> None:
        """Count a connection of a client."""
        with self._lock:
            self._clients += 1

    def leave(self) -> None:
        """A connection of a client has ended."""
        with self._lock:
            self._clients -= 1

    def _measured(self) -> int:
        """The number of connections that clients may have."""
        limit, in_use = _limit(), _in_use()
        if limit is None or in_use is None:
            return _MOST
        free = max(0, limit - max(0, in_use - self._clients))
        reserve = min(_LARGEST_RESERVE, max(_LEAST_RESERVE, limit // _PART))
        # a scene with many ports leaves less than the reserve: then its clients get half of the rest
        return min(_MOST, max(free - reserve, free // 2))


def _limit() -> int | None:
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource  # not available on Windows, which has no such limit

        soft, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
        return None if soft == resource.RLIM_INFINITY else soft
    return None


def _in_use() -> int | None:
    for folder in _LISTS:
        try:
            return len(os.listdir(folder)) - 1  # without that of the list itself
        except OSError:
            continue
    try:
        # the list needs a descriptor: there is none
        number = os.dup(0)
    except OSError:
        return _limit()
    os.close(number)
    return None


DESCRIPTORS = Descriptors()
"""Those of this process."""
