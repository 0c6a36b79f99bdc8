"""Clients that read all that a simulation sends, in processes of their own."""

from __future__ import annotations

import subprocess
import sys
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING

from morse.middleware.socket.request_manager import SocketRequestManager

if TYPE_CHECKING:
    from collections.abc import Iterator

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
def read_streams(simulation: Simulation, clients: int) -> Iterator[None]:
    """While this lasts, that many clients read the streams of all sensors."""
    every = stream_ports(simulation)
    ports = [str(every[sensor.name()]) for sensor in simulation.loaded.sensors]
    with _running("benchmarks.programs.read_streams", [str(clients), *ports], bool(clients)):
        yield


@contextmanager
def read_pages(simulation: Simulation, pages: int) -> Iterator[None]:
    """While this lasts, that many pages show the live view."""
    address = simulation.view.url if simulation.view is not None else ""
    with _running("benchmarks.programs.read_pages", [str(pages), address], bool(pages)):
        yield


@contextmanager
def _running(module: str, arguments: list[str], wanted: bool) -> Iterator[None]:
    with ExitStack() as stack:
        if wanted:
            command = [sys.executable, "-m", module, *arguments]
            child = stack.enter_context(subprocess.Popen(command, stdout=subprocess.PIPE, text=True))
            stack.callback(child.kill)
            assert child.stdout is not None
            if child.stdout.readline() != "connected\n":
                raise RuntimeError(f"{module} could not connect")
        yield
