"""Line-based TCP servers; all functions run in the network loop, unless stated otherwise."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import socket
import weakref
from typing import TYPE_CHECKING, Any, Protocol

from morse.core.clients.acceptors import Acceptor
from morse.core.clients.budgets import Budget
from morse.core.clients.complaints import Complaints
from morse.wire.connection import Connection

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from morse.core.clients.network import Network
    from morse.wire.lines import LineClient


MAX_CLIENTS = 256
"""Connections to one port."""
MAX_HELD = 64 << 20
"""Maximum number of received bytes of all clients that are not yet processed."""
MAX_COMMANDS = 32 << 20
"""Maximum size of the messages to all actuators that wait for the next tick, bytes."""
MAX_UNSENT = 128 << 20
"""Maximum number of unsent bytes for all clients."""
#: a connection counts as slow above this number of unsent bytes, or above its share of `MAX_UNSENT`
_HIGH_WATER = 1 << 18


class Server(Protocol):
    """The part of a server that the limits use.

    Attributes:
        clients: the connected clients.
    """

    clients: set[Any]

    @property
    def connected(self) -> int:
        """The number of connected clients."""


class Limits:
    """The servers of a simulation, and the limits that their clients share.

    Attributes:
        held: bytes of unprocessed requests and incomplete lines.
        commands: bytes of messages to actuators that wait for the next tick.
        servers: the open servers.
    """

    def __init__(self) -> None:
        self.held = Budget(MAX_HELD)
        self.commands = Budget(MAX_COMMANDS)
        self.servers: set[Server] = set()

    @property
    def connected(self) -> int:
        """The number of connections."""
        return sum(server.connected for server in self.servers)

    def high_water(self) -> int:
        """Number of unsent bytes above which a connection to a stream counts as slow."""
        return max(1 << 12, min(_HIGH_WATER, MAX_UNSENT // (self.connected + 1)))

    def greediest(self) -> Any:
        """The client with the most received bytes that are not yet processed."""
        return max((client for server in self.servers for client in server.clients), key=lambda client: client.held)


_limits: weakref.WeakKeyDictionary[Network, Limits] = weakref.WeakKeyDictionary()


def limits_of(network: Network) -> Limits:
    """The limits of the simulation with this network."""
    return _limits.setdefault(network, Limits())


logger = logging.getLogger(__name__)

#: seconds for which clients may read the remaining bytes when a server closes
_FAREWELL = 1.0
#: TCP keep-alive: seconds of silence before the first probe, seconds between probes, and number of probes without an
#: answer after which the connection is closed
_SILENCE, _PROBE, _PROBES = 10, 10, 6


class LineServer:
    """Listens on one port.

    Args:
        make: creates the client of a new connection.
        comes_first: data of its clients are read before requests are processed (see `Network.when_read`).
        refusal: what a client is sent before it is disconnected because there is no place for it.

    Attributes:
        clients: the connected clients.
        complaints: warnings about its clients.
        limits: limits shared by all clients of the simulation.
    """

    def __init__(
        self,
        name: str,
        listener: socket.socket,
        make: Callable[[LineServer], LineClient],
        *,
        comes_first: bool = False,
        refusal: bytes = b"",
    ) -> None:
        self.name = name
        self.complaints = Complaints(logger)
        self._acceptor = Acceptor(name, self._join, most=MAX_CLIENTS, complaints=self.complaints, refusal=refusal)
        self.clients: set[Any] = self._acceptor.connections
        self.limits: Limits
        self._listener = listener
        self._make = make
        self._comes_first = comes_first
        self._network: Network | None = None

    @property
    def connected(self) -> int:
        """The number of connected clients; any thread may read it."""
        return len(self.clients)

    async def start(self, network: Network) -> None:
        """Start accepting clients."""
        self._network = network
        self.limits = limits_of(network)
        self.limits.servers.add(self)
        self._acceptor.open(self._listener, network.loop, self._watch, network.ignore)

    def _watch(self, listener: socket.socket, accept: Callable[[], None]) -> None:
        assert self._network is not None
        self._network.on_readable(listener, accept, comes_first=self._comes_first)

    def _join(self, sock: socket.socket, address: object) -> None:
        assert self._network is not None
        with contextlib.suppress(OSError):  # it may have disconnected
            _probe_when_silent(sock)
        client = self._make(self)
        connection = Connection(self._network, sock, comes_first=self._comes_first)
        peer = f"{address[0]}:{address[1]}" if isinstance(address, tuple) else "?"
        self._acceptor.join(client)
        client.connection_made(connection, peer)
        connection.start(client)
        if self._comes_first:
            connection.read()  # it may have sent data before it was accepted

    def leave(self, client: LineClient) -> None:
        """Remove a client that has disconnected."""
        self._acceptor.leave(client)

    async def close(self) -> None:
        """Stop accepting, send the remaining bytes, and close. Clients that do not read are disconnected."""
        if self._network is not None:
            self._acceptor.close()
            self._network = None
            self.limits.servers.discard(self)
        self._listener.close()
        leaving = list(self.clients)
        for client in leaving:
            client.transport.close()
        if leaving:
            waits = [asyncio.ensure_future(client.gone.wait()) for client in leaving]
            _, late = await asyncio.wait(waits, timeout=_FAREWELL)
            for task in late:
                task.cancel()
        for client in leaving:
            client.transport.abort()


def _probe_when_silent(sock: socket.socket) -> None:
    # the final packet is sent only once and may be lost
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for option, value in (("TCP_KEEPINTVL", _PROBE), ("TCP_KEEPCNT", _PROBES), ("TCP_KEEPIDLE", _SILENCE)):
        if hasattr(socket, option):  # not on every system
            sock.setsockopt(socket.IPPROTO_TCP, getattr(socket, option), value)


async def close_all(servers: Iterable[LineServer]) -> None:
    """Close several servers concurrently."""
    await asyncio.gather(*(server.close() for server in servers))
