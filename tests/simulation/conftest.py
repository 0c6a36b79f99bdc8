"""Simulations in this process: ticked by the test, or running in a separate thread."""

import threading
from collections.abc import Callable, Iterator
from functools import partial

import pytest

from morse.simulation.simulation import Simulation
from pymorse import Morse
from tests.kit.scenes import Load


@pytest.fixture
def load(load: Load) -> Load:
    """With the services of a simulation, on a free port."""
    return partial(load, sockets=True)


class Running:
    """A simulation that runs in a thread, and a client of it."""

    def __init__(self, simulation: Simulation) -> None:
        self.simulation = simulation
        self.error: BaseException | None = None
        self._thread = threading.Thread(target=self._run)
        self._thread.start()
        (manager,) = simulation.context.services.request_managers().values()
        self.port: int = manager.port
        self.client = Morse("127.0.0.1", self.port)

    def _run(self) -> None:
        try:
            self.simulation.run()
        except BaseException as error:
            self.error = error

    def join(self) -> None:
        """Wait until it ends."""
        self._thread.join(60.0)
        assert not self._thread.is_alive()

    def close(self) -> None:
        if self._thread.is_alive():
            self.simulation.stop()
            self.simulation.context.wake()
        self.join()
        self.client.close(cancel_async_services=True)


@pytest.fixture
def running(load: Load) -> Iterator[Callable[..., Running]]:
    """Call it as `load`; the simulation is paused."""
    started: list[Running] = []

    def start(text: str, **options: object) -> Running:
        simulation = load(text, **options)
        simulation.pause()
        started.append(Running(simulation))
        return started[-1]

    yield start
    for run in started:
        run.close()
