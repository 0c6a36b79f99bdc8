"""Reads from a recording what determines the run: the scene, the options and the inputs."""

from __future__ import annotations

import logging
import math
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from morse.assets.search import resource_dirs
from morse.core.exceptions import MorseBuilderError, MorseError
from morse.core.journal import EDIT, RESTORE, SPAWN, Entry
from morse.core.reports.quoting import quoted, shown
from morse.launch.load import described, start
from morse.launch.recorded_scripts import (
    is_same,
    show_trusted,
    take_trusted_options,
    use_named,
    use_registered,
    use_trusted,
)
from morse.recording.errors import RecordingError
from morse.recording.inputs import LostInput
from morse.recording.made.reading import RecordedMade
from morse.services.foreign_models import check_model
from morse.simulation.options import RunOptions
from morse.simulation.recordings.input_recording import InputRecording, entry_from_bytes, waiting_from_bytes
from morse.simulation.recordings.recorders import MODULES, STATE
from morse.simulation.recordings.timeline import RecordedTimeline, SimulatedTimeline, Timeline, modules_of
from morse.simulation.states.state import State

if TYPE_CHECKING:
    import contextlib
    from collections.abc import Callable, Sequence

    from morse.recording.recording import Recording
    from morse.scene import Scene
    from morse.simulation.simulation import Simulation


logger = logging.getLogger(__name__)

_MOST_SEED = 2**63


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
    unread = recording.waiting()
    return InputRecording(
        recording.number("seed"),
        None if state is None else State.from_bytes(state),
        recording.last_tick(),
        [_entry(one) for one in recording.inputs(lenient=lenient)],
        {} if unread is None else waiting_from_bytes(unread),
        recording.number("life") if "life" in recording.facts else 0,
    )


def _entry(one: bytes | LostInput) -> Entry:
    if isinstance(one, LostInput):
        return Entry(one.tick, one.kind, one.name, None, life=one.life, order=one.order)
    return entry_from_bytes(one)


def complete(recording: Recording, simulation: Simulation, *, described: bool = False) -> InputRecording:
    """The inputs for a simulation of the recorded scene, with what creates the objects that functions spawned.

    Args:
        described: whether the scene is that which the recording describes: all spawned objects are created from
            descriptions then.

    Raises:
        MorseError: the inputs are damaged, or an object cannot be created again.
    """
    inputs = inputs_of(recording, lenient=True)
    products = RecordedMade(recording, partial(modules_of, simulation), exact=True, all_kinds=described)
    refused = inputs.refused()
    for entry in inputs.entries:
        if products.is_empty and entry.kind == SPAWN and entry.content is None and entry.order not in refused:
            raise LostInput(entry.tick, entry.kind, entry.name, entry.life, entry.order)
    products.check()
    if inputs.start is not None:
        inputs.start = State(inputs.start.parts, makers=products.known(-1))
    inputs.entries[:] = [
        completed
        for index, entry in enumerate(inputs.entries)
        if (completed := _completed(entry, index, products)) is not None
    ]
    return inputs


def _completed(entry: Entry, index: int, products: RecordedMade) -> Entry | None:
    if entry.kind == RESTORE:
        return entry._replace(content=State(entry.content.parts, makers=products.known(index)))
    described = products.after(index).get(entry.name)
    if entry.kind != SPAWN or (entry.content is not None and described is None):
        return entry
    # without a description, it was refused
    return None if described is None else entry._replace(content=(described, described.position, described.rotation))


def guard(simulation: Simulation, *, described: bool, trust: bool) -> None:
    """Refuse models that the inputs of a recording name, except those that clients may spawn.

    Args:
        described: whether no model is opened, because the recording describes all objects.
        trust: whether any model may be opened.
    """

    def check(kind: str) -> None:
        try:
            if described:
                raise MorseBuilderError(f"the recording does not describe the object of the kind {quoted(kind)}")
            check_model(kind, [*simulation.scene.resource_paths, *resource_dirs()])
        except MorseError as error:
            logger.warning("an object is not spawned: %s", error)
            raise MorseBuilderError(str(error)) from None

    if not trust:
        simulation.population.check_kind = check


def options_of(
    recording: Recording,
    scene: str,
    trust: bool,
    stack: contextlib.ExitStack,
    say: Callable[[str], object],
    projects: Sequence[str] = (),
) -> RunOptions:
    """The options of a run of the recorded scene, without servers.

    A script is a program, and the sender of a file may name any program on the disk, one that came with the file, and
    any arguments. Without ``trust``, only a script is used that the user names, or the recorded one if it is a scene in
    the folder of a project that the user has registered; and no arguments or folders of the file.

    Args:
        recording: a recording of a run.
        scene: path of the scene script; empty for the recorded script.
        trust: whether to execute the script that the recording names, or the script in the recording if that on the
            disk has changed, with the recorded arguments. A recording from an untrusted source may execute any code.
        stack: removes temporary files when it is closed.
        say: callback for messages to the user.
        projects: folders of the environments that the user has registered.

    Raises:
        RecordingError: the recording does not contain the name of its scene, or its script is not trusted.
    """
    options = plain_options(recording)
    if scene:
        use_named(recording, options, scene, projects)
        if trust:
            take_trusted_options(recording, options)
            show_trusted(scene, options, False, say)
    elif trust:
        use_trusted(recording, options, stack, say)
    else:
        use_registered(recording, options, projects)
    arguments = recording.texts("arguments")
    if arguments and not trust:
        say(f"The script does not get the arguments of the recorded run, {shown(arguments)}; --trust passes them.")
    _tell_changed_modules(recording, options, say)
    return options


def plain_options(recording: Recording) -> RunOptions:
    """Options without a script and without servers."""
    return RunOptions(
        sockets=False,
        view="none",
        open_browser=False,
        speed=math.inf,
        seed=recording.number("seed") % _MOST_SEED,
        strict=recording.facts.get("strict") == "True",
        keep_going=True,  # what has ended the recorded run is no finding of a comparison
    )


def _tell_changed_modules(recording: Recording, options: RunOptions, say: Callable[[str], object]) -> None:
    for name in recording.attachments:
        if not name.startswith(MODULES):
            continue
        words = name.removeprefix(MODULES).removesuffix(".py").split(".")
        if not all(word.isidentifier() for word in words):
            continue
        module = "/".join(words)
        files = [Path(folder, f"{module}{end}") for folder in options.source_paths for end in (".py", "/__init__.py")]
        there = [file for file in files if _is_file(file)]
        if there and not any(is_same(str(file), recording.attachment(name) or b"") for file in there):
            say(f"{there[0]} has changed since the run was recorded.")


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except ValueError:  # a character that no path has
        return False


# The scene of a recorded run that is shown: that which the recording describes, else that of a script.


class ShownScene(NamedTuple):
    """A scene, and how it is run.

    Attributes:
        is_described: whether the recording describes the scene, so that no script was executed.
    """

    scene: Scene
    options: RunOptions
    is_described: bool


def shown_scene(
    recording: Recording,
    inputs: InputRecording,
    scene: str,
    trust: bool,
    stack: contextlib.ExitStack,
    say: Callable[[str], object],
    projects: Sequence[str] = (),
) -> ShownScene:
    """The scene of a recording, without servers.

    Args:
        inputs: of the recording.
        scene, trust, stack, told, projects: see `morse.launch.recorded_run.options_of`.

    Raises:
        RecordingError: the recording is damaged; or it does not describe its scene, and its script is not trusted.
    """
    reason = "" if scene else _lack(recording, inputs)
    if not scene and not reason:
        # what is simulated again needs the behaviour of each component
        products = RecordedMade(recording, tuple, exact=not RecordedTimeline.is_possible(recording, inputs))
        try:
            return ShownScene(products.scene(), plain_options(recording), True)
        except RecordingError as error:
            if RecordedTimeline.is_possible(recording, inputs):
                raise
            reason = f"The recording contains only the inputs of the run, which has to be simulated again, and {error}"
    try:
        options = options_of(recording, scene, trust, stack, say, projects)
    except RecordingError as error:
        raise RecordingError(f"{error}. {reason}") from None
    return ShownScene(described(options.script, options), options, False)


def _lack(recording: Recording, inputs: InputRecording) -> str:
    """Why a recording needs a script to be shown; empty if it does not."""
    edited = next((entry.name for entry in inputs.entries if entry.kind == EDIT), None)
    if edited is not None:
        return f"The recording alone cannot be shown, because {quoted(edited)} was edited during the run"
    if not RecordedMade.describe_the_scene(recording):
        return "The recording is of an earlier version or of a failure: it contains no meshes, materials and components"
    return ""


# A recorded run, ready to be gone through: for films and for pages without a server.


def timeline_of(
    recording: Recording,
    stack: contextlib.ExitStack,
    scene: str,
    say: Callable[[str], object],
    *,
    trust: bool,
    projects: Sequence[str] = (),
) -> tuple[Simulation, Timeline]:
    """The simulation of the scene of a recording, and its run: the recorded poses or, without them, the inputs.

    Args:
        recording: recording of the run.
        stack: closes the simulation.
        scene: path of a scene script; empty for the scene that the recording describes, or else its script.
        say: callback for messages to the user.
        trust, projects: see `morse.launch.recorded_run.options_of`.

    Raises:
        MorseError: the run cannot be simulated again.
    """
    inputs = inputs_of(recording, lenient=True)
    view = shown_scene(recording, inputs, scene, trust, stack, say, projects)
    simulation = stack.enter_context(start(view.scene, view.options))
    guard(simulation, described=view.is_described, trust=trust)
    return simulation, timeline_in(simulation, recording, inputs, say, described=view.is_described)


def timeline_in(
    simulation: Simulation,
    recording: Recording,
    inputs: InputRecording,
    say: Callable[[str], object],
    *,
    described: bool,
) -> Timeline:
    """A recorded run in a simulation of its scene: the recorded poses or, without them, the inputs.

    Args:
        described: whether the recording describes the scene.

    Raises:
        MorseError: the run cannot be simulated again.
    """
    if RecordedTimeline.is_possible(recording, inputs):
        try:
            timeline = RecordedTimeline(simulation, recording, inputs, described=described)
            for name in timeline.lost:
                say(f"'{name}' was spawned by a function of a program, and is not shown.")
            return timeline
        except RecordingError as error:
            if described:
                raise
            say(f"{error}. The run is simulated again.")
    # simulating needs every input
    return SimulatedTimeline(simulation, complete(recording, simulation, described=described), recording.length())
