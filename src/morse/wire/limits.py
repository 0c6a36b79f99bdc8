"""Limits for the clients of one simulation, individually and in total."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING, Any, Protocol

from morse.core.clients.budget import Budget

if TYPE_CHECKING:
    from morse.core.clients.network import Network

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
