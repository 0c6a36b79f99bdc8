"""The connections of a web server."""

from __future__ import annotations

from typing import TYPE_CHECKING

from websockets.asyncio.server import ServerConnection
from websockets.frames import Frame, Opcode

from morse.core.clients.acceptors.streams import AcceptedProtocol

if TYPE_CHECKING:
    from websockets.protocol import Event

    from morse.core.clients.acceptors.streams import StreamConnection

_DATA = (Opcode.TEXT, Opcode.BINARY)

MOST_WAITING = 4
"""Maximum number of received messages of a client that wait to be processed; then its connection is not read."""


class Connection(AcceptedProtocol, ServerConnection):
    """A connection to a web server.

    If there are too many, those without a complete request leave first, then those that have not sent a message over a
    WebSocket.
    """

    def process_event(self, event: Event) -> None:
        """See `websockets.asyncio.server.ServerConnection`."""
        super().process_event(event)
        self.place.stage = 1
        if isinstance(event, Frame) and event.opcode in _DATA:
            self.place.keeps_place = True


def place_of(connection: ServerConnection) -> StreamConnection:
    """The entry of a connection in the acceptor of its server."""
    assert isinstance(connection, Connection)
    return connection.place


_REFUSAL = "The simulation has no place for one more connection. Close others, or try again later.\n"
NO_PLACE = (
    "HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain; charset=utf-8\r\nConnection: close\r\n"
    f"Retry-After: 5\r\nContent-Length: {len(_REFUSAL)}\r\n\r\n{_REFUSAL}"
).encode()
"""What a client gets for whose connection there is no place."""
