"""The connections of clients that call services; all functions run in the network thread."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.middleware.socket.protocol import format_failure
from morse.wire.limits import MAX_UNSENT
from morse.wire.lines import MAX_LINE, LineClient, beginning

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.wire.server import LineServer

MAX_UNREAD = 16 << 20
"""Number of unread bytes of replies above which a client is disconnected."""
_MAX_WAITING = 1024
_RESUME_BELOW = 256
#: maximum size of waiting requests, bytes: reading from the client stops until there are fewer
_MANY_BYTES = 1 << 20
#: overhead of a request in addition to its line, bytes
_OVERHEAD = 256


class ServiceClient(LineClient):
    """A client that calls services.

    If a client sends requests faster than the simulation answers them, reading stops until
    the simulation has caught up.

    Args:
        on_line: called with the client and each of its lines.
        left: called when the connection is closed.

    Attributes:
        calls: number of its active calls; any thread may write it.
    """

    def __init__(
        self,
        server: LineServer,
        on_line: Callable[[ServiceClient, bytes], None],
        left: Callable[[ServiceClient, bool], None],
    ) -> None:
        super().__init__(server)
        self._on_line = on_line
        self._left = left
        self._waiting = 0
        self._held_back = self._leaving = False
        self.calls = 0

    def line(self, line: bytes) -> None:
        """A request has arrived."""
        if not self.hold(len(line) + _OVERHEAD):
            return
        # an id, a component and a service
        self.is_proven = self.is_proven or len(line.split(None, 2)) == 3
        self._waiting += 1
        if (self._waiting > _MAX_WAITING or self.held > _MANY_BYTES) and not self._held_back:
            self._held_back = True
            self.transport.pause_reading()
        self._on_line(self, line)

    def eof_received(self) -> bool:
        """The client has closed its sending side; it may still read the pending replies (as ``nc`` does)."""
        self._leaving = self._waiting > 0
        return self._leaving

    def connection_lost(self, error: OSError | None) -> None:
        """Close the connection; by a reset if there is an error."""
        super().connection_lost(error)
        self._left(self, error is not None or self._shut_out)

    def consumed(self, count: int, size: int) -> None:
        """The simulation has processed ``count`` of the requests.

        Args:
            size: bytes of these requests.
        """
        self._waiting -= count
        self.release(size + count * _OVERHEAD)
        if self._leaving and not self._waiting:
            self.transport.close()
        if self._held_back and self._waiting < _RESUME_BELOW and self.held < _MANY_BYTES // 2:
            self._held_back = False
            self.transport.resume_reading()

    def reply(self, data: bytes) -> None:
        """Send replies."""
        if self.transport.is_closing():
            return
        unread = self.transport.get_write_buffer_size()
        if unread > MAX_UNREAD or (unread and self._all_unread() > MAX_UNSENT):
            text = f"the client {self.peer} does not read the replies to its requests: disconnected"
            self.server.complaints.warn("unread", text)
            self.transport.abort()
            return
        self.transport.write(data)

    def _all_unread(self) -> int:
        return sum(client.transport.get_write_buffer_size() for client in self.server.clients)

    def overlong(self) -> None:
        """Disconnect after a line without an end: the start of the next request is unknown."""
        text = f"the client {self.peer} sent more than {MAX_LINE} bytes without a line end: disconnected"
        self.server.complaints.warn("overlong", text)
        self.transport.write(format_failure("?", f"Malformed request! A line has at most {MAX_LINE} bytes"))

    def unfinished(self, rest: bytes) -> None:
        """The client left in the middle of a request."""
        text = f"the client {self.peer} left in the middle of a request, which is ignored: {beginning(rest)}"
        self.server.complaints.warn("unfinished", text)
