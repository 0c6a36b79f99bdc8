"""The clients of line-based servers, and the lines that wait for the simulation.

Functions of clients run in the network loop, unless stated otherwise.
"""

from __future__ import annotations

import asyncio
import re
import threading
import time
from collections import deque
from typing import TYPE_CHECKING

from morse.core.reports.quoting import escaped

if TYPE_CHECKING:
    from morse.core.clients.budgets import Budget
    from morse.wire.connection import Connection
    from morse.wire.server import LineServer

_WHITE = b" \t\r\n\v\f"
#: number of inspected bytes of the first line: its beginning and its end
_HEAD, _TAIL = 256, 64

_METHODS = (
    b"GET|HEAD|POST|PUT|DELETE|CONNECT|OPTIONS|TRACE|PATCH|PRI|SEARCH|M-SEARCH|PROPFIND|PROPPATCH|MKCOL|COPY|MOVE|"
    b"LOCK|UNLOCK|REPORT|MERGE|NOTIFY|SUBSCRIBE|UNSUBSCRIBE|DESCRIBE|SETUP|PLAY|REGISTER|INVITE"
)
#: patterns that identify a protocol before the line is complete
_HTTP_BEGINS = re.compile(rb"(?:%b)[ \t]+(?:/|\*|[a-z][a-z0-9+.-]*:)" % _METHODS, re.IGNORECASE)
_MAIL_BEGINS = re.compile(
    rb"(?:EHLO|HELO|LHLO)(?:[ \t]|\r?\n)|MAIL FROM:|RCPT TO:|STARTTLS\r?\n|A\d+ (?:CAPABILITY|STARTTLS)", re.IGNORECASE
)
#: a TLS handshake record; and the SSL 2 hello, which offers later versions
_TLS_BEGINS = re.compile(rb"\x16\x03|[\x80-\xff].\x01(?:\x03[\x00-\x04]|\x00\x02)", re.DOTALL)
#: STUN, which browsers send to any address that a page names; on TCP, a length may precede it
_STUN_BEGINS = re.compile(rb"(?:..)?[\x00-\x3f].{3}\x21\x12\xa4\x42", re.DOTALL)
_SSH_BEGINS = re.compile(rb"SSH-\d")
#: the HTTP version at the end of a request, or at the beginning of a response
_VERSION_ENDS = re.compile(rb"(?:^|[ \t])(?:HTTP/\d|(?:RTSP|SIP|ICAP)/\d\.\d)[\d.]*[ \t\r]*$", re.IGNORECASE)
_ANSWER_BEGINS = re.compile(rb"(?:HTTP|RTSP|SIP|ICAP)/\d", re.IGNORECASE)


class FirstLine:
    """Inspects the first line of a connection that is not blank.

    Attributes:
        over: the line is complete and of no other protocol.
    """

    def __init__(self) -> None:
        self.over = False
        self._head = b""
        self._tail = b""

    def stranger(self, data: bytes) -> str | None:
        """The protocol of the client, or None; called for all received bytes of the first line."""
        if not self._head:
            data = data.lstrip(_WHITE)
            if not data:
                return None
        line, end, _ = data.partition(b"\n")
        if len(self._head) < _HEAD:
            self._head += line[:_HEAD]
        self._tail = (self._tail + line[-_TAIL:])[-_TAIL:]
        if stranger_line := _beginning(self._head + end):
            return stranger_line
        if end:
            self.over = True
            return "HTTP" if _VERSION_ENDS.search(self._tail) else None
        return None


def _beginning(head: bytes) -> str | None:
    """The protocol as far as the first bytes of a line determine it."""
    if _TLS_BEGINS.match(head):
        return "TLS"
    if _STUN_BEGINS.match(head):
        return "STUN"
    if _HTTP_BEGINS.match(head) or _ANSWER_BEGINS.match(head):
        return "HTTP"
    if _MAIL_BEGINS.match(head):
        return "mail"
    return "SSH" if _SSH_BEGINS.match(head) else None


MAX_LINE = 1 << 20
"""Maximum bytes of a line. A client that sends more without a line end gets an error and is disconnected."""
#: maximum number of bytes of a line that a message quotes
_SHOWN = 80


class LineClient:
    """One connection: whole lines in, bytes out.

    Attributes:
        peer: address and port of the client.
        heard: time of the last received data (`time.monotonic`), or of the connection.
        is_proven: whether it has sent something valid.
        held: received bytes that are not yet processed.
    """

    def __init__(self, server: LineServer) -> None:
        self.server = server
        self.peer = "?"
        self.transport: Connection
        self.congested = False
        self.gone = asyncio.Event()
        self.heard = time.monotonic()
        self.is_proven = False
        self.held = 0
        self._first_line: FirstLine | None = FirstLine()
        self._partial: list[bytes] = []
        self._size = 0
        self._shut_out = False

    def connection_made(self, transport: Connection, peer: str) -> None:
        """A client has connected."""
        self.transport = transport
        self.peer = peer

    def connection_lost(self, error: OSError | None) -> None:
        """The connection has ended."""
        self.gone.set()
        self.server.leave(self)
        self.release(self._size)
        if self._partial and not self._shut_out:
            self.unfinished(b"".join(self._partial))
        self._partial.clear()

    def eof_received(self) -> bool:
        """Handle the end of the client's data; True keeps the connection for the pending answers."""
        return False

    def is_welcome(self, data: bytes) -> bool:
        """Whether received bytes may be processed. A client that speaks another protocol is disconnected.

        Call this method for all received bytes.
        """
        self.heard = time.monotonic()
        if self._first_line is None:
            return not self._shut_out
        stranger = self._first_line.stranger(data)
        if stranger is not None:
            self._shut_out = True
            self._first_line = None
            text = f"{self.server.name}: {self.peer} is turned away: it speaks {stranger}; nothing of it was used"
            self.server.complaints.warn("stranger", text)
            self.transport.abort()
            return False
        if self._first_line.over:
            self._first_line = None
        return True

    def data_received(self, data: bytes) -> None:
        """Split the received bytes into lines."""
        if not self.is_welcome(data):
            return
        if not self._partial and data.find(b"\n") == len(data) - 1:
            self.line(data[:-1])  # one line, the usual case
            return
        first, *others = data.split(b"\n")
        if others:
            whole = b"".join([*self._partial, first])
            self._partial.clear()
            self.release(self._size)
            self._size = 0
            self.lines([whole, *others[:-1]])
            first = others[-1]
        if not first or self._shut_out:
            return
        self._partial.append(first)
        self._size += len(first)
        if self._size > MAX_LINE:
            self.overlong()
            self._shut_out = True
            self.transport.close()
        else:
            self.hold(len(first))

    # -- bytes held in memory --------------------------------------------------------------

    def hold(self, count: int) -> bool:
        """Account for unprocessed bytes; False if the limit is exceeded and this client is disconnected."""
        limits = self.server.limits
        while not limits.held.take(count):
            greediest: LineClient = limits.greediest()
            if greediest.held <= self.held + count:
                greediest = self
            greediest.give_up()
            if greediest is self:
                return False
        self.held += count
        return True

    def release(self, count: int) -> None:
        """Release bytes that have been processed."""
        count = min(count, self.held)
        self.held -= count
        self.server.limits.held.give(count)

    def give_up(self) -> None:
        """Disconnect a client whose unread data exceed the limit, and discard its data."""
        text = f"{self.server.name}: {self.peer} is disconnected: {self.held} bytes from it are not yet processed"
        self.server.complaints.warn("greedy", text)
        self._partial.clear()
        self._size = 0
        self._shut_out = True
        self.release(self.held)
        self.server.leave(self)
        self.transport.abort()

    # -- events ------------------------------------------------------------------------------

    def pause_writing(self) -> None:
        """The client reads too slowly."""
        self.congested = True

    def resume_writing(self) -> None:
        """The client has caught up."""
        self.congested = False

    def lines(self, lines: list[bytes]) -> None:
        """Several lines have arrived at once, without their line ends."""
        for line in lines:
            if self._shut_out:
                return
            self.line(line)

    def line(self, line: bytes) -> None:
        """A line has arrived, without its line end."""

    def unfinished(self, rest: bytes) -> None:
        """The client disconnected in the middle of a line."""

    def overlong(self) -> None:
        """The client sent more than `MAX_LINE` bytes without a line end; it is about to be disconnected."""

    @property
    def keeps_place(self) -> bool:
        """Whether it does not have to leave for a new client."""
        return self.is_proven

    def importance(self) -> tuple[float, ...]:
        """If there are too many clients, the one with the lowest importance leaves, unless it keeps its place.

        It is the one that has been silent for longest.
        """
        return (self.heard,)

    def dismiss(self) -> None:
        """Disconnect it because another client needs its place."""
        self.server.leave(self)
        self.transport.abort()


def beginning(line: bytes) -> str:
    """The first characters of a line, for a message."""
    return escaped(repr(line[:_SHOWN])[2:-1])


_MAX_LINES = 64
_MAX_BYTES = 1 << 20


class Inbox:
    """Stores the latest messages of a stream until the next tick.

    If a client sends far more messages than a tick can process, the oldest messages are dropped,
    because newer messages supersede them.

    A message that arrives in the tick in which its sender was accepted waits for one more tick, as in 1.4, where a
    connection was accepted in one tick and read in the next.

    Attributes:
        budget: memory shared by all inboxes; a message that exceeds it is dropped.
        arrived: empty while there is nothing to take.
    """

    def __init__(self) -> None:
        self.budget: Budget | None = None
        self.arrived: set[bool] = set()
        self._lock = threading.Lock()
        self._lines: deque[bytes] = deque()
        self._early = 0
        self._bytes = 0
        self._losses = 0

    def __bool__(self) -> bool:
        return bool(self._lines or self._losses)

    def put(self, line: bytes, *, early: bool = False) -> None:
        """Add a message; an ``early`` one, and those after it, wait for one more tick."""
        with self._lock:
            self.arrived.add(True)
            if self.budget is not None and not self.budget.take(len(line)):
                self._losses += 1
                return
            self._lines.append(line)
            self._bytes += len(line)
            self._early += early or self._early > 0
            while len(self._lines) > 1 and (len(self._lines) > _MAX_LINES or self._bytes > _MAX_BYTES):
                self._forget(len(self._lines.popleft()))
                self._losses += 1
                self._early = min(self._early, len(self._lines))

    def put_all(self, lines: list[bytes], *, early: bool = False) -> None:
        """Add messages, oldest first; of a flood, only the last ones are looked at."""
        if len(lines) > _MAX_LINES:
            with self._lock:
                self._losses += len(lines) - _MAX_LINES
        for line in lines[-_MAX_LINES:]:
            self.put(line, early=early)

    def take(self) -> tuple[list[bytes], int]:
        """The messages since the last call, oldest first, and the number of dropped messages."""
        with self._lock:
            lines, losses = [self._lines.popleft() for _ in range(len(self._lines) - self._early)], self._losses
            if not self._early:
                self.arrived.clear()
            self._forget(sum(map(len, lines)))
            self._early = self._losses = 0
        return lines, losses

    def clear(self) -> None:
        """Discard all messages."""
        self.take()
        self.take()

    def _forget(self, count: int) -> None:
        self._bytes -= count
        if self.budget is not None:
            self.budget.give(count)
