"""Runs a recorded simulation again, and compares it with the recording message by message, to the bit."""

from __future__ import annotations

import contextlib
import math
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from morse.core.context import acting
from morse.core.observer import Observer
from morse.launch.load import described, start
from morse.physics import UnstableError
from morse.recording.errors import RecordingError
from morse.recording.streams import RecordedStreams
from morse.simulation.input_recording import InputRecording, entry_from_bytes, waiting_from_bytes
from morse.simulation.options import RunOptions
from morse.simulation.recorders import MODULES, SCRIPT, STATE
from morse.simulation.state import State
from morse.verification.comparison import Comparison, Departure

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.recording.recording import Recording
    from morse.simulation.simulation import Simulation

_MOST_SEED = 2**63


class Outcome(NamedTuple):
    """What came of it.

    Attributes:
        departure: the first one; None if all is the same.
        ticks: that were compared.
        messages: that were compared.
        complete: whether the recording has its end, with the hash of the state there.
        failure: why the physics broke off; empty if it did not.
    """

    departure: Departure | None
    ticks: int
    messages: int
    complete: bool
    failure: str = ""


class _EachTick(Observer):
    """Lets the streams say what belongs to a tick as a whole, as a recorder does."""

    def __init__(self, streams: RecordedStreams, simulation: Simulation) -> None:
        self._streams, self._clock = streams, simulation.clock
        self._flushed = self._clock.tick

    def after_tick(self) -> None:
        if self._clock.tick != self._flushed:
            self._flushed = self._clock.tick
            self._streams.flush()

    def restarted(self) -> None:
        self.rearranged()

    def rearranged(self) -> None:
        self._flushed = self._clock.tick
        self._streams.follow()


def resimulate(
    recording: Recording, scene: str = "", told: Callable[[str], object] = print, record: str | None = None
) -> Outcome:
    """Run the scene of a recording again with its seed and its inputs.

    Args:
        recording: of a run.
        scene: path of the scene script; empty for the one that was recorded.
        told: takes remarks for people.
        record: path of a file in which the run is recorded, with all sensors.

    Raises:
        RecordingError: the recording does not say enough, or the new one cannot be written.
        MorseError: the scene cannot be loaded, or the inputs do not fit it.
    """
    inputs = _inputs(recording)
    with contextlib.ExitStack() as stack:
        options = _options(recording, scene, stack, told)
        simulation = stack.enter_context(start(described(options.script, options), options))
        if inputs.start is not None:
            simulation.restore(inputs.start)
        copy = None if record is None else simulation.record(record)
        comparison = Comparison(recording, lambda: simulation.clock.tick)
        sensors: Sequence[str] | None = recording.texts("sensors") or None
        ticks = _Counter(simulation)
        with acting(simulation.context):
            streams = RecordedStreams(simulation.context, comparison, sensors)
        simulation.observers.append(_EachTick(streams, simulation))
        simulation.observers.append(ticks)
        try:
            simulation.replay(inputs)
        except UnstableError as error:
            return Outcome(comparison.departure, ticks.count, comparison.count, False, str(error))
        if copy is not None:
            copy.stop()
        comparison.finish()
        departure = comparison.departure or _departed_state(recording, simulation)
        return Outcome(departure, ticks.count, comparison.count, "state" in recording.end)


class _Counter(Observer):
    def __init__(self, simulation: Simulation) -> None:
        self._clock, self.count, self._last = simulation.clock, 0, simulation.clock.tick

    def after_tick(self) -> None:
        self.count += self._clock.tick != self._last
        self._last = self._clock.tick


def _departed_state(recording: Recording, simulation: Simulation) -> Departure | None:
    wanted = recording.end.get("state")
    if wanted in (None, simulation.state_hash()):
        return None
    return Departure(simulation.ticks, "the state", "it has another hash, and nothing that was recorded shows it")


def _inputs(recording: Recording) -> InputRecording:
    state = recording.attachment(STATE)
    if state is None and recording.number("tick"):
        raise RecordingError(
            f"{recording.path} begins in the middle of a run, and the state at its beginning is missing"
        )
    waiting = recording.waiting()
    return InputRecording(
        recording.number("seed"),
        None if state is None else State.from_bytes(state),
        recording.last_tick(),
        [entry_from_bytes(one) for one in recording.inputs()],
        {} if waiting is None else waiting_from_bytes(waiting),
    )


def _options(
    recording: Recording, scene: str, stack: contextlib.ExitStack, told: Callable[[str], object]
) -> RunOptions:
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
        return options
    if not options.script:
        raise RecordingError(
            f"{recording.path}: the scene came from a function of a program; give a script that makes it: --scene PATH"
        )
    kept = recording.attachment(SCRIPT)
    if kept is not None and not _is_same(options.script, kept):
        told(f"{options.script} is not what it was when the run was recorded: the recorded script is taken.")
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        options.script = str(folder / Path(options.script).name)
        Path(options.script).write_bytes(kept)
    elif kept is None and not Path(options.script).is_file():
        raise RecordingError(f"{recording.path}: there is no scene {options.script} any more; give one: --scene PATH")
    _tell_changed_modules(recording, options, told)
    return options


def _tell_changed_modules(recording: Recording, options: RunOptions, told: Callable[[str], object]) -> None:
    for name in recording.attachments:
        if not name.startswith(MODULES):
            continue
        module = name.removeprefix(MODULES).removesuffix(".py").replace(".", "/")
        files = [Path(folder, f"{module}{end}") for folder in options.source_paths for end in (".py", "/__init__.py")]
        there = [file for file in files if file.is_file()]
        if there and not any(_is_same(str(file), recording.attachment(name) or b"") for file in there):
            told(f"{there[0]} is not what it was when the run was recorded.")


def _is_same(path: str, content: bytes) -> bool:
    try:
        return Path(path).read_bytes() == content
    except OSError:
        return False
