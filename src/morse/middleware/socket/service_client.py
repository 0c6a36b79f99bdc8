"""The connections of clients that call services, and their lines; the connections run in the network thread."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from morse.core import status
from morse.core.reports.quoting import short
from morse.wire.encoding import from_json, to_json
from morse.wire.lines import MAX_LINE, LineClient, beginning
from morse.wire.server import MAX_UNSENT

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.values import Value
    from morse.wire.server import LineServer


_LONGEST_ID = 256
_FALSE = frozenset((b"null", b"false", b"0", b"0.0", b"-0.0", b"[]", b"{}", b'""'))


class MalformedRequest(ValueError):
    """A line that is not a request.

    Attributes:
        request: the id of the reply.
    """

    def __init__(self, request: str, message: str) -> None:
        super().__init__(f"Malformed request! {message}")
        self.request = request


class Request(NamedTuple):
    """A service call; ``service`` is None for a cancellation."""

    id: str
    component: str
    service: str | None
    arguments: list[Value]


def parse_request(line: bytes) -> Request | None:
    """Parse a line; None if it is blank.

    Raises:
        MalformedRequest: the line is not a request.
    """
    words = line.decode("utf-8", "replace").split(maxsplit=3)
    if not words:
        return None
    request = words[0]
    if len(request) > _LONGEST_ID:
        raise MalformedRequest(short(request), f"the id of a request has at most {_LONGEST_ID} characters")
    if len(words) == 2 and words[1] == "cancel":
        return Request(request, "", None, [])
    if len(words) < 3:
        raise MalformedRequest(request, "expected: id component service [arguments as a JSON list]")
    arguments: Any = []
    if len(words) == 4:
        try:
            arguments = from_json(words[3].rstrip().encode())
        except ValueError as error:
            raise MalformedRequest(request, f"the arguments are no JSON ({error}): {short(words[3])}") from None
        if not isinstance(arguments, list):
            raise MalformedRequest(request, f"the arguments have to be a JSON list: {short(words[3])}")
    return Request(request, words[1], words[2], arguments)


def format_reply(request: str, outcome: str, value: object) -> bytes:
    """Format a reply, with the line end.

    If the value cannot be encoded, the reply is a failure with the reason.
    """
    if value is None:
        return f"{request} {outcome}\n".encode()
    try:
        text = to_json(value)
    except (TypeError, ValueError) as error:
        outcome, text = status.FAILED, to_json(f"the result cannot be sent: {error}")
    head = f"{request} {outcome}".encode()
    return head + b"\n" if text in _FALSE else b"%b %b\n" % (head, text)


def format_failure(request: str, message: str) -> bytes:
    """Format a reply with an error message."""
    return format_reply(request, status.FAILED, message)


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
