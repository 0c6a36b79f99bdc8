"""Reads from a recording what determines the run: the scene, the options and the inputs."""

from __future__ import annotations

import math
import os
import tempfile
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets.formats import SUFFIXES
from morse.core.journal import RESTORE, SPAWN, Entry
from morse.core.quoting import shown
from morse.recording.errors import RecordingError
from morse.recording.inputs import LostInput
from morse.recording.made.reading import RecordedMade
from morse.simulation.input_recording import InputRecording, entry_from_bytes, waiting_from_bytes
from morse.simulation.options import RunOptions
from morse.simulation.recorded_timeline import modules_of
from morse.simulation.recorders import MODULES, SCRIPT, STATE
from morse.simulation.state import State

if TYPE_CHECKING:
    import contextlib
    from collections.abc import Callable

    from morse.recording.recording import Recording
    from morse.simulation.simulation import Simulation

_MOST_SEED = 2**63
#: folders of a project with its modules and models
_FOLDERS = ("src", "data")


def inputs_of(recording: Recording, *, lenient: bool = False) -> InputRecording:
    """The inputs, and the initial state.

    Args:
        lenient: whether robots that were spawned by functions of a program are entries without content.

    Raises:
        MorseError: the inputs or the state are damaged.
    """
    state = recording.attachment(STATE)
    if state is None and recording.number("tick"):
        raise RecordingError(f"{recording.path} begins in the middle of a run, and the initial state is missing")
    waiting = recording.waiting()
    return InputRecording(
        recording.number("seed"),
        None if state is None else State.from_bytes(state),
        recording.last_tick(),
        [_entry(one) for one in recording.inputs(lenient=lenient)],
        {} if waiting is None else waiting_from_bytes(waiting),
    )


def _entry(one: bytes | LostInput) -> Entry:
    return Entry(one.tick, one.kind, one.name, None) if isinstance(one, LostInput) else entry_from_bytes(one)


def complete(recording: Recording, simulation: Simulation) -> InputRecording:
    """The inputs for a simulation of the recorded scene, with what creates the objects that functions spawned.

    Raises:
        MorseError: the inputs are damaged, or an object cannot be created again.
    """
    inputs = inputs_of(recording, lenient=True)
    made = RecordedMade(recording, partial(modules_of, simulation), exact=True)
    if made.is_empty:
        return inputs_of(recording)
    made.check()
    if inputs.start is not None:
        inputs.start = State(inputs.start.parts, makers=made.known(-1))
    inputs.entries[:] = [
        done for index, entry in enumerate(inputs.entries) if (done := _completed(entry, index, made)) is not None
    ]
    return inputs


def _completed(entry: Entry, index: int, made: RecordedMade) -> Entry | None:
    if entry.kind == RESTORE:
        return entry._replace(content=State(entry.content.parts, makers=made.known(index)))
    if entry.kind != SPAWN or entry.content is not None:
        return entry
    described = made.after(index).get(entry.name)
    # without a description, it was refused
    return None if described is None else entry._replace(content=(described, described.position, described.rotation))


def options_of(
    recording: Recording, scene: str, trust: bool, stack: contextlib.ExitStack, told: Callable[[str], object]
) -> RunOptions:
    """The options of a run of the recorded scene, without servers.

    Args:
        recording: a recording of a run.
        scene: path of the scene script; empty for the recorded script.
        trust: whether to execute the script in the recording if the script on the disk has changed. A recording from an
            untrusted source may execute any code.
        stack: removes temporary files when it is closed.
        told: callback for messages to the user.

    Raises:
        RecordingError: the recording does not contain the name of its scene, or its script is not trusted.
    """
    options = RunOptions(
        script=scene or recording.facts.get("script", ""),
        arguments=recording.texts("arguments"),
        source_paths=recording.texts("source_paths"),
        resource_paths=recording.texts("resource_paths"),
        sockets=False,
        view="none",
        open_browser=False,
        speed=math.inf,
        seed=recording.number("seed") % _MOST_SEED,
        strict=recording.facts.get("strict") == "True",
    )
    if scene:
        _check_folders(recording, options, trust)
        return options
    if not options.script:
        raise RecordingError(
            f"{recording.path}: the scene was created by a function of a program; give a script that creates it: "
            "--scene PATH"
        )
    kept = recording.attachment(SCRIPT)
    if not trust:
        _check_script(recording, options.script, kept)
        _check_folders(recording, options, trust)
    if kept is not None and not _is_same(options.script, kept):
        if not trust:
            raise RecordingError(
                f"{options.script} has changed since the run was recorded. To execute the script in the recording, "
                "which is a program, use --trust; to use another script, use --scene PATH"
            )
        told(f"{options.script} has changed since the run was recorded: the recorded script is used.")
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        options.script = str(folder / Path(options.script).name)
        Path(options.script).write_bytes(kept)
    elif kept is None and not Path(options.script).is_file():
        raise RecordingError(
            f"{recording.path}: the scene {options.script} does not exist any more; give a scene: --scene PATH"
        )
    _tell_changed_modules(recording, options, told)
    return options


def _check_script(recording: Recording, script: str, kept: bytes | None) -> None:
    """Refuse a script that the recording names, but that was not recorded on this machine.

    The sender of a file may name any program on the disk, or one that came with the file.
    """
    if kept is None and Path(script).suffix.lower() not in SUFFIXES:  # models are no programs
        raise RecordingError(
            f"{recording.path} names the script {shown(script)}, but does not contain it, so that it cannot be "
            "compared with the file; to execute the file, which is a program, use --scene PATH"
        )
    if not _is_here(script):
        raise RecordingError(
            f"{recording.path} names the script {shown(script)}, which is not a full path on this machine; to use a "
            "script of yours, use --scene PATH; to execute the script in the recording, which is a program, use --trust"
        )


def _check_folders(recording: Recording, options: RunOptions, trust: bool) -> None:
    """Refuse folders of modules that do not belong to the script: their modules come before all others."""
    for folder in () if trust else (*options.source_paths, *options.resource_paths):
        if not _is_of_project(folder, options.script):
            raise RecordingError(
                f"{recording.path} names the folder {shown(folder)}, which does not belong to the project of "
                f"{options.script}; modules in it are programs: to use them, use --trust"
            )


def _is_of_project(folder: str, script: str) -> bool:
    """Whether a folder is ``src`` or ``data`` of a project that contains the script."""
    if not _is_here(folder):
        return False
    real = Path(os.path.realpath(folder))
    return (
        real.name in _FOLDERS and bool(real.parent.name) and Path(os.path.realpath(script)).is_relative_to(real.parent)
    )


def _is_here(path: str) -> bool:
    """Whether a path is absolute and not on another machine, whose server would be told who the user is."""
    return os.path.isabs(path) and not path.startswith(("//", "\\\\")) and "\0" not in path


def _tell_changed_modules(recording: Recording, options: RunOptions, told: Callable[[str], object]) -> None:
    for name in recording.attachments:
        if not name.startswith(MODULES):
            continue
        module = name.removeprefix(MODULES).removesuffix(".py").replace(".", "/")
        files = [Path(folder, f"{module}{end}") for folder in options.source_paths for end in (".py", "/__init__.py")]
        there = [file for file in files if file.is_file()]
        if there and not any(_is_same(str(file), recording.attachment(name) or b"") for file in there):
            told(f"{there[0]} has changed since the run was recorded.")


def _is_same(path: str, content: bytes) -> bool:
    try:
        return Path(path).read_bytes() == content
    except OSError:
        return False
