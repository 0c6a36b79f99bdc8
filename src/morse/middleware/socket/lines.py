"""TCP servers for lines; everything here runs in the network thread, except where it says otherwise."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import socket
from typing import TYPE_CHECKING, Any

from morse.middleware.socket.complaints import Complaints

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from morse.core.network import Network
    from morse.middleware.socket.listener import Listener

logger = logging.getLogger("morse." + __name__)

MAX_LINE = 16 << 20
"""Bytes of a line; a client that sends more without a line end is told so and disconnected."""
MAX_CLIENTS = 256
"""Connections to one port."""
_FAREWELL = 1.0
#: a client that says nothing is probed after so many seconds, and again so often; one whose machine has been switched
#: off is given up after that many probes, one that has forgotten the connection answers the first
_SILENCE, _PROBE, _PROBES = 10, 10, 6


def _probe_when_silent(sock: socket.socket) -> None:
    # the word of its end may be lost: it is sent once only
    with contextlib.suppress(OSError):
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        for option, value in (("TCP_KEEPINTVL", _PROBE), ("TCP_KEEPCNT", _PROBES), ("TCP_KEEPIDLE", _SILENCE)):
            if hasattr(socket, option):  # not on every system
                sock.setsockopt(socket.IPPROTO_TCP, getattr(socket, option), value)


class LineClient(asyncio.Protocol):
    """One connection: whole lines in, bytes out.

    Attributes:
        peer: address and port of the client.
    """

    def __init__(self, server: LineServer) -> None:
        self.server = server
        self.peer = "?"
        self.transport: asyncio.Transport
        self.congested = False
        self.gone = asyncio.Event()
        self._partial: list[bytes] = []
        self._size = 0

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """A client has connected."""
        assert isinstance(transport, asyncio.Transport)
        self.transport = transport
        address = transport.get_extra_info("peername")
        if isinstance(address, tuple):
            self.peer = f"{address[0]}:{address[1]}"
        if (sock := transport.get_extra_info("socket")) is not None:
            _probe_when_silent(sock)
        self.server.join(self)

    def connection_lost(self, exc: Exception | None) -> None:
        """The connection has ended."""
        self.gone.set()
        self.server.leave(self)
        if self._partial:
            self.unfinished(b"".join(self._partial))

    def data_received(self, data: bytes) -> None:
        """Cut what arrived into lines."""
        if not self._partial and data.find(b"\n") == len(data) - 1:
            self.line(data[:-1])  # one line, as nearly always
            return
        first, *others = data.split(b"\n")
        if others:
            self.line(b"".join([*self._partial, first]))
            for line in others[:-1]:
                self.line(line)
            self._partial.clear()
            self._size = 0
            first = others[-1]
        if first:
            self._partial.append(first)
            self._size += len(first)
            if self._size > MAX_LINE:
                self._partial.clear()
                self.overlong()
                self.transport.close()

    def pause_writing(self) -> None:
        """The client does not read as fast as it is written to."""
        self.congested = True

    def resume_writing(self) -> None:
        """The client has caught up."""
        self.congested = False

    def line(self, line: bytes) -> None:
        """A line has arrived; it comes without its end."""

    def unfinished(self, rest: bytes) -> None:
        """The client left in the middle of a line."""

    def overlong(self) -> None:
        """The client sent more than `MAX_LINE` bytes without a line end; it is about to be disconnected."""


class LineServer:
    """Listens on one port.

    Attributes:
        clients: who is connected.
        connected: how many; any thread may read it.
        complaints: about what the clients do.
    """

    def __init__(self, name: str, listener: Listener, make: Callable[[LineServer], LineClient]) -> None:
        self.name = name
        self.clients: set[Any] = set()
        self.connected = 0
        self.complaints = Complaints(logger)
        self._listener = listener
        self._make = make
        self._server: asyncio.Server | None = None

    async def start(self, network: Network) -> None:
        """Begin to accept clients."""

        def make() -> LineClient:
            network.newcomer()  # again, for loops that accept in another way
            return self._make(self)

        self._listener.accepting = network.newcomer
        self._server = await network.loop.create_server(make, sock=self._listener)

    def join(self, client: LineClient) -> None:
        """A client has connected."""
        if self.connected >= MAX_CLIENTS:
            self.complaints.warn("many", f"{self.name}: {client.peer} is turned away, {MAX_CLIENTS} clients are enough")
            client.transport.abort()
            return
        self.clients.add(client)
        self.connected = len(self.clients)

    def leave(self, client: LineClient) -> None:
        """A client has gone."""
        self.clients.discard(client)
        self.connected = len(self.clients)

    async def close(self) -> None:
        """Accept nobody, send what is left, close; clients that do not read are cut off."""
        if self._server is not None:
            self._server.close()
        leaving = list(self.clients)
        for client in leaving:
            client.transport.close()
        if leaving:
            waiting = [asyncio.ensure_future(client.gone.wait()) for client in leaving]
            _, late = await asyncio.wait(waiting, timeout=_FAREWELL)
            for task in late:
                task.cancel()
        for client in leaving:
            client.transport.abort()


async def close_all(servers: Iterable[LineServer]) -> None:
    """Close several servers, at the same time."""
    await asyncio.gather(*(server.close() for server in servers))
