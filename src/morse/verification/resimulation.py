"""Simulates a recorded run again, and compares it with the recording message by message, bit for bit."""

from __future__ import annotations

import contextlib
import math
from collections import deque
from itertools import zip_longest
from typing import TYPE_CHECKING, Any, NamedTuple

from morse.core.context import acting
from morse.core.observer import Observer
from morse.core.reports.quoting import short
from morse.launch.load import described, start
from morse.launch.recorded_run import complete, guard, options_of
from morse.physics import UnstableError
from morse.recording.fields.poses import NODES, POSES
from morse.recording.fields.poses import TOPICS as MOTION
from morse.recording.inputs import TOPIC as INPUTS
from morse.recording.made.writing import TOPIC as MADE
from morse.recording.recorder import PRESENT
from morse.recording.streams import LEFT_OUT, RecordedStreams
from morse.rosmsgs.cdr import CdrError, decode
from morse.rosmsgs.topics.backend import Backend, Publisher, Subscription
from morse.simulation.recordings.input_recording import ReplayError, shown_entry
from morse.simulation.recordings.recorders import machine_facts

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from morse.recording.mcap.records import Message
    from morse.recording.recording import Recording
    from morse.rosmsgs.table import Qos
    from morse.simulation.simulation import Simulation


# Compares the published messages of a simulation with a recording, message by message.

#: the largest difference, relative to numbers above 1, that counts as rounding: contacts enlarge a last bit
_ROUNDING = 1e-6
#: topics that are not determined by scene, seed and inputs
_FREE = ("/rosout", INPUTS, MADE)


class Departure(NamedTuple):
    """The first difference between a run and its recording.

    Attributes:
        tick: counted since the last reset.
        what: the topic or the state.
        how: the recorded and the present value.
    """

    tick: int
    what: str
    how: str


class _Topic(Publisher):
    def __init__(self, compare: Callable[[bytes], object]) -> None:
        self._compare = compare

    def publish(self, data: bytes) -> bool:
        self._compare(data)
        return True

    def wanted(self) -> bool:
        return True

    def close(self) -> None:
        """Nothing is open."""


class Comparison(Backend):
    """Compares published messages with those of the file, topic by topic; within a tick, topics have no order."""

    name, opens = "comparison", "nothing"

    def __init__(self, recording: Recording, ticks: Callable[[], int], *, with_tolerance: bool = False) -> None:
        """Begin the comparison.

        Args:
            recording: the recording of the other run.
            ticks: returns the number of ticks since the last reset.
            with_tolerance: whether numbers may differ by rounding, see `rounding`.
        """
        self._rounded = with_tolerance
        #: the largest accepted difference by rounding; None if there is none
        self.rounding: Departure | None = None
        self._largest = 0.0
        self._channels = recording.channels
        self._complete = "state" in recording.end
        # earlier versions left out parts that moved later, and had the nodes in another order
        self._free = _FREE if recording.format == PRESENT else (*_FREE, NODES, POSES)
        free = recording.topic_numbers(*self._free) | recording.field_channels()
        self._expected = recording.messages({number for number in self._channels if number not in free})
        self._ticks = ticks
        #: messages of one tick that are in the file and were not published yet, by topic
        self._awaited: dict[str, deque[Message]] = {}
        self._next: Message | None = next(self._expected, None)
        self._topics = {channel.topic for channel in self._channels.values()}
        self.departure: Departure | None = None
        self.count = 0
        self._over = False

    def publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher | None:
        """See `Backend.publisher`; topics that are not in the recording are ignored again."""
        if topic in self._free:
            return _Topic(lambda data: None)
        # recordings of earlier versions have no poses of nodes
        if topic not in self._topics and (type_name in LEFT_OUT or topic in MOTION):
            return None
        return _Topic(lambda data: self._compare(topic, type_name, data))

    def _compare(self, topic: str, type_name: str, data: bytes) -> None:
        if self.departure is not None or self._over:
            return
        if not self._awaited:
            self._read_tick()
        if not self._awaited:
            self._over = True
            if self._complete:
                self._depart(topic, "the recording has no further message")
            return
        self.count += 1
        queue = self._awaited.get(topic)
        first = next(iter(self._awaited))
        tick = self._awaited[first][0].sequence
        if queue is None or tick != self._ticks() & 0xFFFFFFFF:
            if self._next is None and not self._complete and tick == self._ticks() & 0xFFFFFFFF:
                self._over = True  # the recording breaks off within this tick
                return
            self._depart(first, f"there is a message of tick {tick} in the recording, and {topic} comes now")
            return
        was = queue.popleft().data
        if not queue:
            del self._awaited[topic]
        if was != data and not (self._rounded and self._is_rounding(topic, type_name, was, data)):
            self._depart(topic, difference(type_name, was, data))

    def _is_rounding(self, topic: str, type_name: str, was: bytes, now: bytes) -> bool:
        """Whether two messages differ by rounding only; the largest difference is stored."""
        try:
            name, size = largest_difference(type_name, was, now)
        except (CdrError, ValueError, TypeError):
            return False
        if size > _ROUNDING:
            return False
        if size > self._largest:
            self._largest = size
            self.rounding = Departure(self._ticks(), topic, f"{name}, {size:.1e}")
        return True

    def _read_tick(self) -> None:
        """Read the messages of the next tick that has any."""
        while self._next is not None:
            topic, tick = self._channels[self._next.channel].topic, self._next.sequence
            self._awaited.setdefault(topic, deque()).append(self._next)
            self._next = next(self._expected, None)
            if self._next is None or self._next.sequence != tick:
                return

    def finish(self) -> None:
        """The end of the run: the file must not contain further messages."""
        if self.departure is not None or self._over:
            return
        if not self._awaited:
            self._read_tick()
        for awaited in self._awaited.values():
            rest = awaited[0]
            self._depart(self._channels[rest.channel].topic, f"the recording goes on, at tick {rest.sequence}")
            return

    def _depart(self, what: str, how: str) -> None:
        self.departure = Departure(self._ticks(), what, how)

    def subscription(self, topic: str, type_name: str, qos: Qos) -> Subscription | None:
        """Return None: a recording has no commands."""
        return None

    def close(self) -> None:
        """Do nothing, because the file is closed by its owner."""


def largest_difference(type_name: str, was: bytes, now: bytes) -> tuple[str, float]:
    """Return the number in which two messages differ most, and the difference relative to numbers above 1.

    The difference is infinite if anything but a number differs.
    """
    name, largest = "", 0.0
    for before, after in _pairs(type_name, was, now):
        if before is None or after is None or before[0] != after[0]:
            return (before or after)[0], math.inf
        one, other = before[1], after[1]
        if repr(one) == repr(other):
            continue
        if not (isinstance(one, float) and isinstance(other, float) and math.isfinite(one) and math.isfinite(other)):
            return before[0], math.inf
        size = abs(one - other) / max(1.0, abs(one))
        if size > largest:
            name, largest = before[0], size
    return name, largest


def difference(type_name: str, was: bytes, now: bytes) -> str:
    """The first field in which two messages differ."""
    with contextlib.suppress(CdrError, ValueError, TypeError):
        for before, after in _pairs(type_name, was, now):
            name = (before or after)[0]
            if before is None or after is None or before[0] != after[0]:
                return f"{name} is not in both"
            if repr(before[1]) != repr(after[1]):
                return f"{name} was {before[1]!r}, is {after[1]!r}"
    return f"{len(was)} bytes differ from {len(now)} bytes"


def _pairs(type_name: str, was: bytes, now: bytes) -> Iterator[Any]:
    """The leaves of two messages of one type, in pairs; None where one message is shorter."""
    return zip_longest(_leaves(decode(type_name, was)), _leaves(decode(type_name, now)))


def _leaves(value: Any, name: str = "") -> Iterator[tuple[str, object]]:
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _leaves(inner, f"{name}.{key}" if name else key)
    elif hasattr(value, "tolist") or isinstance(value, list):
        for number, inner in enumerate(getattr(value, "tolist", lambda: value)()):
            yield from _leaves(inner, f"{name}[{number}]")
    else:
        yield name, value


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
