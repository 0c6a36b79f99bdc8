"""``multinode_server``: passes the poses of robots on between the nodes of a simulation."""

from __future__ import annotations

import argparse
import logging
import signal
import threading
from typing import TYPE_CHECKING

from morse.cli.messages import complain
from morse.cli.ports import port_number
from morse.core.clients.network import Network
from morse.core.exceptions import MorseError
from morse.core.reports.log import log_plainly
from morse.launch.ending_signals import ending_signals
from morse.middleware.multinode.messages import PORT
from morse.middleware.multinode.server import MultinodeServer
from morse.wire.listener import listen, port_of

if TYPE_CHECKING:
    from collections.abc import Sequence

logger = logging.getLogger("multinode_server")


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point of ``multinode_server``; returns the exit status."""
    options = _parser().parse_args(arguments)
    log_plainly()
    if options.debug:
        logging.getLogger("morse").setLevel(logging.DEBUG)
    try:
        listener = listen(options.host, [options.port])
    except (MorseError, OSError, OverflowError) as error:
        complain(str(error))
        return 1
    stop = threading.Event()

    def end(_number: int, _frame: object) -> None:
        stop.set()

    for number in ending_signals():
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
