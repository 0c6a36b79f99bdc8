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
import subprocess
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import pytest

from morse.builder.names.project_files import resource_folders
from morse.system import variables
from morse.testing.follow import unexpected
from morse.testing.process import SimulationProcess, morse_command
from morse.testing.scripts import is_text, script_of_function, script_of_text
from pymorse import Morse

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterator, Sequence

    from morse.core.values import Options

    #: starts a simulation and returns the connection to it
    Simulate = Callable[..., object]


_MODELS = "MORSE_RESOURCE_PATH"
#: time for the repetition of a run that is recorded, wall-clock seconds
_LONGEST = 300.0


@pytest.fixture
def simulate(tmp_path: Path, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[Simulate]:
    """Runs a scene when it is called: ``simulate(scene, *options, sockets=True)``.

    The scene is a function of a module, the path of a scene script, or the text of one: a text may leave out ``from
    morse.builder import *`` and ``env = Environment("empty")``. The options are those of ``morse run``. The simulation
    runs in a separate process on its own ports, and the result is a `pymorse.Morse`. With ``sockets=False`` it runs in
    the process of the test, without any port, and the result is the `morse.simulation.simulation.Simulation`, which has
    the same methods. Its time passes only while the test requests it, by ``step``, ``get``, ``sleep`` or the result of
    a service, and the only options are ``--seed`` and ``--speed``. ``seed=3`` is the same as ``"--seed", "3"``.

    Models are found in ``data`` of the project that contains the test.

    Every simulation ends with the test, which fails if the simulation reported an error, if a part of it was switched
    off by a fault, or if a robot has left the world. In the process of the test, ``step`` raises the error of a
    component that fails. With ``fails=["robot.gps"]`` these parts are expected to fail, and the test fails unless they
    do. With ``on_failure="deactivate"``, errors are only logged, as without tests. Unless ``strict`` is False, a
    command with an unknown field or a wrong type is an error. With ``on_warning="raise"``, a warning about the scene is
    an error.

    If the test fails, its simulations are repeated and recorded, in ``failed_simulations``.
    """
    # scenes of functions and texts are written to other folders
    folders = [*variables.paths(_MODELS), *resource_folders(request.path)[:-1]]
    if folders:
        monkeypatch.setenv(_MODELS, os.pathsep.join(folders))
    runs: list[_Run] = []
    number = 0

    def start(
        scene: Callable[[], object] | str | Path,
        *options: str,
        sockets: bool = True,
        seed: int | None = None,
        strict: bool = True,
        on_failure: str = "raise",
        on_warning: str = "log",
        fails: Sequence[str] = (),
    ) -> Any:
        nonlocal number
        name = f"scene{number}"
        number += 1
        fails = [fails] if isinstance(fails, str) else list(fails)
        if isinstance(scene, str) and is_text(scene):
            text, scene = scene, tmp_path / f"{name}.py"
            scene.write_text(script_of_text(text, elsewhere=sockets), encoding="utf-8")
        if seed is not None:
            options = (*options, f"--seed={seed}")
        run: _Run
        if not sockets:
            settings = _in_process(options) | {"strict": strict, "on_warning": on_warning}
            run = _Inside(scene, settings, "deactivate" if fails else on_failure)
        else:
            if callable(scene):
                function, scene = scene, tmp_path / f"{name}.py"
                scene.write_text(script_of_function(function), encoding="utf-8")
            words = ["--headless", *(["--strict-commands"] if strict else []), *options]
            words += ["--strict"] if on_warning == "raise" else []
            run = _Beside(Path(scene), tmp_path / name, words, fails)
        run.fails = None if on_failure == "deactivate" else fails
        runs.append(run)
        return run.simulation

    yield start
    has_failed = request.node.stash.get(_FAILED, False)
    wrong = [line for run in reversed(runs) for line in run.end(has_failed)]
    if runs and (wrong or has_failed):
        recordings = "\n".join(_recorded(runs, folder_of(request.node)))
        if wrong:
            pytest.fail("\n".join([*wrong, recordings]))
        # it is shown with the failure
        request.node.add_report_section("teardown", "simulation", recordings)


class _Run(Protocol):
    """A simulation of a test.

    Attributes:
        simulation: what the test uses.
        fails: names of the parts that are expected to fail; None if nothing that fails counts.
    """

    simulation: Any
    fails: Sequence[str] | None

    def end(self, has_failed: bool) -> list[str]:
        """End the simulation of a test, and return what is wrong with it."""

    def repeat(self, path: Path) -> str:
        """Repeat the run that has ended, and record it; return a remark about the recording."""


class _Beside:
    """A simulation in a process of its own.

    Args:
        script: the scene script.
        files: path of its files, without a suffix.
        options: options of ``morse run``.
        fails: names of the parts that are expected to fail.
    """

    fails: Sequence[str] | None = ()

    def __init__(self, script: Path, files: Path, options: list[str], fails: Sequence[str]) -> None:
        self._script, self._inputs = script, files.with_suffix(".mcap")
        if not any(option.partition("=")[0] == "--record" for option in options):
            options = [*options, "--record", str(self._inputs), "--record-only", "none"]
        self._process = SimulationProcess(script, files.with_suffix(".log"), options=options, fails=fails)
        try:
            self._process.wait_initialized()
            self.simulation = Morse("127.0.0.1", self._process.port)
        except BaseException:
            self._process.kill()
            raise

    def end(self, has_failed: bool) -> list[str]:
        wrong = []
        with contextlib.suppress(ConnectionError):
            self.simulation.close(cancel_async_services=True)
        try:
            self._process.stop()
        except Exception as error:
            wrong.append(str(error))
        return [] if self.fails is None else wrong + unexpected(self._process.watch.errors, self.fails)

    def repeat(self, path: Path) -> str:
        if not self._inputs.is_file():
            return "none: the simulation has not recorded its inputs"
        words = ["replay", "--resimulate", "--trust", "--scene", self._script, "--record", path, self._inputs]
        done = subprocess.run(
            [*morse_command(), *map(str, words)],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            timeout=_LONGEST,
            check=False,
        )
        said = (done.stderr.strip() or done.stdout.strip()).rpartition("\n")[2]
        return f"{path}" if not done.returncode else f"{path if path.is_file() else 'none'}: {said}"


class _Inside:
    """A simulation in the process of the test.

    Args:
        scene: a scene as for `morse.load`.
        settings: arguments of `morse.load`.
        on_failure: another one, for the run of the test.
    """

    fails: Sequence[str] | None = ()

    def __init__(self, scene: Callable[[], object] | str | Path, settings: Options, on_failure: str) -> None:
        import morse

        self._load = partial(morse.load, scene, **settings)
        self.simulation = self._load(on_failure=on_failure)
        self._inputs = self.simulation.record_inputs()
        self._state = ""
        self._errors = _Errors()
        logging.getLogger("morse").addHandler(self._errors)

    def end(self, has_failed: bool) -> list[str]:
        errors, simulation = self._errors.lines, self.simulation
        self._inputs.stop()
        if has_failed and not simulation.finished:
            self._state = simulation.state_hash()
        try:
            simulation.close()
        except Exception as error:
            errors.append(f"{type(error).__name__}: {error}")
        finally:
            logging.getLogger("morse").removeHandler(self._errors)
        errors += [str(failure) for failure in simulation.failures if failure.kind == "fallen"]
        return [] if self.fails is None else unexpected(errors, self.fails)

    def repeat(self, path: Path) -> str:
        remark = ""
        with self._load(record=path) as again:
            try:
                again.replay(self._inputs.recording)
            except Exception as error:
                remark = f": it ends with {type(error).__name__}: {error}"
            else:
                if self._state and again.state_hash() != self._state:
                    remark = ": its end differs, because the test did more than to send commands and to call services"
        return f"{path}{remark}"


class _Errors(logging.Handler):
    """Records the errors that a simulation reports."""

    def __init__(self) -> None:
        super().__init__(logging.ERROR)
        self.lines: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.lines.append(record.getMessage())


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


# -- recordings of tests that fail ------------------------------------------------------------------------

_FAILED = pytest.StashKey[bool]()


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, Any, None]:
    """Take note of a test that has failed."""
    outcome = yield
    if outcome.get_result().failed:
        item.stash[_FAILED] = True


def folder_of(item: pytest.Item) -> Path:
    """Make the folder for the recordings of a test, and return it."""
    name = "".join(letter if letter.isalnum() else "_" for letter in item.name)
    folder = Path(item.config.rootpath) / "failed_simulations" / name
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _recorded(runs: Sequence[_Run], folder: Path) -> Iterator[str]:
    """Repeat simulations that have ended, and return a line about the recording of each."""
    for number, run in enumerate(runs):
        path = folder / f"scene{number}.mcap"
        path.unlink(missing_ok=True)
        try:
            remark = run.repeat(path)
        except Exception as error:  # the failure of the test is more important
            remark = f"none: {type(error).__name__}: {error}"
        yield f"recording: {remark}"
