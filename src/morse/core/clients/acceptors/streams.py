"""Acceptors for the protocols of asyncio."""

from __future__ import annotations

import asyncio
import contextlib
from time import monotonic
from typing import TYPE_CHECKING, Any

from morse.core.clients.acceptors.acceptor import Acceptor

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable, Iterable

    from morse.core.clients.complaints import Complaints


class StreamConnection:
    """A connection with a transport of asyncio.

    Attributes:
        stage: how far it has come; of those that may have to leave, the lowest leaves first, then the oldest.
        keeps_place: see `morse.core.clients.acceptors.ClientConnection`.
    """

    def __init__(self, acceptor: Acceptor) -> None:
        self._acceptor = acceptor
        self._transport: Any = None
        self._since = monotonic()
        self._is_dismissed = False
        self.stage = 0
        self.keeps_place = False

    def importance(self) -> tuple[float, ...]:
        """See `morse.core.clients.acceptors.ClientConnection`."""
        return (self.stage, self._since)

    def give_way(self) -> None:
        """Let it be the first to leave if there are too many."""
        self.stage, self.keeps_place = 0, False

    def begin(self, transport: Any) -> None:
        """The connection has a transport."""
        self._transport = transport
        if self._is_dismissed:
            transport.abort()

    def dismiss(self) -> None:
        """See `morse.core.clients.acceptors.ClientConnection`."""
        self._is_dismissed = True
        self._acceptor.leave(self)
        if self._transport is not None:
            self._transport.abort()

    def end(self) -> None:
        """The connection is closed."""
        self._acceptor.leave(self)


class AcceptedProtocol(asyncio.Protocol):
    """A base of protocols whose connections come through a `StreamAcceptor`.

    Attributes:
        place: the connection; set before `connection_made`.
    """

    place: StreamConnection

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """See `asyncio.Protocol`."""
        self.place.begin(transport)
        super().connection_made(transport)

    def connection_lost(self, exc: Exception | None) -> None:
        """See `asyncio.Protocol`."""
        self.place.end()
        super().connection_lost(exc)


class StreamAcceptor(Acceptor):
    """Accepts connections for protocols of asyncio.

    Args:
        name, most, complaints, refusal: see `morse.core.clients.acceptors.Acceptor`.
    """

    def __init__(self, name: str, *, most: int, complaints: Complaints, refusal: bytes = b"") -> None:
        super().__init__(name, self._accepted, most=most, complaints=complaints, refusal=refusal)
        self._factory: Callable[[], Any]
        self._joining: set[asyncio.Task[None]] = set()

    def serve(self, listeners: Iterable[socket.socket], factory: Callable[[], object]) -> AcceptorServer:
        """Start accepting in the running loop.

        Args:
            listeners: bound sockets.
            factory: makes the protocol of a connection, a `AcceptedProtocol`.
        """
        self._factory = factory
        loop = asyncio.get_running_loop()
        for listener in listeners:
            self.open(listener, loop)
        return AcceptorServer(self, loop)

    def _accepted(self, sock: socket.socket, _: object) -> None:
        place = StreamConnection(self)
        self.join(place)
        task = asyncio.get_running_loop().create_task(self._join(sock, place))
        self._joining.add(task)
        task.add_done_callback(self._joining.discard)

    async def _join(self, sock: socket.socket, place: StreamConnection) -> None:
        def protocol() -> Any:
            protocol = self._factory()
            protocol.place = place
            return protocol

        try:
            await asyncio.get_running_loop().connect_accepted_socket(protocol, sock)
        except OSError:  # the client has left
            place.end()
            with contextlib.suppress(OSError):
                sock.close()


class AcceptorServer(asyncio.AbstractServer):
    """A server in the form of asyncio, whose connections come through an acceptor."""

    def __init__(self, acceptor: StreamAcceptor, loop: asyncio.AbstractEventLoop) -> None:
        self._acceptor, self._loop = acceptor, loop
        self._is_serving = True

    @property
    def sockets(self) -> tuple[socket.socket, ...]:
        """The sockets that listen."""
        return tuple(self._acceptor.listeners)

    def close(self) -> None:
        """Stop accepting."""
        self._is_serving = False
        self._acceptor.close()

    def is_serving(self) -> bool:
        """Whether it accepts connections."""
        return self._is_serving

    def get_loop(self) -> asyncio.AbstractEventLoop:
        """The event loop."""
        return self._loop

    async def start_serving(self) -> None:
        """Nothing is left to do: `StreamAcceptor.serve` has started it."""

    async def serve_forever(self) -> None:
        """Nothing is left to do: the loop of the simulation runs until its end."""

    async def wait_closed(self) -> None:
        """Nothing is awaited: the owner of a connection awaits its end."""
