"""Starts recordings of a simulation, and collects the data that determine the run."""

from __future__ import annotations

import base64
import contextlib
import json
import logging
import os
import platform
import shlex
import stat
import tempfile
from contextlib import suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from morse.core import status
from morse.core.classes.project_imports import ProjectImports
from morse.core.journal import OUTCOME, RESET, RESTORE
from morse.core.observer import SHOWN, Observer
from morse.core.reports.quoting import nearest
from morse.core.state import StateError
from morse.kernel import threads
from morse.recording.errors import RecordingError
from morse.recording.inputs import TOPIC as INPUTS
from morse.recording.inputs import TYPE as INPUTS_TYPE
from morse.recording.inputs import as_message
from morse.recording.mcap.records import Message
from morse.recording.mcap.writer import McapWriter
from morse.rosmsgs.definitions import definition
from morse.simulation.recordings.input_recording import entry_to_bytes, kept, waiting_to_bytes
from morse.simulation.states.saving import InputsState
from morse.system.regular_files import read_regular
from morse.version import __version__

if TYPE_CHECKING:
    from collections.abc import Sequence
    from io import FileIO

    from morse.core.journal import Entry
    from morse.recording.recorder import Beginning, Recorder
    from morse.simulation.simulation import Simulation
    from morse.simulation.states.state import State


logger = logging.getLogger(__name__)

#: names of files in a recording; a prefix of the paths of project modules
SCRIPT, STATE, MODULES = "scene.py", "start.morse-state", "modules/"
#: maximum size of a script or a module, bytes
_LARGEST = 4 << 20


def start_recording(
    simulation: Simulation, path: str | os.PathLike[str], sensors: Sequence[str] | None = None
) -> Recorder:
    """Start a recording.

    Raises:
        RecordingError: the file exists or cannot be written, or there is no such sensor.
    """
    # the messages of recordings are loaded when a simulation records
    from morse.recording.recorder import Recorder

    sensor_names = [component.name for component in simulation.scene.components if component.kind == "sensor"]
    for name in sensors or ():
        if name not in sensor_names:
            raise RecordingError(f"there is no sensor '{name}' to record{nearest(name, sensor_names)}")
    recorder = Recorder(simulation.context, path, _beginning(simulation, sensors), sensors)

    def ended() -> None:
        simulation.recorders.remove(recorder)
        simulation.observers.remove(recorder)

    recorder.on_end = ended
    simulation.recorders.append(recorder)
    simulation.observers.append(recorder)
    return recorder


def write_inputs(
    file: FileIO,
    simulation: Simulation,
    start: State | None,
    seed: int,
    life: int,
    entries: Sequence[Entry],
    last: int,
    failure: str,
) -> None:
    """Write a recording with the data that determine a failed run, without messages of sensors.

    Args:
        file: file that was opened for writing without a buffer.
        start: the state at the beginning; None for the state after the launch.
        seed: seed of the random numbers at the beginning.
        life: number of restarts before.
        entries: the inputs.
        last: the tick of the failure.
        failure: description of the failure.

    Raises:
        OSError: the file cannot be written.
    """
    from morse.recording.recorder import BEGINNING, END, FORMAT, MEDIA_TYPE, PRESENT

    beginning = _beginning(simulation, ())
    writer = McapWriter(file)
    writer.metadata(
        BEGINNING,
        {
            FORMAT: str(PRESENT),
            **beginning.facts,
            "seed": str(seed),
            "tick": str(start.tick if start else 0),
            "life": str(life),
        },
    )
    for name, data in beginning.files.items():
        if name != STATE:
            writer.attachment(name, MEDIA_TYPE, data)
    if start is not None:
        writer.attachment(STATE, MEDIA_TYPE, start.to_bytes())
    number = writer.channel(INPUTS, writer.schema(INPUTS_TYPE, definition(INPUTS_TYPE)), {})
    writer.chunk(
        [
            Message(number, entry.tick & 0xFFFFFFFF, order, order, as_message(entry, entry_to_bytes, _tell_lost))
            for order, entry in enumerate(entries)
        ]
    )
    writer.metadata(END, {"tick": str(last), "failure": failure})
    writer.finish()


def machine_facts() -> dict[str, str]:
    """Return what decides the last bit of numbers, by name: kind of processor, and versions of packages."""
    versions = {name: _version(name) for name in ("mujoco-core", "numpy")}
    return {"processor": threads.kind(), "python": platform.python_version(), **versions}


def _beginning(simulation: Simulation, sensors: Sequence[str] | None) -> Beginning:
    from morse.recording.recorder import Beginning

    options, project = simulation.options, simulation.scene.project
    facts = {
        "morse": __version__,
        "platform": f"{platform.system()} {platform.machine()}",
        **machine_facts(),
        "seed": str(simulation.seed()),
        "frequency": repr(simulation.clock.frequency),
        "environment": simulation.scene.environment,
        "tick": str(simulation.ticks),
        "origin": str(round(simulation.clock.origin * 1e9)),
        "life": str(simulation.journal.life),
        "script": options.script and os.path.abspath(options.script),
        "arguments": json.dumps(options.arguments),
        "source_paths": json.dumps([os.path.abspath(path) for path in options.source_paths]),
        "resource_paths": json.dumps([os.path.abspath(path) for path in options.resource_paths]),
        "strict": str(options.strict),
        "sensors": "all" if sensors is None else json.dumps(list(sensors)),
    }
    files: dict[str, bytes] = {}
    if options.script.endswith(".py"):
        files |= _source(SCRIPT, options.script)
    if isinstance(project, ProjectImports):
        for module, file in sorted(project.sources().items()):
            files |= _source(f"{MODULES}{module}.py", file)
    if not simulation.is_new:
        files[STATE] = simulation.silent_state().to_bytes()
    population = simulation.population
    scene = population.scene_at_launch()
    return Beginning(facts, files, entry_to_bytes, lambda: _ending(simulation), population.made, scene)


def _tell_lost(error: ValueError) -> None:
    logger.warning(
        "%s: the last seconds cannot be simulated again. Spawn it by the name of a robot or by a file instead", error
    )


def _ending(simulation: Simulation) -> dict[str, str]:
    waiting = waiting_to_bytes(InputsState(simulation).get_state())
    facts = {"tick": str(simulation.ticks), "waiting": base64.b64encode(waiting).decode()}
    with suppress(StateError):  # the state of a component of the user is not available
        facts["state"] = simulation.silent_state().hash()
    return facts


def _source(name: str, path: str) -> dict[str, bytes]:
    """A file by its name in the recording; nothing if it can no longer be read."""
    try:
        return {name: read_regular(path, _LARGEST)}
    except OSError:
        return {}


@cache
def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


# Keeps the data for simulating the last seconds before a failure again.

#: maximum number of inputs; with more inputs, the time before the failure is shorter
_MOST_INPUTS = 100_000
#: interval of retries for a simulation whose state cannot be saved, ticks
_NEVER = 2**62
#: maximum number of files of one run
_MOST_FILES = 3


#: maximum number of files of all runs of a user; a new file replaces the oldest one
_MOST_OF_USER = 10
_PREFIX, _SUFFIX = "morse-failure-", ".mcap"


class _Segment(NamedTuple):
    """The time from one state to the next.

    Attributes:
        start: the state at the beginning; None for the state after the launch, or after a reset.
        seed: seed of the random numbers.
        life: number of restarts before.
        entries: the inputs since then.
    """

    start: State | None
    seed: int
    life: int
    entries: list[Entry]


class FlightRecorder(Observer):
    """Keeps states and inputs; after a failure they are written to a file, whose name is logged.

    With the scene, a state and the inputs after it determine the run: ``morse replay FILE --resimulate`` simulates the
    seconds before the failure again, any number of times.

    Args:
        simulation: the simulation.
        span: minimum number of simulated seconds before a failure, if the run was long enough.
    """

    def __init__(self, simulation: Simulation, span: float) -> None:
        self._simulation = simulation
        # with three states or more, at least two whole segments have passed
        self._every = max(1, round(span / 2 * simulation.clock.frequency))
        self._segments: list[_Segment] = []
        self._reports: set[str] = set()
        self._files = 0
        #: number of the last state that was restored
        self._restored = -1
        self._begin_anew()
        simulation.journal.sinks.append(self._take)

    def _take(self, entry: Entry) -> None:
        if entry.kind == RESET:
            return
        if entry.kind == RESTORE:
            self._restored, self._anew = entry.order, True  # the next segment begins there
        elif entry.kind == OUTCOME and entry.content[:2] == (self._restored, status.FAILED):
            self._anew = False
        segment = self._segments[-1]
        segment.entries.append(kept(entry))
        if len(segment.entries) >= _MOST_INPUTS // 2:
            self._full = True

    def _begin_anew(self) -> None:
        self._segments.clear()
        self._add()

    def _add(self) -> None:
        simulation = self._simulation
        self._full = self._anew = False
        self._began = simulation.ticks
        try:
            start = None if simulation.is_new else simulation.silent_state()
        except StateError as error:
            logger.debug("the last seconds before a failure cannot be saved: %s", error)
            self.close()
            self._segments.clear()
            self._every = _NEVER
            return
        self._segments = [*self._segments[-2:], _Segment(start, simulation.seed(), simulation.journal.life, [])]

    def after_tick(self) -> None:
        """Save a state if one is due; check whether a component has failed."""
        failures = self._simulation.context.failed
        if len(failures) > len(self._reports):
            names = ", ".join(sorted(failures - self._reports))
            self._reports = set(failures)
            self.write(f"{names} failed", self._simulation.ticks)
        if self._simulation.ticks - self._began >= self._every or self._full:
            self._add()

    def restarted(self) -> None:
        """The simulation was restarted: time begins at 0."""
        self._reports.clear()
        self._begin_anew()

    def edited(self) -> None:
        """A class was replaced: earlier ticks cannot be simulated again."""
        self._begin_anew()

    def rearranged(self) -> None:
        """Called when another state was restored, or objects were added or removed."""
        if self._anew and not self._simulation.journal.rebirths:
            self._begin_anew()

    def write(self, failure: str, last: int) -> str | None:
        """Write a file, and log its name.

        Args:
            failure: description of the failure.
            last: the tick in which it failed.

        Returns:
            The path; None if there are enough files, or if it cannot be written.
        """
        if self._files >= _MOST_FILES or not self._segments:
            return None
        self._files += 1
        first = self._segments[0]
        entries = [entry for segment in self._segments for entry in segment.entries]
        ticks = last - (first.start.tick if first.start is not None else 0)
        try:
            # on demand, because it imports the messages of ROS
            handle, path = tempfile.mkstemp(prefix=_PREFIX, suffix=_SUFFIX)
            with open(handle, "wb", buffering=0) as file:
                write_inputs(file, self._simulation, first.start, first.seed, first.life, entries, last, failure)
        except (OSError, ImportError) as error:  # without file descriptors, a module is not found
            reason = getattr(error, "strerror", None) or error
            logger.warning("the last seconds before the failure cannot be saved: %s", reason)
            return None
        _remove_old(path)
        span = _span(ticks, ticks / self._simulation.clock.frequency)
        script = self._script()
        command = f"morse replay {path} --resimulate{script}"
        # the failure itself is what a page announces
        logger.error("[ERROR][MORSE] %s in %s: %s", span, path, command, extra={SHOWN: True})
        return path

    def _script(self) -> str:
        """The option that permits `morse replay` to execute the scene script."""
        options = self._simulation.options
        if options.arguments:  # only those of a trusted file are used
            return " --trust"
        return f" --scene {shlex.quote(os.path.abspath(options.script))}" if options.script else " --scene SCRIPT"

    def close(self) -> None:
        """The end of the simulation."""
        if self._take in self._simulation.journal.sinks:
            self._simulation.journal.sinks.remove(self._take)


def _span(ticks: int, seconds: float) -> str:
    if seconds >= 1.0:
        return f"the last {seconds:.0f} s before the failure are"
    return f"the last {ticks} ticks before the failure are" if ticks > 1 else "the tick of the failure is"


def _remove_old(path: str) -> None:
    """Remove the oldest files of the user in the folder of a new file."""
    files: list[tuple[float, Path]] = []
    for other in Path(path).parent.glob(f"{_PREFIX}*{_SUFFIX}"):
        with contextlib.suppress(OSError):
            facts = other.lstat()
            is_own = not hasattr(os, "getuid") or facts.st_uid == os.getuid()
            if is_own and stat.S_ISREG(facts.st_mode) and other != Path(path):
                files.append((facts.st_mtime, other))
    for _, other in sorted(files)[: max(len(files) + 1 - _MOST_OF_USER, 0)]:
        # another run may have removed it, or may read it
        with contextlib.suppress(OSError):
            other.unlink()
