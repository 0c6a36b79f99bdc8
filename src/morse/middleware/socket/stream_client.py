"""The connections of clients to data streams; all functions run in the network thread."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from morse.wire.lines import MAX_LINE, Inbox, LineClient, beginning
from morse.wire.server import LineServer

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from morse.core.clients.network import Network
    from morse.middleware.socket.frames import FrameChannel
    from morse.wire.connection import Connection

#: approximate size to which messages are combined
_HIGH_WATER = 1 << 18
#: the line by which a client of a sensor asks for marks: ``together NAME``; all its connections use the same name
_TOGETHER = re.compile(rb"together ([0-9a-f]{1,32})\r?\n")
_LONGEST_REQUEST = 48
#: separates a message from its mark; JSON does not contain it
_MARK = b"\x1e"
#: messages of more bytes take long on the way, so that others do not wait for them
_SMALL = 1 << 16


class _Line(bytes):
    """A message.

    Attributes:
        client: address and port of its sender.
    """

    client: str

    def __new__(cls, line: bytes, client: str) -> _Line:
        one = super().__new__(cls, line)
        one.client = client
        return one


class StreamClient(LineClient):
    """A client of a stream.

    A client that reads too slowly receives the latest message when it can, not all messages.

    Attributes:
        sent: number of messages passed to the connection.
        program: name of the program that has asked for marks; empty: it has not.
    """

    server: StreamServer
    program = b""

    def __init__(self, server: StreamServer) -> None:
        super().__init__(server)
        self._waiting: bytes | None = None
        self._behind = False
        self._welcome_time = server.present()
        self.sent = 0
        self._request: bytes | None = b""

    def connection_made(self, transport: Connection, peer: str) -> None:
        """A client has connected."""
        super().connection_made(transport, peer)
        transport.high_water = self.server.limits.high_water()
        self.server.readers.add(self)
        if self.server.reads and self.server.connected > 1:
            self._complain("several", f"has {self.server.connected} clients: the last one that writes wins")

    def importance(self) -> tuple[float, ...]:
        """Listeners send nothing: those that do not read leave first, then the newest."""
        return super().importance() if self.server.reads else (not self.congested, -self.heard)

    def offer(self, parcels: Sequence[tuple[bytes, int]], last: bytes) -> None:
        """Send messages now; if the client is slow, only the last message, as soon as possible.

        Args:
            parcels: bytes, and the number of messages in them.
            last: the last message.
        """
        misses = -1  # the last message is not missed: it is queued
        for data, count in parcels:
            if self.congested:
                misses += count
            else:
                self.transport.write(data)
                self.sent += count
        if misses >= 0:
            if (self._waiting is not None or misses) and not self._behind:
                self._behind = True
                self._complain("slow", f"the client {self.peer} reads too slowly, it misses messages")
            self._waiting = last

    def resume_writing(self) -> None:
        """The client has caught up."""
        super().resume_writing()
        message, self._waiting = self._waiting, None
        if message is not None and not self.transport.is_closing():
            self.transport.write(message)
            self.sent += 1

    def data_received(self, data: bytes) -> None:
        """Bytes have arrived; a sensor stream ignores them."""
        if self.server.reads:
            super().data_received(data)
        elif self.is_welcome(data) and self._request is not None:
            self._request += data[:_LONGEST_REQUEST]
            if b"\n" in self._request or len(self._request) >= _LONGEST_REQUEST:
                found = _TOGETHER.match(self._request)
                self.program, self._request = found[1] if found else b"", None

    def line(self, line: bytes) -> None:
        """A message has arrived."""
        if line.strip():
            self.is_proven = self.is_proven or line.lstrip().startswith(b"{")
            self.server.inbox.put(_Line(line, self.peer), early=self._is_new())

    def lines(self, lines: list[bytes]) -> None:
        """Several messages have arrived at once."""
        self.is_proven = self.is_proven or any(line.lstrip().startswith(b"{") for line in lines)
        self.server.inbox.put_all([_Line(line, self.peer) for line in lines if line.strip()], early=self._is_new())

    def _is_new(self) -> bool:
        return self._welcome_time is not None and self._welcome_time == self.server.present()

    def unfinished(self, rest: bytes) -> None:
        """The client disconnected in the middle of a message."""
        text = f"the client {self.peer} left in the middle of a message, which is ignored: {beginning(rest)}"
        self._complain("unfinished", text)

    def overlong(self) -> None:
        """A message without a line end."""
        text = f"the client {self.peer} sent more than {MAX_LINE} bytes without a line end: disconnected"
        self._complain("overlong", text)

    def _complain(self, kind: str, text: str) -> None:
        self.server.complaints.warn(kind, f"{self.server.name}: {text}")


def _no_tick() -> None:
    """Without a clock, messages never wait."""


class StreamServer(LineServer):
    """The port of one component.

    Args:
        present: function that returns the present tick, or None while clients determine when ticks happen.

    Attributes:
        inbox: messages of clients.
        reads: whether the component receives data.
        readers: its clients, and the clients of its binary stream that wait for a message; any thread may test whether
            the set is empty.
        binary: its binary stream, if the component sends data.
    """

    def __init__(self, name: str, listener: socket.socket, present: Callable[[], int | None] = _no_tick) -> None:
        super().__init__(name, listener, lambda _: StreamClient(self), comes_first=True)
        self.present = present
        self.inbox = Inbox()
        self.reads = False
        self.readers: set[object] = set()
        self.binary: FrameChannel | None = None

    def leave(self, client: LineClient) -> None:
        """Remove a disconnected client."""
        super().leave(client)
        self.readers.discard(client)

    async def start(self, network: Network) -> None:
        """Start accepting clients."""
        await super().start(network)
        self.inbox.budget = self.limits.commands

    def publish(self, messages: Sequence[bytes], marks: Mapping[bytes, bytes]) -> None:
        """Send messages to every client.

        Args:
            marks: end of the messages to each program that has asked for marks.
        """
        last = messages[-1]
        parcels = _parcels(messages)
        for client in self.clients:
            mark = marks.get(client.program) if client.program else None
            if mark is None or client.congested:
                client.offer(parcels, last)
            else:
                marked = [message[:-1] + mark for message in messages]
                client.offer(_parcels(marked), last)


def publish_together(messages: Mapping[StreamServer, Sequence[bytes]], number: int) -> None:
    """Send the messages of a tick, or of several, to all clients.

    The messages to a program arrive one after the other on its connections. If it has asked for marks, each of them
    ends with ``number``, and how many have this number, so that the program may wait for the others.
    """
    counts: dict[bytes, int] = {}
    together: dict[bytes, int] = {}
    large: set[StreamServer] = set()
    for server, lines in messages.items():
        if sum(map(len, lines)) > _SMALL:
            large.add(server)
            continue
        for client in server.clients:
            if client.program and not client.congested:
                counts[client.program] = counts.get(client.program, 0) + len(lines)
                together[client.program] = together.get(client.program, 0) + 1
    marks = {program: b"%b%d %d\n" % (_MARK, number, counts[program]) for program, size in together.items() if size > 1}
    for server, lines in messages.items():
        server.publish(lines, {} if server in large else marks)


def _parcels(messages: Sequence[bytes]) -> Sequence[tuple[bytes, int]]:
    """Combine messages as `_pieces` does."""
    return [(messages[0], 1)] if len(messages) == 1 else list(_pieces(messages))


def _pieces(messages: Sequence[bytes]) -> Iterator[tuple[bytes, int]]:
    """Combine messages into a few pieces, with their numbers of messages; each is below the limit for slow clients."""
    piece: list[bytes] = []
    size = 0
    for message in messages:
        if piece and size + len(message) > _HIGH_WATER:
            yield b"".join(piece), len(piece)
            piece, size = [], 0
        piece.append(message)
        size += len(message)
    yield b"".join(piece), len(piece)
