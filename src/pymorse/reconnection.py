"""Connects again after the end of a simulation."""

from __future__ import annotations

import logging
import threading
import time
from typing import TYPE_CHECKING

from pymorse.discovery import discover
from pymorse.names import normalize_name

if TYPE_CHECKING:
    from pymorse.component import Component
    from pymorse.pymorse import Morse

logger = logging.getLogger("pymorse")

#: s between two attempts: the first, and the longest
_FIRST, _LONGEST = 0.25, 5.0


class Reconnection:
    """Watches a connection, and opens it again.

    Components, and what is subscribed to them, stay.

    Args:
        morse: the connection.
    """

    def __init__(self, morse: Morse) -> None:
        self._morse = morse
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._run, name="pymorse-reconnection", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Do not connect again."""
        self._end.set()
        if threading.current_thread() is not self._thread:
            self._thread.join(_LONGEST)

    def _run(self) -> None:
        morse = self._morse
        while not self._end.wait(_FIRST):
            if not morse._services.is_up():
                logger.warning("the simulation on %s:%s has ended; trying to connect again", morse.host, morse.port)
                self._come_back()

    def _come_back(self) -> None:
        morse, pause, begin = self._morse, _FIRST, time.monotonic()
        while not self._end.wait(pause):
            try:
                morse._connect()
                _update(morse)
            except (OSError, RuntimeError) as error:
                pause = min(2.0 * pause, _LONGEST)
                logger.info("no connection yet (%s); the next attempt is in %g s", error, pause)
                continue
            seconds = time.monotonic() - begin
            logger.warning("connected to %s:%s again, after %.1f s", morse.host, morse.port, seconds)
            return


def _update(morse: Morse) -> None:
    """Give the components the ports of the present simulation, and open their streams again."""
    robots = {robot.fqn: robot for robot in discover(morse)}
    before = {part.fqn: part for robot in morse._robots.values() for part in robot._tree()}
    for name, robot in robots.items():
        if name not in before:
            morse._add_robot(normalize_name(name), robot)
            continue
        for part in robot._tree():
            known = before.get(part.fqn)
            if known is not None:
                _renew(known, part)


def _renew(part: Component, present: Component) -> None:
    part._port, part._directions, part._services = present._port, present._directions, present._services
    with part._opening:
        former, part._stream = part._stream, None
    if former is None or part._port is None:
        return
    # closed without waiting for the thread of the connection: nothing is sent on it any more
    stream = part.stream
    stream._subscribers += former._subscribers
