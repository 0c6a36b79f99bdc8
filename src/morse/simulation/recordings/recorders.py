"""Starts recordings of a simulation, and collects the data that determine the run."""

from __future__ import annotations

import base64
import json
import logging
import os
import platform
from contextlib import suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING

from morse.core.classes.project_imports import ProjectImports
from morse.core.reports.hints import nearest
from morse.core.state import StateError
from morse.kernel import processor
from morse.recording.errors import RecordingError
from morse.recording.inputs import TOPIC as INPUTS
from morse.recording.inputs import TYPE as INPUTS_TYPE
from morse.recording.inputs import as_message
from morse.recording.mcap.records import Message
from morse.recording.mcap.writer import McapWriter
from morse.recording.recorder import BEGINNING, END, FORMAT, MEDIA_TYPE, PRESENT, Beginning, Recorder
from morse.rosmsgs.definitions import definition
from morse.simulation.recordings.input_recording import entry_to_bytes, waiting_to_bytes
from morse.simulation.states.own_state import InputsState
from morse.system.regular_files import read_regular
from morse.version import __version__

if TYPE_CHECKING:
    from collections.abc import Sequence
    from io import FileIO

    from morse.core.journal import Entry
    from morse.simulation.running import Running
    from morse.simulation.states.state import State

logger = logging.getLogger(__name__)

#: names of files in a recording; a prefix of the paths of project modules
SCRIPT, STATE, MODULES = "scene.py", "start.morse-state", "modules/"
#: maximum size of a script or a module, bytes
_LARGEST = 4 << 20


def start_recording(
    simulation: Running, path: str | os.PathLike[str], sensors: Sequence[str] | None = None
) -> Recorder:
    """Start a recording.

    Raises:
        RecordingError: the file exists or cannot be written, or there is no such sensor.
    """
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
    simulation: Running,
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
    return {"processor": processor.kind(), "python": platform.python_version(), **versions}


def _beginning(simulation: Running, sensors: Sequence[str] | None) -> Beginning:
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


def _ending(simulation: Running) -> dict[str, str]:
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
