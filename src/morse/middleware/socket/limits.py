"""What the clients of one simulation may take, alone and together."""

from __future__ import annotations

import threading
import weakref
from typing import TYPE_CHECKING, Any, Protocol

from morse.middleware.socket.listener import most_sockets

if TYPE_CHECKING:
    from morse.core.complaints import Complaints
    from morse.core.network import Network

MAX_CLIENTS = 256
"""Connections to one port."""
MAX_HELD = 64 << 20
"""Received bytes of all clients together that are not yet processed."""
MAX_COMMANDS = 32 << 20
"""Bytes of the messages to all actuators together that wait for the next tick."""
MAX_UNSENT = 128 << 20
"""Bytes that wait to be sent to all clients together."""
#: a connection counts as slow when that much is unsent, or its share of `MAX_UNSENT` if there are many
_HIGH_WATER = 1 << 18


class Budget:
    """A number of bytes that several clients share."""

    def __init__(self, size: int) -> None:
        self.left = size
        self._lock = threading.Lock()

    def take(self, count: int) -> bool:
        """Take that many bytes; False if fewer are left."""
        with self._lock:
            if count > self.left:
                return False
            self.left -= count
            return True

    def give(self, count: int) -> None:
        """Give back what `take` took."""
        with self._lock:
            self.left += count


class Server(Protocol):
    """The part of a server that the limits use.

    Attributes:
        name: for messages.
        clients: the connected clients.
        connected: the number of connected clients.
        complaints: warnings about its clients.
    """

    name: str
    clients: set[Any]
    connected: int
    complaints: Complaints

    def least_missed(self) -> Any:
        """The client that may go first."""

    def leave(self, client: Any) -> None:
        """Forget a client that has left."""


class Limits:
    """The servers of a simulation, and the limits that their clients share.

    Attributes:
        held: bytes of requests, and of lines without their end, that wait to be used.
        commands: bytes of messages to actuators that wait for the next tick.
        servers: the open servers.
    """

    def __init__(self) -> None:
        self.held = Budget(MAX_HELD)
        self.commands = Budget(MAX_COMMANDS)
        self.servers: set[Server] = set()
        self._most = most_sockets()

    @property
    def connected(self) -> int:
        """The number of connections."""
        return sum(server.connected for server in self.servers)

    def fullest(self) -> Server | None:
        """The server with the most connections if there may be no more of them in all, else None."""
        if self.connected + len(self.servers) < self._most:
            return None
        return max(self.servers, key=lambda server: server.connected)

    def high_water(self) -> int:
        """Unsent bytes above which a connection to a stream counts as slow."""
        return max(1 << 12, min(_HIGH_WATER, MAX_UNSENT // (self.connected + 1)))

    def greediest(self) -> Any:
        """The client with the most received bytes that are not yet processed."""
        return max((client for server in self.servers for client in server.clients), key=lambda client: client.held)


_limits: weakref.WeakKeyDictionary[Network, Limits] = weakref.WeakKeyDictionary()


def limits_of(network: Network) -> Limits:
    """The limits of the simulation that has this network."""
    return _limits.setdefault(network, Limits())
