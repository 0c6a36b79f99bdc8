"""Simulations in this process: ticked by the test, or running in a separate thread."""

import textwrap
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import morse
from morse.simulation.simulation import Simulation
from pymorse import Morse

Load = Callable[..., Simulation]


@pytest.fixture
def load(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Load]:
    """Call it with the text of a scene script, and with options of `morse.load`, for a simulation."""
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    loaded: list[Simulation] = []

    def load_text(text: str, **options: object) -> Simulation:
        script = tmp_path / "scene.py"
        script.write_text("from morse.builder import *\n" + textwrap.dedent(text), encoding="utf-8")
        loaded.append(morse.load(script, **{"sockets": True, **options}))  # type: ignore[arg-type]
        return loaded[-1]

    yield load_text
    for simulation in loaded:
        simulation.close()


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
