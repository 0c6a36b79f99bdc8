"""``morse_sync``: paces a simulation that was started with ``time_sync=True``, one tick per period.

While it runs, it reads commands from its standard input, one per line: ``set_period SECONDS`` and ``quit``.
"""

from __future__ import annotations

import argparse
import contextlib
import logging
import math
import queue
import socket
import sys
import threading
import time
from typing import TYPE_CHECKING

from morse.core.reports.log import log_plainly
from morse.core.reports.printing import echo
from morse.wire.listener import port_number

if TYPE_CHECKING:
    from collections.abc import Sequence

logger = logging.getLogger("morse_sync")

_SAMPLES = 5
_GAIN = 0.5
_RETRY = 0.1


class Pace:
    """Computes the sleep time so that one round takes one period.

    Every five rounds the sleep time is corrected by half of the error of a round, which compensates for the work
    between two sleeps.

    Args:
        period: duration of a round, s.
    """

    def __init__(self, period: float) -> None:
        self._samples: list[float] = []
        self.set_period(period)

    def set_period(self, period: float) -> None:
        """Change the period, s."""
        self.period = period
        self.sleep = period
        self._samples.clear()

    def took(self, duration: float) -> None:
        """Record the duration of a round, s."""
        self._samples.append(duration)
        if len(self._samples) == _SAMPLES:
            error = self.period - sum(self._samples) / _SAMPLES
            self.sleep = max(0.0, self.sleep + _GAIN * error)
            self._samples.clear()


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point of ``morse_sync``; returns the exit status."""
    options = _parser().parse_args(arguments)
    log_plainly(logging.DEBUG if options.debug else logging.INFO)
    commands: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=_read_commands, args=[commands], daemon=True).start()
    try:
        with _connect(options.host, options.port, options.timeout) as connection:
            return _pace(connection, Pace(options.period), commands)
    except OSError as error:
        echo(f"* {options.host}:{options.port}: {error}", err=True)
        return 1
    except KeyboardInterrupt:
        return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="morse_sync",
        description="Paces a simulation whose scene has env.configure_stream_manager('socket', time_sync=True). "
        "Commands on the standard input: set_period SECONDS, quit.",
    )
    parser.add_argument("-p", "--period", type=_positive, required=True, help="wall-clock time per tick, s")
    parser.add_argument(
        "-t", "--timeout", type=_positive, default=10.0, help="timeout for the connection to the simulation, s"
    )
    parser.add_argument("-H", "--host", default="localhost", help="host of the simulation")
    parser.add_argument("-P", "--port", type=_port, default=6000, help="its sync_port")
    parser.add_argument("-d", "--debug", action="store_true", help="print the duration of each period")
    return parser


def _port(text: str) -> int:
    return port_number(text, 1)


def _positive(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (value > 0.0 and math.isfinite(value)):
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of seconds greater than 0")
    return value


def _connect(host: str, port: int, timeout: float) -> socket.socket:
    deadline = time.monotonic() + timeout
    while True:
        try:
            connection = socket.create_connection((host, port), timeout=timeout)
        except ConnectionRefusedError:
            if time.monotonic() > deadline:
                raise TimeoutError(f"no simulation listens there after {timeout:g} s") from None
            time.sleep(_RETRY)
        else:
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            return connection


def _pace(connection: socket.socket, pace: Pace, commands: queue.SimpleQueue[str]) -> int:
    connection.setblocking(False)
    last = time.monotonic()
    while True:
        if _ended(connection):
            logger.info("the simulation has ended")
            return 0
        with contextlib.suppress(BlockingIOError):
            connection.send(b"sync")
        with contextlib.suppress(queue.Empty):
            while True:
                if not _obey(commands.get_nowait(), pace):
                    return 0
        time.sleep(pace.sleep)
        now = time.monotonic()
        logger.debug("period %.6f s", now - last)
        pace.took(now - last)
        last = now


def _ended(connection: socket.socket) -> bool:
    try:
        return connection.recv(4096) == b""
    except BlockingIOError:
        return False
    except ConnectionError:
        return True


def _obey(line: str, pace: Pace) -> bool:
    words = line.split()
    if words == ["quit"]:
        return False
    if len(words) == 2 and words[0] == "set_period":
        try:
            pace.set_period(_positive(words[1]))
        except argparse.ArgumentTypeError as error:
            echo(f"* set_period: {error}", err=True)
    elif words:
        echo(f"* '{line.strip()}' is not a command; expected 'set_period SECONDS' or 'quit'", err=True)
    return True


def _read_commands(commands: queue.SimpleQueue[str]) -> None:
    for line in sys.stdin:
        commands.put(line)
