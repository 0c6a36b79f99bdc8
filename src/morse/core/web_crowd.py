"""Limits the connections of a web server, and the time that their messages take."""

from __future__ import annotations

import asyncio
import time
from typing import TYPE_CHECKING, Any

from websockets.asyncio.server import ServerConnection
from websockets.protocol import State

if TYPE_CHECKING:
    from collections.abc import Callable

#: share of the time of the network thread for the messages of clients; processor seconds after which a client rests
_SHARE, _TURN = 0.5, 0.005
MOST_WAITING = 4
"""Maximum number of received messages of a client that wait to be processed; then its connection is not read."""


class Crowd:
    """The connections of a server, also those that have not sent a request.

    If there are too many, the oldest connection without a complete request is closed, then the oldest one that has not
    opened a WebSocket; if all are open, the new one.

    Args:
        most: maximum number of connections.
        full: called with the reason if a connection is closed.
    """

    def __init__(self, most: int, full: Callable[[str], object]) -> None:
        self._most, self._full = most, full
        self._members: dict[Connection, None] = {}

    def __len__(self) -> int:
        return len(self._members)

    def connection(self, *args: Any, **options: Any) -> Connection:
        """The factory for ``websockets.asyncio.server.serve(create_connection=...)``."""
        return Connection(self, *args, **options)

    def enter(self, connection: Connection) -> None:
        """Add a connection, and close one if there are too many."""
        self._members[connection] = None
        if len(self._members) > self._most:
            leaving = self._least_missed() or connection
            self._full(f"a connection is closed: there are more than {self._most}")
            self.leave(leaving)
            leaving.transport.abort()

    def leave(self, connection: Connection) -> None:
        """Remove a connection that has ended."""
        self._members.pop(connection, None)

    def _least_missed(self) -> Connection | None:
        silent = (one for one in self._members if one.request is None)
        unfinished = (one for one in self._members if one.protocol.state is State.CONNECTING)
        return next(silent, None) or next(unfinished, None)


class Connection(ServerConnection):
    """A connection that belongs to a `Crowd`."""

    def __init__(self, crowd: Crowd, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self._crowd = crowd

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """See `asyncio.Protocol`."""
        super().connection_made(transport)
        self._crowd.enter(self)

    def connection_lost(self, exc: Exception | None) -> None:
        """See `asyncio.Protocol`."""
        self._crowd.leave(self)
        super().connection_lost(exc)


class Pace:
    """Divides the time of the network thread: the messages of all clients of a server get half of it.

    The thread also sends the data of the sensors, and Python runs it in turns with the ticks.

    Args:
        now: processor time of the thread, s.
    """

    def __init__(self, now: Callable[[], float] = time.thread_time) -> None:
        self.now = now
        self._resting = 0

    async def rest(self, spent: float) -> float:
        """Let a client rest that has spent some time.

        Args:
            spent: processor time of its messages since it last rested, s.

        Returns:
            The time that it has spent since it last rested.
        """
        if spent < _TURN:
            return spent
        self._resting += 1
        try:
            await asyncio.sleep(spent * (1.0 / _SHARE - 1.0) * self._resting)
        finally:
            self._resting -= 1
        return 0.0
