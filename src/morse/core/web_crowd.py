"""The connections of a web server, and the time that their messages take."""

from __future__ import annotations

import asyncio
import time
from typing import TYPE_CHECKING

from websockets.asyncio.server import ServerConnection
from websockets.frames import Frame, Opcode

from morse.core.doors.streams import Visitor

if TYPE_CHECKING:
    from collections.abc import Callable

    from websockets.protocol import Event

    from morse.core.doors.streams import StreamGuest

_DATA = (Opcode.TEXT, Opcode.BINARY)

#: share of the time of the network thread for the messages of clients; processor seconds after which a client rests
_SHARE, _TURN = 0.5, 0.005
MOST_WAITING = 4
"""Maximum number of received messages of a client that wait to be processed; then its connection is not read."""


class Connection(Visitor, ServerConnection):
    """A connection to a web server.

    If there are too many, those without a complete request leave first, then those that have not sent a message over a
    WebSocket.
    """

    def process_event(self, event: Event) -> None:
        """See `websockets.asyncio.server.ServerConnection`."""
        super().process_event(event)
        self.guest.stage = 1
        if isinstance(event, Frame) and event.opcode in _DATA:
            self.guest.keeps_place = True


def guest_of(connection: ServerConnection) -> StreamGuest:
    """The guest of a connection of a server with a door."""
    assert isinstance(connection, Connection)
    return connection.guest


_REFUSAL = "The simulation has no place for one more connection. Close others, or try again later.\n"
NO_PLACE = (
    "HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain; charset=utf-8\r\nConnection: close\r\n"
    f"Retry-After: 5\r\nContent-Length: {len(_REFUSAL)}\r\n\r\n{_REFUSAL}"
).encode()
"""What a client gets for whose connection there is no place."""


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
