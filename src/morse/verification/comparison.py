"""Compares the published messages of a simulation with a recording, message by message."""

from __future__ import annotations

import contextlib
import math
from collections import deque
from itertools import zip_longest
from typing import TYPE_CHECKING, Any, NamedTuple

from morse.recording.inputs import TOPIC as INPUTS
from morse.recording.made.writing import TOPIC as MADE
from morse.recording.motion import NODES, POSES
from morse.recording.motion import TOPICS as MOTION
from morse.recording.recorder import PRESENT
from morse.recording.streams import LEFT_OUT
from morse.rosmsgs.cdr import CdrError, decode
from morse.rosmsgs.topics.backend import Backend, Publisher, Subscription

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.recording.mcap.records import Message
    from morse.recording.recording import Recording
    from morse.rosmsgs.table import Qos

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
