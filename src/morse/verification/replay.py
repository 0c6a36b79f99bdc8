"""Runs a scene for some ticks and writes the fingerprint of every part after each of them.

`morse.verification.verify` starts ``python -m morse.verification.replay OPTIONS``; OPTIONS is JSON: the fields of a
`Replay`. One JSON object per tick is written to the standard output, and at last a text that names the parts that have
failed; output of the scene is redirected to the standard error. The process ends with its parent process, because its
standard input is closed then.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import selectors
import socket
import sys
import threading
from contextlib import nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

import msgspec
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

from morse.builder.script import ScriptError, load_scene
from morse.core.exceptions import MorseError
from morse.core.guard import by_part
from morse.core.reports import log
from morse.core.reports.faults import describe
from morse.core.reports.printing import echo
from morse.launch.load import start
from morse.physics import UnstableError
from morse.simulation.options import RunOptions
from morse.system.workers import own_output
from morse.viewer.live_view import View
from morse.viewer.page_messages import Hello, PageMessage, Taken, Watch
from morse.viewer.protocol import VERSION
from morse.viewer.snapshot import holds_poses

if TYPE_CHECKING:
    from types import TracebackType
    from typing import TextIO

    from morse.core.values import Options
    from morse.simulation.simulation import Simulation


# Clients and pages that observe a simulation during a replay.

_POLL = 0.1
#: timeout for the connection of a page, wall-clock seconds
_ARRIVAL = 30.0
#: maximum number of components that a page shows
_SHOWN = 1000


class PassiveClients:
    """Read all data of a simulation, in separate threads.

    Args:
        clients: connections to every stream of the socket.
        pages: number of pages of the live view, if there is one.

    Raises:
        RuntimeError: a page cannot connect.
    """

    def __init__(self, simulation: Simulation, clients: int, pages: int = 1) -> None:
        self._ended = threading.Event()
        self._arrivals = threading.Semaphore(0)
        self._selector = selectors.DefaultSelector()
        host = simulation.options.host
        for port in _stream_ports(simulation):
            for _ in range(clients):
                self._selector.register(socket.create_connection((host, port)), selectors.EVENT_READ)
        self._threads = [threading.Thread(target=self._read)]
        count = 0
        if isinstance(simulation.view, View):
            count = pages
            address = urlsplit(simulation.view.url)._replace(scheme="ws", path="/ws").geturl()
            names = list(simulation.context.components)
            self._threads += [threading.Thread(target=self._watch, args=[address, names]) for _ in range(pages)]
        for thread in self._threads:
            thread.start()
        if not all(self._arrivals.acquire(timeout=_ARRIVAL) for _ in range(count)):
            self.close()
            raise RuntimeError("a page of the live view could not connect")

    def _read(self) -> None:
        while not self._ended.is_set():
            for key, _ in self._selector.select(_POLL):
                connection: socket.socket = key.fileobj  # type: ignore[assignment]
                with contextlib.suppress(OSError):
                    if connection.recv(1 << 18):
                        continue
                self._selector.unregister(connection)
                connection.close()

    def _watch(self, address: str, names: list[str]) -> None:
        place = urlsplit(address)
        with (
            contextlib.suppress(WebSocketException, OSError),
            # an explicit socket, so that no proxy is used for this machine
            socket.create_connection((place.hostname, place.port)) as connection,
            connect(address, sock=connection, max_size=None) as page,
        ):
            page.send(_text(Hello(version=VERSION)))
            page.recv(timeout=_ARRIVAL)
            page.send(_text(Watch(values=names[:_SHOWN], overlays=["contacts", *names[: _SHOWN - 1]])))
            self._arrivals.release()
            count = 0
            while not self._ended.is_set():
                with contextlib.suppress(TimeoutError):
                    if holds_poses(page.recv(timeout=_POLL)):
                        count += 1
                        page.send(_text(Taken(count)))

    def __enter__(self) -> PassiveClients:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Stop observing."""
        self._ended.set()
        for thread in self._threads:
            thread.join()
        for key in list(self._selector.get_map().values()):
            key.fileobj.close()  # type: ignore[union-attr]
        self._selector.close()


def _stream_ports(simulation: Simulation) -> list[int]:
    for manager in simulation.context.services.request_managers().values():
        with contextlib.suppress(MorseError):
            _, (_, ports) = manager.on_incoming_request("simulation", "get_all_stream_ports", [])
            return list(ports.values())
    return []


def _text(message: PageMessage) -> str:
    return msgspec.json.encode(message).decode()


#: timeout of a run in step with the wall clock, s
_PACED = 3.0


@dataclass(frozen=True, slots=True)
class Replay:
    """The options of a replay.

    Attributes:
        options: fields of `RunOptions`.
        ticks: length of each run; None for the duration of the options.
        restarts: number of restarts afterwards.
        clients: readers of every stream.
        pages: number of pages of the live view, if the options open one.
        paced: wait for the wall clock between ticks.
    """

    options: Options
    ticks: int | None
    restarts: int = 0
    clients: int = 0
    pages: int = 1
    paced: bool = False


def replay(request: Replay, file: TextIO) -> None:
    """Write the fingerprints of ``1 + restarts`` runs, one after the other."""
    options = RunOptions(**request.options)
    with start(load_scene(options), options) as simulation:
        if simulation.view is not None:
            simulation.view.announce()
        watched = bool(request.clients or simulation.view)
        with PassiveClients(simulation, request.clients, request.pages) if watched else nullcontext():
            for run in range(1 + request.restarts):
                if run:
                    simulation.restart()
                _run(simulation, request, file)
    file.write(json.dumps(by_part(one for one in simulation.failures if one.kind == "fault")) + "\n")


def _run(simulation: Simulation, request: Replay, file: TextIO) -> None:
    pacer = simulation.pacer
    seconds = simulation.options.duration or 0.0
    ticks = max(1, round(seconds * simulation.clock.frequency)) if request.ticks is None else request.ticks
    if request.paced:
        pacer.set_speed(max(1.0, ticks * simulation.clock.period / _PACED))
    for _ in range(ticks):
        simulation.tick()
        file.write(json.dumps(simulation.save().fingerprints()) + "\n")
        if request.paced:
            pacer.wait()


def main(argument: str) -> None:
    """Run the replay of a JSON text."""
    _end_with_the_parent()
    own = own_output()
    log.setup(level="ERROR")
    with io.TextIOWrapper(io.BufferedWriter(own), encoding="utf-8") as file:
        try:
            replay(Replay(**json.loads(argument)), file)
        except (MorseError, UnstableError, ValueError, OSError, SystemExit) as error:
            # a mistake in the scene, as `morse run` reports it
            echo(_report(error), err=True)
            sys.exit(1)


def _report(error: BaseException) -> str:
    if isinstance(error, ScriptError):
        return error.report()
    return str(error) if isinstance(error, MorseError) else describe(error)


def _end_with_the_parent() -> None:
    alive = os.dup(0)
    # scenes may read: they get the end of the file
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)

    def wait() -> None:
        while os.read(alive, 1):
            pass
        os._exit(1)

    threading.Thread(target=wait, name="parent", daemon=True).start()


if __name__ == "__main__":
    main(sys.argv[1])
