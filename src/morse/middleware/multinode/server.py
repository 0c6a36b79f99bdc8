"""The server that passes the poses of robots on between nodes."""

from __future__ import annotations

import logging
from collections import Counter
from operator import itemgetter
from typing import TYPE_CHECKING

from morse.middleware.multinode.messages import read_state, written_answer
from morse.wire.lines import LineClient
from morse.wire.server import LineServer

if TYPE_CHECKING:
    import socket

    from morse.core.clients.network import Network
    from morse.middleware.multinode.messages import Poses
    from morse.wire.connection import Connection

logger = logging.getLogger(__name__)

#: maximum number of robots of all nodes
_MOST_ROBOTS = 10_000


class MultinodeServer:
    """Keeps the latest poses of all robots; a robot belongs to the connection that has sent it last.

    Args:
        listener: the port.
        network: whose loop serves the nodes.

    Attributes:
        poses: by name of the robot.
    """

    def __init__(self, listener: socket.socket, network: Network) -> None:
        self.poses: Poses = {}
        self._owners: dict[str, _Node] = {}
        self._network = network
        self._server = LineServer("multi-node server", listener, lambda server: _Node(server, self))
        network.call(self._server.start(network))

    def close(self) -> None:
        """Disconnect all nodes."""
        self._network.call(self._server.close())

    def update(self, node: _Node, poses: Poses) -> Poses:
        """Store the poses of a node, and return those of all robots that it has not sent; in the loop.

        Raises:
            ValueError: there are too many robots, and no other node has more.
        """
        for name in [name for name, owner in self._owners.items() if owner is node and name not in poses]:
            self._forget(name)
        while (count := len(self.poses) + sum(name not in self.poses for name in poses)) > _MOST_ROBOTS:
            text = f"there are {count} robots; {_MOST_ROBOTS} are allowed"
            greediest, most = max(Counter(self._owners.values()).items(), key=itemgetter(1), default=(node, 0))
            if greediest is node or most <= len(poses):
                raise ValueError(text)
            # the node that has most leaves, not the one that comes last
            self.left(greediest)
            greediest.expel(text)
        self.poses.update(poses)
        self._owners.update(dict.fromkeys(poses, node))
        return {name: pose for name, pose in self.poses.items() if name not in poses}

    def left(self, node: _Node) -> None:
        """Forget the robots of a node that has disconnected; in the loop."""
        for name in [name for name, owner in self._owners.items() if owner is node]:
            self._forget(name)

    def _forget(self, name: str) -> None:
        del self._owners[name], self.poses[name]


class _Node(LineClient):
    def __init__(self, server: LineServer, owner: MultinodeServer) -> None:
        super().__init__(server)
        self._owner = owner
        self._name = ""

    def connection_made(self, transport: Connection, peer: str) -> None:
        super().connection_made(transport, peer)
        logger.debug("%s has connected", peer)

    def line(self, line: bytes) -> None:
        """Answer a state."""
        if self.congested:
            return  # it asks faster than it reads
        try:
            name, poses = read_state(line)
            answer = written_answer(self._owner.update(self, poses))
        except ValueError as error:
            self.expel(str(error))
            return
        self.is_proven = True
        if name != self._name:
            self._name = name
            self.server.complaints.log(logging.INFO, "node", f"{self.peer} is node {name!r:.60}: {len(poses)} robots")
        self.transport.write(answer)

    def expel(self, why: str) -> None:
        """Disconnect it."""
        self.server.complaints.warn("read", f"{self.peer} is disconnected: {why}")
        self.transport.abort()

    def overlong(self) -> None:
        """Say why it is disconnected."""
        self.server.complaints.warn("long", f"{self.peer} is disconnected: its line is too long")

    def connection_lost(self, error: OSError | None) -> None:
        """Forget its robots."""
        super().connection_lost(error)
        self._owner.left(self)
        if self._name:
            self.server.complaints.log(logging.INFO, "left", f"the node {self._name!r:.60} has left")
