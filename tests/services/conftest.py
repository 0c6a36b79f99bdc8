"""A simulation that the tests of one file share: it is paused, and tests run its ticks."""

import inspect
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from morse.testing.process import SimulationProcess
from morse.testing.scripts import script_of_function
from pymorse import Morse

HZ = 60


@pytest.fixture(scope="module")
def process(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[SimulationProcess]:
    """The scene is the function `scene` of the test file."""
    scene: Callable[[], Any] = request.module.scene
    directory = tmp_path_factory.mktemp(inspect.getmodulename(request.module.__file__) or "scene")
    (directory / "scene.py").write_text(script_of_function(scene), encoding="utf-8")
    started = SimulationProcess(directory / "scene.py", directory / "log")
    started.wait_initialized()
    yield started
    if started.watch.error is None:
        started.stop()
    else:
        started.kill()


@pytest.fixture(scope="module")
def connection(process: SimulationProcess) -> Iterator[Morse]:
    # on a busy machine, the messages of a step may come later than a client usually waits for them
    with pytest.MonkeyPatch.context() as patch, Morse("127.0.0.1", process.port) as simu:
        patch.setattr("pymorse.pymorse.TIMEOUT", 60.0)
        yield simu


@pytest.fixture
def simu(connection: Morse) -> Morse:
    """At tick 0, paused."""
    connection.pause()
    connection.rpc("simulation", "reset")
    return connection
