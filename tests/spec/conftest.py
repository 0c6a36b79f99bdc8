"""Scripts, components and clients of old users, run as they were written for 1.4."""

import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from morse.assets import search
from morse.builder import workspace
from morse.builder.script import load_scene
from morse.scene import Scene
from morse.simulation.options import RunOptions
from morse.testing.process import SimulationProcess
from pymorse import Morse


class Running:
    """A simulation of the files of a test module.

    Attributes:
        simu: a connection to it.
        process: the process.
    """

    def __init__(self, process: SimulationProcess) -> None:
        self.process = process
        self.simu = Morse("127.0.0.1", process.port)

    @property
    def log(self) -> str:
        """Its output so far."""
        return self.process.log.read_text(encoding="utf-8")

    def call(self, component: str, service: str, *arguments: Any) -> Any:
        """Call a service and wait for the result."""
        return self.simu.rpc(component, service, *arguments)


@pytest.fixture(scope="module")
def running(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    """Runs ``scene.py`` of the ``FILES`` of the module: a dictionary from paths in the project to texts."""
    directory: Path = tmp_path_factory.mktemp("project")
    for name, text in request.module.FILES.items():
        path = directory / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    process = SimulationProcess(directory / "scene.py", directory / "log", options=["--headless", "--speed", "4"])
    try:
        process.wait_initialized()
        started = Running(process)
        yield started
        started.simu.close(cancel_async_services=True)
        process.stop()
    finally:
        process.kill()


@pytest.fixture
def load(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[str], Scene]]:
    """Runs a text as a scene script, in this process."""
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.setattr(sys, "argv", list(sys.argv))
    monkeypatch.delenv("MORSE_RESOURCE_PATH", raising=False)
    monkeypatch.delenv("MORSE_ROOT", raising=False)

    def run(text: str) -> Scene:
        script = tmp_path / "scene.py"
        script.write_text("from morse.builder import *\n" + text, encoding="utf-8")
        return load_scene(RunOptions(str(script)))

    yield run
    workspace.reset()
    search.set_project_dirs([])
