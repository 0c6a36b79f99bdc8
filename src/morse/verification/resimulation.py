"""Simulates a recorded run again, and compares it with the recording message by message, bit for bit."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, NamedTuple

from morse.core.context import acting
from morse.core.observer import Observer
from morse.core.reports.quoting import short
from morse.launch.load import described, start
from morse.launch.recorded_run import complete, guard, options_of
from morse.physics import UnstableError
from morse.recording.streams import RecordedStreams
from morse.simulation.recordings.input_recording import ReplayError, shown_entry
from morse.simulation.recordings.recorders import machine_facts
from morse.verification.comparison import Comparison, Departure

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.recording.recording import Recording
    from morse.simulation.simulation import Simulation


class Outcome(NamedTuple):
    """The result of the comparison.

    Attributes:
        departure: the first difference; None if all messages are equal.
        ticks: number of compared ticks.
        messages: number of compared messages.
        complete: whether the recording contains its end, with the hash of the final state.
        failure: the reason why the physics diverged; empty if it did not.
        rounding: the largest difference by rounding, on another kind of processor; None if there is none.
        elsewhere: what differs between the places of both runs; empty if nothing that matters does.
    """

    departure: Departure | None
    ticks: int
    messages: int
    complete: bool
    failure: str = ""
    rounding: Departure | None = None
    elsewhere: str = ""


class _Departed(Exception):
    """The run differs from its recording: what follows says nothing."""


class _EachTick(Observer):
    """Publishes the messages of each tick as a whole, like a recorder."""

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
    recording: Recording,
    scene: str = "",
    say: Callable[[str], object] = print,
    record: str | None = None,
    *,
    trust: bool = False,
    projects: Sequence[str] = (),
) -> Outcome:
    """Simulate the scene of a recording again with its seed and its inputs.

    Args:
        recording: a recording of a run.
        scene: path of the scene script; empty for the recorded script.
        say: called with remarks for the user.
        record: path of a file in which the run is recorded, with all sensors.
        trust, projects: see `morse.launch.recorded_run.options_of`.

    Raises:
        RecordingError: the recording is not sufficient, or the new one cannot be written.
        MorseError: the scene cannot be loaded, or the inputs do not fit it.
    """
    with contextlib.ExitStack() as stack:
        options = options_of(recording, scene, trust, stack, say, projects)
        simulation = stack.enter_context(start(described(options.script, options), options))
        guard(simulation, described=False, trust=trust)
        return repeat(recording, simulation, record)


def repeat(recording: Recording, simulation: Simulation, record: str | None = None) -> Outcome:
    """Repeat a recorded run in a simulation of its scene; it can go on afterwards.

    Args:
        record: see `resimulate`.

    Raises:
        MorseError: see `resimulate`.
    """
    inputs = complete(recording, simulation)
    if inputs.start is not None:
        simulation.restore(inputs.start)
    copy = None if record is None else simulation.record(record)
    elsewhere = _elsewhere(recording)
    comparison = Comparison(recording, lambda: simulation.clock.tick, with_tolerance=bool(elsewhere))
    ticks = _Counter(simulation)
    with acting(simulation.context):
        streams = RecordedStreams(simulation.context, comparison, recording.sensors())
    observers = [_EachTick(streams, simulation), ticks]
    simulation.observers.extend(observers)

    def check() -> None:
        if comparison.departure is not None and copy is None:
            raise _Departed

    try:
        simulation.replay(inputs, check, results=not elsewhere)
    except _Departed:
        return Outcome(comparison.departure, ticks.count, comparison.count, False, elsewhere=elsewhere)
    except ReplayError as error:
        misfit = Departure(error.entry.tick, shown_entry(error.entry), error.how)
        if comparison.departure is not None and comparison.departure.tick <= misfit.tick:
            misfit = comparison.departure
        return Outcome(misfit, ticks.count, comparison.count, False, elsewhere=elsewhere)
    except UnstableError as error:
        return Outcome(comparison.departure, ticks.count, comparison.count, False, str(error), elsewhere=elsewhere)
    finally:
        with acting(simulation.context):
            streams.finalize()
        for observer in observers:
            if observer in simulation.observers:
                simulation.observers.remove(observer)
    if copy is not None:
        copy.stop()
    comparison.finish()
    departure, rounding = comparison.departure, comparison.rounding
    if departure is None and rounding is None:
        departure = _departed_state(recording, simulation)
    is_complete = "state" in recording.end
    return Outcome(departure, ticks.count, comparison.count, is_complete, "", rounding, elsewhere)


class _Counter(Observer):
    def __init__(self, simulation: Simulation) -> None:
        self._clock, self.count, self._last = simulation.clock, 0, simulation.clock.tick

    def after_tick(self) -> None:
        self.count += self._clock.tick != self._last
        self._last = self._clock.tick


def _elsewhere(recording: Recording) -> str:
    """What decides rounding and differs between the machine of a recording and this one."""
    here = machine_facts()
    differences = [
        f"{name} {short(recording.facts[name])}, here {value}"
        for name, value in here.items()
        if recording.facts.get(name, value) != value
    ]
    return "; ".join(differences)


def _departed_state(recording: Recording, simulation: Simulation) -> Departure | None:
    digest = recording.end.get("state")
    if digest in (None, simulation.state_hash()):
        return None
    return Departure(simulation.ticks, "the state", "it has another hash, and nothing that was recorded shows it")
