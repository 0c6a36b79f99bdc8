"""Clients in separate processes that read all data of a simulation."""

from __future__ import annotations

import subprocess
import sys
from contextlib import contextmanager, nullcontext
from typing import TYPE_CHECKING

from morse.middleware.socket.request_manager import SocketRequestManager

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.simulation.simulation import Simulation


def stream_ports(simulation: Simulation) -> dict[str, int]:
    """Ports of the streams of all components, by name."""
    _, (_, ports) = _manager(simulation).on_incoming_request("simulation", "get_all_stream_ports", [])
    return dict(ports)


def service_port(simulation: Simulation) -> int:
    """The port of the services."""
    return int(_manager(simulation).port)


def _manager(simulation: Simulation) -> SocketRequestManager:
    (manager, *_) = simulation.context.services.request_managers().values()
    assert isinstance(manager, SocketRequestManager)
    return manager


@contextmanager
def read_streams(simulation: Simulation, clients: int, *, binary: bool = False) -> Iterator[None]:
    """A context in which that many clients read the streams of all sensors."""
    names = [sensor.name() for sensor in simulation.loaded.sensors]
    if binary:
        _, (_, port) = _manager(simulation).on_incoming_request("simulation", "get_binary_port", [])
        words = ["--binary", str(port), *names]
    else:
        every = stream_ports(simulation)
        words = [str(every[name]) for name in names]
    with _running("benchmarks.programs.read_streams", [str(clients), *words]) if clients else nullcontext() as child:
        if child is not None:
            _await(child)
        yield


@contextmanager
def read_pages(simulation: Simulation, pages: int = 0) -> Iterator[Callable[[int], None]]:
    """A context in which that many pages show the live view; its value changes the number."""
    if simulation.view is None:
        yield lambda _: None
        return
    with _running("benchmarks.programs.read_pages", [simulation.view.url]) as child:

        def show(count: int) -> None:
            assert child.stdin is not None
            child.stdin.write(f"{count}\n")
            child.stdin.flush()
            _await(child)

        show(pages)
        yield show


@contextmanager
def _running(module: str, arguments: list[str]) -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-m", module, *arguments]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as child:
        try:
            yield child
        finally:
            child.kill()


def _await(child: subprocess.Popen[str]) -> None:
    assert child.stdout is not None
    if child.stdout.readline() != "connected\n":
        raise RuntimeError(f"{child.args} could not connect")
