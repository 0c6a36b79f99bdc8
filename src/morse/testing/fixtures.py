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
import logging
import math
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from morse.builder.names.places import resource_folders
from morse.system import variables
from morse.testing.process import SimulationProcess
from morse.testing.scripts import script_of_function, script_of_text
from pymorse import Morse

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.core.values import Options

    #: starts a simulation and returns the connection to it
    Simulate = Callable[..., object]


_MODELS = "MORSE_RESOURCE_PATH"


@pytest.fixture
def simulate(tmp_path: Path, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[Simulate]:
    """Runs a scene when it is called: ``simulate(scene, *options, sockets=True)``.

    The scene is a function of a module, the path of a scene script, or the text of one: a text has several lines, and
    may leave out ``from morse.builder import *`` and ``env = Environment("empty")``. The options are those of
    ``morse run``. The simulation runs in a separate process on its own ports, and the result is a `pymorse.Morse`. With
    ``sockets=False`` it runs in the process of the test, without any port, and the result is the
    `morse.simulation.simulation.Simulation`, which has the same methods. Its time passes only while the test requests
    it, by ``step``, ``get``, ``sleep`` or the result of a service, and the only options are ``--seed`` and ``--speed``.
    ``seed=3`` is the same as ``"--seed", "3"``.

    Models are found in ``data`` of the project that contains the test.

    Every simulation ends with the test, which fails if the simulation reported an error. In the process of the test,
    ``step`` raises the error of a component that fails. With ``on_failure="deactivate"``, errors are only logged and
    the component is deactivated, as without tests. Unless ``strict`` is False, a command with an unknown field or a
    wrong type is an error. With ``on_warning="raise"``, a warning about the scene is an error.
    """
    # scenes of functions and texts are written to other folders
    folders = [*variables.paths(_MODELS), *resource_folders(request.path)[:-1]]
    if folders:
        monkeypatch.setenv(_MODELS, os.pathsep.join(folders))
    with contextlib.ExitStack() as endings:
        errors: list[str] = []
        endings.callback(_fail_for, errors)
        number = 0

        def start(
            scene: Callable[[], object] | str | Path,
            *options: str,
            sockets: bool = True,
            seed: int | None = None,
            strict: bool = True,
            on_failure: str = "raise",
            on_warning: str = "log",
        ) -> Any:
            nonlocal number
            name = f"scene{number}"
            number += 1
            if isinstance(scene, str) and "\n" in scene:
                text, scene = scene, tmp_path / f"{name}.py"
                scene.write_text(script_of_text(text, elsewhere=sockets), encoding="utf-8")
            if seed is not None:
                options = (*options, f"--seed={seed}")
            complaints = errors if on_failure == "raise" else []
            if not sockets:
                given = {"strict": strict, "on_failure": on_failure, "on_warning": on_warning}
                return _load(scene, options, given, endings, complaints)
            if callable(scene):
                function, scene = scene, tmp_path / f"{name}.py"
                scene.write_text(script_of_function(function), encoding="utf-8")
            words = ["--headless", *(["--strict-commands"] if strict else []), *options]
            words += ["--strict"] if on_warning == "raise" else []
            return _start(Path(scene), tmp_path / f"{name}.log", words, endings, complaints)

        yield start


def _start(script: Path, log: Path, options: list[str], endings: contextlib.ExitStack, errors: list[str]) -> Morse:
    process = SimulationProcess(script, log, options=options)
    try:
        process.wait_initialized()
        simu = Morse("127.0.0.1", process.port)
    except BaseException:
        process.kill()
        raise
    endings.callback(_end, process, simu, errors)
    return simu


def _end(process: SimulationProcess, simu: Morse, errors: list[str]) -> None:
    with contextlib.suppress(ConnectionError):
        simu.close(cancel_async_services=True)
    try:
        process.stop()
    except Exception as error:
        errors.append(str(error))
    if process.watch.error is not None:
        errors.append(f"the simulation reported an error: {process.watch.error}")


def _load(
    scene: Callable[[], object] | str | Path,
    options: tuple[str, ...],
    given: Options,
    endings: contextlib.ExitStack,
    errors: list[str],
) -> object:
    import morse

    simulation = morse.load(scene, **given, **_in_process(options))
    handler = _Errors(errors)
    logger = logging.getLogger("morse")
    logger.addHandler(handler)
    endings.callback(logger.removeHandler, handler)
    endings.callback(simulation.close)
    return simulation


def _in_process(options: tuple[str, ...]) -> Options:
    words = iter(options)
    settings: Options = {}
    for word in words:
        name, equals, value = word.partition("=")
        if name not in ("--seed", "--speed"):
            raise ValueError(f"a simulation without sockets takes the options --seed and --speed, not {word!r}")
        value = value if equals else next(words, "")
        settings[name[2:]] = int(value) if name == "--seed" else math.inf if value == "max" else float(value)
    return settings


class _Errors(logging.Handler):
    """Records the errors that a simulation reports."""

    def __init__(self, errors: list[str]) -> None:
        super().__init__(logging.ERROR)
        self._errors = errors

    def emit(self, record: logging.LogRecord) -> None:
        self._errors.append(f"the simulation reported an error: {record.getMessage()}")


def _fail_for(errors: list[str]) -> None:
    if errors:
        pytest.fail("\n".join(errors))
