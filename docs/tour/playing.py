"""Runs an example of MORSE with its client in this process."""

from __future__ import annotations

import contextlib
import os
import runpy
import threading
from typing import TYPE_CHECKING, Any

import morse

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.cli.demo import Example


@contextlib.contextmanager
def playing(
    example: Example, end: Callable[[morse.Simulation], object] = morse.Simulation.stop, **options: Any
) -> Iterator[tuple[morse.Simulation, threading.Thread]]:
    """The simulation of an example, and the thread of its client, which is to be started.

    Args:
        end: called when the client has ended.
        options: those of `morse.load`.
    """
    os.environ["MORSE_SOCKET_PORT"] = "0"
    with morse.load(example.scene, sockets=True, **options) as simulation:
        (manager,) = simulation.context.services.request_managers().values()
        os.environ["MORSE_SOCKET_PORT"] = str(manager.port)
        yield simulation, threading.Thread(target=_client, args=[example, simulation, end], daemon=True)


def _client(example: Example, simulation: morse.Simulation, end: Callable[[morse.Simulation], object]) -> None:
    try:
        runpy.run_path(str(example.client))["main"]()
    except Exception as error:  # the simulation ends while it drives
        print(f"{example.name}: {type(error).__name__}")
    end(simulation)
