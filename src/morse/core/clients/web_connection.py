"""A WebSocket connection whose bytes are processed within the share of the time for what clients send.

The library of WebSockets answers pings itself and collects fragments: neither becomes a message. Therefore the time is
measured where bytes arrive. It also copies the body of an HTTP response for each client: files are sent piece by piece
instead, and clients that do not read them take no memory.
"""

from __future__ import annotations

from functools import partial
from time import perf_counter
from typing import TYPE_CHECKING, Any

from websockets.asyncio.server import ServerConnection, serve
from websockets.frames import Frame, Opcode
from websockets.http11 import Response
from websockets.protocol import State

from morse.core.clients.acceptors import AcceptedProtocol

if TYPE_CHECKING:
    import asyncio
    from collections.abc import Awaitable, Callable, Iterable

    from websockets.asyncio.server import Server
    from websockets.protocol import Event

    from morse.core.clients.acceptors import StreamAcceptor, StreamConnection
    from morse.core.clients.budgets import Arrivals, Sender


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


#: processor time of the answer to a request or a handshake, s
_HANDSHAKE = 1e-3
#: bytes that are processed at once: the time of some hundred pings
_PIECE = 1 << 12
#: wall-clock seconds after which others run, also if the client need not rest
_TURN = 0.002
#: unsent bytes of answers to pings; a client that does not read them is not read, either
_MOST_UNSENT = 1 << 16
#: wall-clock seconds between two checks whether it has read them
_LOOK = 0.05
#: bytes of a file that are passed on at once, if the client has read the former ones
_FILE_PIECE = 1 << 16


class FileResponse(Response):
    """A response whose body, `body`, all clients share."""

    def serialize(self) -> bytes:
        """The head only; a `PacedConnection` sends the body."""
        body, self.body = self.body, b""
        try:
            return super().serialize()
        finally:
            self.body = body


class _Valve:
    """A transport that does not read while the queue of messages is full, or while the client rests."""

    def __init__(self, transport: asyncio.Transport, owner: PacedConnection) -> None:
        self._transport, self._owner = transport, owner
        self.is_full = False

    def __getattr__(self, name: str) -> Any:
        return getattr(self._transport, name)

    def write_eof(self) -> None:
        response = self._owner.response
        self._owner.send_file(response.body if isinstance(response, FileResponse) else b"")

    def close(self) -> None:
        if not self._owner.sends_file:
            self._transport.close()

    def pause_reading(self) -> None:
        self.is_full = True
        self._transport.pause_reading()

    def resume_reading(self) -> None:
        self.is_full = False
        self._owner.go_on()


class PacedConnection(Connection):
    """Processes received bytes piece by piece; a client that sends too much rests in between.

    Args:
        arrivals: the share.
    """

    _valve: _Valve

    def __init__(self, arrivals: Arrivals, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self.sender = arrivals.sender()
        self._newcomers = arrivals.newcomers
        self._unprocessed = bytearray()
        self._file = memoryview(b"")
        self._answers = 0
        self._has_ended = self._is_busy = self._is_deaf = False
        self._resting: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """See `asyncio.Protocol`."""
        self._valve = _Valve(transport, self)  # type: ignore[arg-type] # that of a connection
        super().connection_made(self._valve)  # type: ignore[arg-type] # it has the methods of a transport

    def data_received(self, data: bytes) -> None:
        """See `asyncio.Protocol`."""
        self._unprocessed += data
        self.go_on()

    def eof_received(self) -> None:
        """See `asyncio.Protocol`; the bytes before the end are processed first."""
        self._has_ended = True
        if self._unprocessed:
            return True  # type: ignore[return-value] # keeps the connection open
        super().eof_received()
        return True if self._file else None  # type: ignore[return-value]

    def connection_lost(self, exc: Exception | None) -> None:
        """See `asyncio.Protocol`."""
        self._unprocessed.clear()
        self._file = memoryview(b"")
        if self._resting is not None:
            self._resting.cancel()
        super().connection_lost(exc)

    async def close(self, *reason: Any) -> None:
        """See `websockets.asyncio.connection.Connection`.

        What the client still sends is discarded: a full queue would hide that the client has left.
        """
        self._is_deaf = True
        self.place.give_way()
        self._valve.resume_reading()
        await super().close(*reason)

    def process_event(self, event: Event) -> None:
        """See `websockets.asyncio.server.ServerConnection`."""
        if not self._is_deaf:
            super().process_event(event)

    def go_on(self) -> None:
        """Process the bytes that have arrived, until the client has to rest or the queue is full."""
        if self._is_busy or self._resting is not None:
            return
        if self.protocol.state is State.CONNECTING and self._unprocessed and self._must_wait():
            return
        self._is_busy = True
        end = perf_counter() + _TURN
        try:
            while self._unprocessed and not self._valve.is_full and self._resting is None:
                self._process()
                if self._unprocessed and self._resting is None and perf_counter() > end:
                    self._rest(0.0)  # let others run
        finally:
            self._is_busy = False
        if self._resting is not None or self._unprocessed:
            self._valve._transport.pause_reading()
        elif self._has_ended:
            super().eof_received()
            self._valve.close()
        elif not self._valve.is_full:
            self._valve._transport.resume_reading()

    @property
    def sends_file(self) -> bool:
        """Whether a part of a file is not sent."""
        return bool(self._file)

    def send_file(self, content: bytes | bytearray) -> None:
        """Send a file, and the end of the data."""
        self._file = memoryview(content)
        self._send_more()

    def resume_writing(self) -> None:
        """See `asyncio.Protocol`."""
        super().resume_writing()
        if self._file:
            self._send_more()

    def _send_more(self) -> None:
        transport = self._valve._transport
        while self._file and not self.paused and not transport.is_closing():
            piece, self._file = self._file[:_FILE_PIECE], self._file[_FILE_PIECE:]
            transport.write(piece)
        if not self._file and not transport.is_closing():
            transport.write_eof()
            if self._has_ended:
                transport.close()

    def _must_wait(self) -> bool:
        """Whether those who connect have used their time; the connection is processed later."""
        if self._newcomers.rests:
            self._rest(self._newcomers.remaining)
            self._valve._transport.pause_reading()
            return True
        self._newcomers.spend(_HANDSHAKE)
        self._newcomers.rest_if_due()
        return False

    def _process(self) -> None:
        piece = bytes(self._unprocessed[:_PIECE])
        del self._unprocessed[:_PIECE]
        unsent = self._valve.get_write_buffer_size()
        account = self._newcomers if self.protocol.state is State.CONNECTING else self.sender
        with account.measured():
            super().data_received(piece)
        growth = self._valve.get_write_buffer_size() - unsent
        self._answers = self._answers + max(0, growth) if unsent or growth > 0 else 0
        if self.sender.must_rest:
            self._rest(self.sender.begin_rest())
        elif self._answers > _MOST_UNSENT:
            self._rest(_LOOK)

    def _rest(self, duration: float) -> None:
        self._resting = self.loop.call_later(duration, self._end_rest)

    def _end_rest(self) -> None:
        self._resting = None
        if self._valve.get_write_buffer_size() == 0:
            self._answers = 0
        elif self._answers > _MOST_UNSENT:
            self._rest(_LOOK)
            return
        self.go_on()


def sender_of(connection: ServerConnection) -> Sender:
    """The account of the client of a `PacedConnection`."""
    assert isinstance(connection, PacedConnection)
    return connection.sender


async def serve_on(
    handler: Callable[[ServerConnection], Awaitable[None]],
    host: str,
    ports: Iterable[int],
    arrivals: Arrivals,
    acceptor: StreamAcceptor,
    **options: Any,
) -> tuple[Server, int]:
    """Open a web server; what its clients send is processed within their share of the time.

    Args:
        options: see `websockets.asyncio.server.serve`.

    Returns:
        The server, and its port.

    Raises:
        OSError: no port is free.
    """
    failure = OSError("no port was given")
    for port in ports:
        try:
            server = await serve(
                handler,
                host,
                port,
                create_connection=partial(PacedConnection, arrivals),  # type: ignore[arg-type] # a factory is sufficient
                acceptor=acceptor,
                compression=None,
                max_queue=MOST_WAITING,
                **options,
            )
        except OSError as error:
            failure = error
            continue
        return server, int(next(iter(server.sockets)).getsockname()[1])
    raise failure
