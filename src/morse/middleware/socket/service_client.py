"""The connections of clients that call services; everything here runs in the network thread."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.middleware.socket.lines import MAX_LINE, LineClient, LineServer
from morse.middleware.socket.protocol import format_failure

if TYPE_CHECKING:
    from collections.abc import Callable

MAX_UNREAD = 16 << 20
"""Bytes of replies that a client leaves unread before it is disconnected."""
_MAX_WAITING = 1024
_RESUME_BELOW = 256


class ServiceClient(LineClient):
    """A client that calls services.

    A client that sends requests faster than the simulation answers them is not read from until
    the simulation has caught up.

    Args:
        arrived: called with the client and each of its lines.
    """

    def __init__(self, server: LineServer, arrived: Callable[[ServiceClient, bytes], None]) -> None:
        super().__init__(server)
        self._arrived = arrived
        self._waiting = 0
        self._held = self._leaving = False

    def line(self, line: bytes) -> None:
        """A request has arrived."""
        self._waiting += 1
        if self._waiting > _MAX_WAITING and not self._held:
            self._held = True
            self.transport.pause_reading()
        self._arrived(self, line)

    def eof_received(self) -> bool:
        """The client sends no more; it may still read the answers to what it has sent (as ``nc`` does)."""
        self._leaving = self._waiting > 0
        return self._leaving

    def consumed(self, count: int) -> None:
        """The simulation has taken ``count`` of the requests, and answered what could be answered at once."""
        self._waiting -= count
        if self._leaving and not self._waiting:
            self.transport.close()
        if self._held and self._waiting < _RESUME_BELOW and not self.transport.is_closing():
            self._held = False
            self.transport.resume_reading()

    def reply(self, data: bytes) -> None:
        """Send replies."""
        if self.transport.is_closing():
            return
        if self.transport.get_write_buffer_size() > MAX_UNREAD:
            text = f"the client {self.peer} does not read the replies to its requests: disconnected"
            self.server.complaints.warn("unread", text)
            self.transport.abort()
            return
        self.transport.write(data)

    def overlong(self) -> None:
        """A line without an end: nobody knows where the next request would begin."""
        text = f"the client {self.peer} sent more than {MAX_LINE} bytes without a line end: disconnected"
        self.server.complaints.warn("overlong", text)
        self.transport.write(format_failure("?", f"Malformed request! A line has at most {MAX_LINE} bytes"))

    def unfinished(self, rest: bytes) -> None:
        """The client left in the middle of a request."""
        text = f"the client {self.peer} left in the middle of a request, which is ignored: {rest[:80]!r}"
        self.server.complaints.warn("unfinished", text)
