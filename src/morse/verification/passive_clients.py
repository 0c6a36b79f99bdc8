"""Clients and pages that observe a simulation during a replay."""

from __future__ import annotations

import contextlib
import selectors
import socket
import threading
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

import msgspec
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

from morse.core.exceptions import MorseError
from morse.viewer.live_view import View
from morse.viewer.page_messages import Hello, PageMessage, Taken, Watch
from morse.viewer.protocol import VERSION
from morse.viewer.snapshot import holds_poses

if TYPE_CHECKING:
    from types import TracebackType

    from morse.simulation.simulation import Simulation

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
