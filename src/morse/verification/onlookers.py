"""Clients and a page that look at a simulation while it is replayed."""

from __future__ import annotations

import contextlib
import selectors
import socket
import threading
from typing import TYPE_CHECKING

import msgspec
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

from morse.core.exceptions import MorseError
from morse.simulation.viewing import View
from morse.viewer.page_messages import Hello, PageMessage, Taken, Watch
from morse.viewer.protocol import VERSION

if TYPE_CHECKING:
    from types import TracebackType

    from morse.simulation.simulation import Simulation

_POLL = 0.1
#: components that one page may show
_SHOWN = 1000


class Onlookers:
    """Read everything that a simulation sends, from threads of their own.

    Args:
        clients: connections to every stream of the socket.
    """

    def __init__(self, simulation: Simulation, clients: int) -> None:
        self._ended = threading.Event()
        self._selector = selectors.DefaultSelector()
        host = simulation.options.host
        for port in _stream_ports(simulation):
            for _ in range(clients):
                self._selector.register(socket.create_connection((host, port)), selectors.EVENT_READ)
        self._threads = [threading.Thread(target=self._read)]
        if isinstance(simulation.view, View):
            names = list(simulation.context.components)
            self._threads.append(threading.Thread(target=self._watch, args=[simulation.view.url, names]))
        for thread in self._threads:
            thread.start()

    def _read(self) -> None:
        while not self._ended.is_set():
            for key, _ in self._selector.select(_POLL):
                connection: socket.socket = key.fileobj  # type: ignore[assignment]
                with contextlib.suppress(OSError):
                    if connection.recv(1 << 18):
                        continue
                self._selector.unregister(connection)
                connection.close()

    def _watch(self, url: str, names: list[str]) -> None:
        with (
            contextlib.suppress(WebSocketException, OSError),
            connect(url.replace("http", "ws", 1) + "ws", max_size=None) as page,
        ):
            page.send(_text(Hello(version=VERSION)))
            page.send(_text(Watch(values=names[:_SHOWN], overlays=["contacts", *names[: _SHOWN - 1]])))
            taken = 0
            while not self._ended.is_set():
                with contextlib.suppress(TimeoutError):
                    if isinstance(page.recv(timeout=_POLL), bytes):
                        taken += 1
                        page.send(_text(Taken(taken)))

    def __enter__(self) -> Onlookers:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
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
