"""A page on the protocol level, and its simulation."""

import contextlib
import json
import math
import threading
import time
from collections.abc import Callable
from typing import Any
from urllib.parse import urlsplit

import msgspec
from websockets.sync.client import connect

from morse.core.observer import Observer
from morse.simulation.simulation import Simulation
from morse.viewer import page_messages as page
from morse.viewer.protocol import VERSION

LIMIT = 60.0


class Witness(Observer):
    """Records the fingerprint of every tick; a repeated tick must have the same one."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._last = -1
        self.hashes: dict[int, str] = {}
        self.again: set[int] = set()
        self.different: set[int] = set()

    def after_tick(self) -> None:
        tick = self._simulation.ticks
        if tick == self._last:
            return  # no time has passed: inputs in the meantime change the state
        self._last = tick
        fingerprint = self._simulation.state_hash()
        if tick in self.hashes:
            self.again.add(tick)
        if self.hashes.setdefault(tick, fingerprint) != fingerprint:
            self.different.add(tick)


class DrivingPage:
    """A driving page, and its simulation, which runs in another thread."""

    def __init__(self, simulation: Simulation) -> None:
        self.simulation = simulation
        self.times: list[float] = []
        self.log: list[str] = []
        self.worlds = 0
        simulation.pause()
        self.witness = Witness(simulation)
        simulation.observers.append(self.witness)
        address = urlsplit(simulation.view.url)._replace(scheme="ws", path="/ws").geturl()
        self._thread = threading.Thread(target=simulation.run, kwargs={"speed": math.inf})
        self._thread.start()
        self._open = contextlib.ExitStack()
        self._connection = self._open.enter_context(connect(address, max_size=None, max_queue=None, ping_interval=None))
        self._taken = 0
        self.send(page.Hello(version=VERSION))

    def send(self, message: page.PageMessage) -> None:
        self._connection.send(msgspec.json.encode(message).decode())

    def until(self, condition: Callable[[], object]) -> None:
        """Read messages until a condition holds."""
        end = time.monotonic() + LIMIT
        while not condition():
            assert time.monotonic() < end, "nothing has happened"
            self.send(page.Alive())
            with contextlib.suppress(TimeoutError):
                self._take(self._connection.recv(timeout=0.05))

    def _take(self, content: str | bytes) -> None:
        if isinstance(content, bytes):
            self._taken += 1
            self.send(page.Taken(self._taken))
            return
        message: dict[str, Any] = json.loads(content)
        if message["type"] == "history":
            self.times = message["times"]
        elif message["type"] == "log":
            self.log.append(message["text"])
        elif message["type"] == "world":
            self.worlds += 1

    def close(self) -> None:
        self.simulation.stop()
        self.simulation.context.wake()
        self._thread.join(LIMIT)
        self._open.close()
        assert not self._thread.is_alive()
