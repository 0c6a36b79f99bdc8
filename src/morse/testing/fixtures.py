"""A pytest fixture that runs simulations.

Put ``pytest_plugins = ["morse.testing.fixtures"]`` into ``conftest.py``; then::

    from morse.builder import *

    def scene():
        robot = ATRV()
        pose = Pose()
        robot.append(pose)
        robot.add_default_interface("socket")
        env = Environment("empty")

    def test_it_stands(simulate):
        simu = simulate(scene)
        assert simu.robot.pose.get()["z"] == pytest.approx(0.10, abs=0.01)
"""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from morse.testing.process import SimulationProcess
from morse.testing.scripts import script_of_function
from pymorse import Morse

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    #: starts a simulation and returns the connection to it
    Simulate = Callable[..., Morse]


@pytest.fixture
def simulate(tmp_path: Path) -> Iterator[Simulate]:
    """Call it with a scene to run it: ``simulate(scene, *options)``.

    The scene is a function of a module, or the path of a scene script; the options are those of
    ``morse run``. The result is a `pymorse.Morse`. Every simulation is on ports of its own, and ends with
    the test, which fails if the simulation reported an error.
    """
    running: list[tuple[SimulationProcess, Morse]] = []

    def start(scene: Callable[[], Any] | str | Path, *options: str) -> Morse:
        name = f"scene{len(running)}"
        if callable(scene):
            script = tmp_path / f"{name}.py"
            script.write_text(script_of_function(scene), encoding="utf-8")
        else:
            script = Path(scene)
        process = SimulationProcess(script, tmp_path / f"{name}.log", options=["--headless", *options])
        try:
            process.wait_initialized()
            simu = Morse("127.0.0.1", process.port)
        except BaseException:
            process.kill()
            raise
        running.append((process, simu))
        return simu

    with contextlib.ExitStack() as endings:
        endings.callback(_end_all, running)
        yield start


def _end_all(running: list[tuple[SimulationProcess, Morse]]) -> None:
    errors = []
    for process, simu in reversed(running):
        with contextlib.suppress(ConnectionError):
            simu.close(cancel_async_services=True)
        try:
            process.stop()
        except Exception as error:
            errors.append(str(error))
        if process.watch.error is not None:
            errors.append(f"the simulation reported an error: {process.watch.error}")
    if errors:
        pytest.fail("\n".join(errors))
