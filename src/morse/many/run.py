"""One run of a study."""

from __future__ import annotations

import contextlib
import hashlib
import json
import platform
import re
import signal
import threading
import time
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from morse.core.exceptions import MorseError
from morse.core.reports.faults import place, summary, user_frames
from morse.launch.load import load
from morse.many.values import plain
from morse.simulation.ticks.stepping import changes_owner
from morse.version import __version__

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator, Mapping, Sequence
    from contextlib import AbstractContextManager
    from types import FrameType

    from morse.core.guard import Failure
    from morse.core.values import Options
    from morse.many.scenes import SceneCache
    from morse.many.values import Row
    from morse.simulation.simulation import Simulation

#: wall-clock time between two attempts to end a run, s
_AGAIN = 1.0
#: until the lines are over in which a run must not be ended, s
_SOON = 0.001


class RunTimeout(KeyboardInterrupt):
    """A run has taken longer than its limit; ``except Exception`` in the code of a user does not catch it."""


@contextlib.contextmanager
def limited(seconds: float | None) -> Iterator[None]:
    """Raise `RunTimeout` in the body if it takes longer, in the main thread of a process on systems with signals."""
    if seconds is None or threading.current_thread() is not threading.main_thread() or not hasattr(signal, "setitimer"):
        yield
        return

    def end(_signal: int, frame: FrameType | None) -> None:
        if changes_owner(frame):
            signal.setitimer(signal.ITIMER_REAL, _SOON, _AGAIN)
            return
        raise RunTimeout(f"the run has taken longer than {seconds:g} s of wall-clock time")

    before = signal.signal(signal.SIGALRM, end)
    signal.setitimer(signal.ITIMER_REAL, seconds, _AGAIN)
    try:
        yield
    except RunTimeout:
        # the end of a simulation takes its time, too
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        raise
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


#: columns of each row, besides the parameters and results
RESERVED = (
    "run", "seed", "hash", "ticks", "wall", "cpu", "error", "where", "recording", "same", "left_world",
    "machine", "processor", "versions",
)  # fmt: skip


class Run(NamedTuple):
    """One run of a study.

    Attributes:
        name: see `name_of`.
        parameters: value of each parameter.
        seed: seed of its simulation.
    """

    name: str
    parameters: Row
    seed: int


class Task(NamedTuple):
    """One run, and the path of its recording or None."""

    run: Run
    record: str | None = None


def name_of(identity: Row, parameters: Row, seed: int) -> str:
    """Return the name of a run: the first twelve digits of the SHA-256 of all that it depends on.

    Args:
        identity: what all runs of the study have in common, see `morse.many.study.Study.identity`.
    """
    inputs = json.dumps([identity, parameters, seed], sort_keys=True)
    return hashlib.sha256(inputs.encode()).hexdigest()[:12]


class Runs(Protocol):
    """What does runs: `morse.many.study.Study`."""

    options: Options
    timeout: float | None

    @property
    def axes(self) -> Mapping[str, Sequence[Any]]:
        """The values of each parameter."""

    @property
    def identity(self) -> Row:
        """What the results of all runs depend on."""

    def runs(self) -> Iterator[Run]:
        """All runs."""

    def scene_of(self, run: Run) -> Any:
        """Return the argument of `morse.load` for a run."""

    def scene_key(self, run: Run) -> str:
        """Return what runs with the same scene have in common."""

    def arguments_of(self, run: Run) -> list[str]:
        """Return the arguments of the scene script for a run."""

    def call(self, simulation: object, run: Run) -> Any:
        """Call the function of the study."""

    def description(self) -> Row | None:
        """Return the study as plain data, for another process; None if only this process has its functions."""


def run_once(
    study: Runs, run: Run, record: str | os.PathLike[str] | None = None, cache: SceneCache | None = None
) -> Row:
    """Do one run in this process.

    Args:
        record: path of a recording of the run.
        cache: where scenes are loaded that many runs have in common; None to load them anew.

    Returns:
        Its row. ``error`` is empty if the run has not failed, ``where`` is the line of the user's code that raised it.
    """
    row: Row = {
        "run": run.name, **run.parameters, "seed": run.seed, "hash": "", "ticks": 0, "error": "", "where": "",
        "recording": "", "same": None, "left_world": "", **machine_facts(),
    }  # fmt: skip
    begin, cpu = time.perf_counter(), time.process_time()
    try:
        with _simulation(study, run, None if record is not None or study.options else cache) as simulation:
            if record is not None:
                path = Path(record)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.unlink(missing_ok=True)
                simulation.record(path)
                row["recording"] = f"{path.parent.name}/{path.name}"
            try:
                with limited(study.timeout):
                    row |= _results(study.call(simulation, run), row)
            except RunTimeout as error:
                # it has ended anywhere in a tick: its state says nothing
                return row | _failure(error) | {"ticks": simulation.ticks} | _spent(begin, cpu)
            except (Exception, SystemExit) as error:
                row |= _failure(error)
            if not row["error"] and study.options.get("on_failure", "raise") == "raise":
                row |= _fault(simulation.failures)  # the function of the study may have caught its error
            row["left_world"] = ", ".join({one.part: None for one in simulation.failures if one.kind == "fallen"})
            row |= {"hash": simulation.state_hash(), "ticks": simulation.ticks}
    except (Exception, SystemExit) as error:
        row |= {} if row["error"] else _failure(error)
    return row | _spent(begin, cpu)


def _simulation(study: Runs, run: Run, cache: SceneCache | None) -> AbstractContextManager[Simulation]:
    scene, arguments = study.scene_of(run), study.arguments_of(run)
    if cache is not None:
        return cache.load(study.scene_key(run), scene, run.seed, arguments)
    return load(scene, seed=run.seed, arguments=arguments, **{"on_failure": "raise", **study.options})


def _spent(wall: float, cpu: float) -> dict[str, float]:
    return {"wall": time.perf_counter() - wall, "cpu": time.process_time() - cpu}


def _failure(error: BaseException) -> dict[str, str]:
    # a message for the user says where the mistake is: a line of MORSE adds nothing
    is_told = isinstance(error, MorseError) and not user_frames(error.__traceback__)
    return {"error": summary(error), "where": "" if is_told else place(error).strip()}


def _fault(failures: Sequence[Failure]) -> dict[str, str]:
    """The first part that was switched off, as the failure of a run."""
    for failure in failures:
        if failure.kind == "fault":
            return {"error": f"{failure.part} {failure.consequence}: {failure.cause}", "where": failure.where}
    return {}


def _results(returned: object, row: Row) -> Row:
    """The results of a run.

    Raises:
        TypeError: they are not plain data.
        ValueError: a result has the name of another column.
    """
    if returned is None:
        return {}
    if not isinstance(returned, dict):
        returned = {"result": returned}
    for name in returned:
        if name in row or name in RESERVED:
            raise ValueError(f"a result cannot be called '{name}': it is another column of the table")
    return {str(name): plain(value, f"the result '{name}'") for name, value in returned.items()}


#: what the columns of each row contain
_FACTS: dict[str, tuple[type, ...]] = {
    "run": (str,), "seed": (int,), "hash": (str,), "ticks": (int,), "wall": (int, float), "cpu": (int, float),
    "error": (str,), "where": (str,), "recording": (str,), "same": (bool, type(None)),
    "left_world": (str, type(None)), "machine": (str,), "processor": (str,), "versions": (str,),
}  # fmt: skip


def is_row(row: object) -> bool:
    """Whether a value from a file is a row of `run_once`.

    The name of the run and the recording become paths and addresses.
    """
    if not isinstance(row, dict) or not all(type(row.get(name)) in kinds for name, kinds in _FACTS.items()):
        return False
    is_named = re.fullmatch("[0-9a-f]{12}", row["run"]) and row["recording"] in ("", f"recordings/{row['run']}.mcap")
    try:
        plain(row, "a row")
    except (TypeError, ValueError):
        return False
    return bool(is_named)


def signature(row: Row) -> str:
    """Return the kind of the failure of a row: its error without numbers, and its place."""
    error, where = str(row["error"]), str(row.get("where", ""))
    return re.sub(r"[-+]?\d[\d.e+-]*", "#", error) + "\n" + where


def machine_facts() -> dict[str, str]:
    """Where and with what a run is done."""
    return {"machine": platform.node(), "processor": processor(), "versions": versions()}


@cache
def processor() -> str:
    """The kind of the processor; equal bits are promised for equal kinds."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8", errors="replace") as file:
            for line in file:
                if line.startswith("model name"):
                    return f"{platform.machine()} {line.partition(':')[2].strip()}"
    except OSError:
        pass
    return f"{platform.machine()} {platform.processor()}".strip()


@cache
def versions() -> str:
    """The versions of what determines the data."""
    return ", ".join(f"{name} {number}" for name, number in _versions(platform.python_version()).items())


def decisive_versions() -> dict[str, str]:
    """The versions with which another result is another run; all releases of Python 3.x give the same."""
    return _versions(".".join(platform.python_version_tuple()[:2]))


def _versions(python: str) -> dict[str, str]:
    return {"morse": __version__, "mujoco": version("mujoco-core"), "numpy": version("numpy"), "python": python}
