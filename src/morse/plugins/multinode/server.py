"""``multinode_server``: passes the poses of robots on between the nodes of a simulation."""

from __future__ import annotations

import argparse
import logging
import signal
import threading
from collections import Counter
from operator import itemgetter
from typing import TYPE_CHECKING

from morse.core.clients.network import Network
from morse.core.exceptions import MorseError
from morse.core.reports.log import log_plainly
from morse.plugins.multinode import PORT
from morse.plugins.multinode.messages import read_state, written_answer
from morse.wire.lines import LineClient
from morse.wire.listener import listen, port_number, port_of
from morse.wire.server import LineServer

if TYPE_CHECKING:
    import socket
    from collections.abc import Sequence

    from morse.plugins.multinode.messages import Poses
    from morse.wire.connection import Connection

logger = logging.getLogger("multinode_server")

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


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point of ``multinode_server``; returns the exit status."""
    options = _parser().parse_args(arguments)
    log_plainly()
    if options.debug:
        logging.getLogger("morse").setLevel(logging.DEBUG)
    try:
        listener = listen(options.host, [options.port])
    except (MorseError, OSError, OverflowError) as error:
        logger.error("%s", error)
        return 1
    stop = threading.Event()

    def end(_number: int, _frame: object) -> None:
        stop.set()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, end)
    network = Network()
    server = MultinodeServer(listener, network)
    logger.info(
        "poses are passed on as they come: nodes do not wait for each other, so that their times differ, and two runs "
        "are not the same; for speed, use one process or batches (docs/multinode.md)"
    )
    logger.info("nodes may connect to %s:%d; Ctrl+C ends the server", options.host, port_of(listener))
    stop.wait()
    server.close()
    network.stop()
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="multinode_server",
        description="Passes the poses of robots on between simulations whose scene has env.configure_multinode(...).",
    )
    parser.add_argument("-H", "--host", default="127.0.0.1", help="address to listen on; 0.0.0.0 for all networks")
    parser.add_argument("-P", "--port", type=_port, default=PORT, help="TCP port; 0 for any free one")
    parser.add_argument("-d", "--debug", action="store_true", help="print who connects")
    return parser


def _port(text: str) -> int:
    return port_number(text, 0)
