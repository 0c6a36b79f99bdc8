"""Messages whose numbers are those of the data of sensors."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.core.kinds.kind import ORIENTATION
from morse.kernel.recording import Numbers
from morse.kernel.recording.arrays import DOUBLE, SINGLE, SUM, TURN
from morse.recording.captures.capture import Capture
from morse.recording.captures.lone import Lone
from morse.recording.captures.template import STAMP, Part, Template
from morse.rosmsgs.parts import xyzw

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from morse.core.groups.group import Group
    from morse.core.kinds import BoundKind
    from morse.kernel.recording import Batch, NativeRecords, Rows
    from morse.recording.recorded_stream import RecordedLine, RecordedStream

#: maximum count of the numbers of a sensor
_MOST = 256
_CONSTANT, _SINGLE_NUMBER = -2, -1
#: numbers with which the places of numbers are verified, beside random ones of several magnitudes
_SPECIAL = (0.0, -0.0, 1.0, -1.0, float("inf"), -float("inf"), float("nan"))
_MAGNITUDES = (1e-6, 1e-2, 1.0, 1e3, 1e7)


class _Slots(NamedTuple):
    """The slots of a kind of a component.

    Attributes:
        bound: the kind.
        shapes: of each slot: `_CONSTANT`, `_SINGLE_NUMBER`, or the count of its numbers.
        known: the values of the constant slots.
    """

    bound: BoundKind
    shapes: Sequence[int]
    known: Sequence[Any]

    def numbers(self, holder: Any) -> list[float] | None:
        """The present numbers; None if a constant slot has another value, or a slot has another shape."""
        found: list[float] = []
        for value, shape, known in zip(self.bound.values(holder), self.shapes, self.known, strict=True):
            if shape == _SINGLE_NUMBER:
                found.append(value)
            elif shape == _CONSTANT:
                if value != known:
                    return None
            elif value is None or len(value) != shape:
                return None
            else:
                found += value.tolist() if type(value) is np.ndarray else value
        return found

    def values(self, numbers: Sequence[float]) -> list[Any]:
        """The values of all slots, with these numbers."""
        rest, values = list(numbers), list[Any]()
        for shape, known in zip(self.shapes, self.known, strict=True):
            if shape == _CONSTANT:
                values.append(known)
            else:
                count = abs(shape)
                values.append(rest[0] if shape == _SINGLE_NUMBER else rest[:count])
                del rest[:count]
        return values

    def turns(self) -> list[int]:
        """The first columns of quaternions."""
        at, found = 0, []
        for (slot, _), shape in zip(self.bound.sources, self.shapes, strict=True):
            if shape == 4 and slot.moves == ORIENTATION:
                found.append(at)
            at += 0 if shape == _CONSTANT else abs(shape)
        return found


class _Sensor(NamedTuple):
    """A recorded sensor.

    Attributes:
        component: the sensor.
        slots: of each kind.
        lines: its messages, and the kind of each.
        row: in its group.
    """

    component: Any
    slots: Sequence[_Slots]
    lines: Sequence[tuple[RecordedLine, int]]
    row: int

    def numbers(self, holder: Any) -> list[float] | None:
        """The present numbers of all slots."""
        found: list[float] = []
        for slots in self.slots:
            numbers = slots.numbers(holder)
            if numbers is None:
                return None
            found += numbers
        return found

    def messages(self, numbers: Sequence[float], stamp: int) -> list[bytes] | None:
        """The messages with these numbers, as the streams encode them; None if there is none on a topic."""
        at, made = 0, []
        for slots in self.slots:
            count = sum(abs(shape) for shape in slots.shapes if shape != _CONSTANT)
            made.append(slots.bound.message_of(slots.values(numbers[at : at + count]), stamp))
            at += count
        messages = [line.encoded(made[kind]) for line, kind in self.lines]
        return None if None in messages else messages  # type: ignore[return-value]

    def turns(self) -> list[int]:
        """The first columns of quaternions."""
        at, found = 0, []
        for slots in self.slots:
            found += [at + column for column in slots.turns()]
            at += sum(abs(shape) for shape in slots.shapes if shape != _CONSTANT)
        return found


class CopiesCapture(Capture):
    """Messages whose numbers are those of the data of sensors.

    The stored data of R ticks are the numbers of each, as bytes.

    Args:
        native: the encoder.
        template: the messages.
        sensors: the sensors.
        which: see `morse.kernel.recording.Numbers`.
        columns: count of the numbers of all sensors.
    """

    is_taken = True

    def __init__(
        self,
        native: NativeRecords,
        template: Template,
        sensors: Sequence[_Sensor],
        which: NDArray[np.int64],
        columns: int,
    ) -> None:
        super().__init__(native, template)
        self._sensors, self._which, self._columns = sensors, which, columns
        self._pack = struct.Struct(f"={columns}d").pack
        self.held = 8 * columns

    def take(self, group: Group | Lone) -> bytes | None:
        """The numbers of a tick; None if something else than a number has changed."""
        numbers: list[float] = []
        try:
            for sensor in self._sensors:
                holder = holder_of(group, sensor.component, sensor.row)
                found = None if holder is None else sensor.numbers(holder)
                if found is None:
                    return None
                numbers += found
            return self._pack(*numbers)
        except Exception:  # a function of a component failed: its stream encodes the message, and reports the error
            return None

    def _fill(self, batch: Batch, rows: Rows, data: Any) -> None:
        if self._columns:
            numbers = np.frombuffer(b"".join(data), dtype=np.float64).reshape(-1, self._columns)
            batch.numbers(rows, Numbers(numbers, self._which))

    def agrees_with(self, columns: int, messages: Callable[[Sequence[float]], list[bytes] | None]) -> bool:
        """Whether the messages are those of the streams, whatever the numbers are."""
        rng = np.random.default_rng(1)
        for number in _SPECIAL:
            if not self._agrees([number] * columns, messages):
                return False
        return all(
            self._agrees((scale * rng.normal(size=columns)).tolist(), messages)
            for scale in _MAGNITUDES
            for _ in range(2)
        )

    def _agrees(self, numbers: list[float], messages: Callable[[Sequence[float]], list[bytes] | None]) -> bool:
        wanted = messages(numbers)
        return wanted is not None and self.agrees([self._pack(*numbers)], wanted)


def holder_of(group: Group | Lone, component: Any, row: int) -> Any:
    """An object with the data that a sensor has measured in this tick; None if they are of another tick."""
    clock = component.context.clock
    holder = component if isinstance(group, Lone) else _Peeked(group.peek(row))
    return holder if holder.local_data.get("timestamp") == clock.time else None


class _Peeked:
    __slots__ = ("local_data",)

    def __init__(self, data: dict[str, Any]) -> None:
        self.local_data = data


def copies_of(native: NativeRecords, group: Group | Lone, streams: Sequence[RecordedStream]) -> CopiesCapture | None:
    """Return the capture of sensors whose messages hold the numbers of their data.

    Args:
        native: the encoder.
        group: a group, or a sensor that acts alone, that has measured in this tick.
        streams: one stream for each recorded member, in the order of the members.

    Returns:
        None if the streams have to encode each message.
    """
    try:
        return _copies_of(native, group, streams)
    except Exception:  # as above
        return None


def _copies_of(native: NativeRecords, group: Group | Lone, streams: Sequence[RecordedStream]) -> CopiesCapture | None:
    sensors, parts, which, before, at = [], list[Part](), list[tuple[int, int, int]](), 0, 0
    for stream in streams:
        sensor = _sensor(group, stream)
        holder = None if sensor is None else holder_of(group, stream.component_instance, sensor.row)
        numbers = None if holder is None or sensor is None else sensor.numbers(holder)
        if sensor is None or numbers is None or len(numbers) > _MOST:
            return None
        messages = sensor.messages(numbers, stream.stamp())
        if messages is None:
            return None
        own = [
            Part(line.channel, message, (STAMP,) if line.is_stamped else ())
            for (line, _), message in zip(sensor.lines, messages, strict=True)
        ]
        template = Template(own)
        places = _places(sensor, len(numbers), template, stream.stamp())
        made = CopiesCapture(native, template, [sensor], _array(places), len(numbers))
        if not made.agrees_with(len(numbers), _messages(sensor, stream.stamp())):
            return None
        which += [(form, at + place, before + column) for form, place, column in places]
        parts += own
        sensors.append(sensor)
        before, at = before + len(numbers), at + made.size
    return CopiesCapture(native, Template(parts), sensors, _array(which), before)


def _messages(sensor: _Sensor, stamp: int) -> Callable[[Sequence[float]], list[bytes] | None]:
    return lambda numbers: sensor.messages(numbers, stamp)


def _array(which: Sequence[tuple[int, int, int]]) -> NDArray[np.int64]:
    return np.array(which, dtype=np.int64).reshape(-1, 3)


def _sensor(group: Group | Lone, stream: RecordedStream) -> _Sensor | None:
    component, lines = stream.component_instance, stream.lines()
    if not lines or stream.moves_frames or not all(line.outlet.is_copy for line in lines):
        return None
    bounds = list(dict.fromkeys(line.bound for line in lines))
    if not isinstance(group, Lone) and any(bound.needs is None for bound in bounds):
        return None
    row = group.row_of(component)
    holder = holder_of(group, component, row)
    slots = [None if holder is None else _slots(bound, holder) for bound in bounds]
    if None in slots:
        return None
    return _Sensor(component, slots, [(line, bounds.index(line.bound)) for line in lines], row)  # type: ignore[arg-type]


def _slots(bound: BoundKind, holder: Any) -> _Slots | None:
    shapes, known = [], []
    for (slot, _), value in zip(bound.sources, bound.values(holder), strict=True):
        shape = _shape(slot, value)
        if shape is None:
            return None
        shapes.append(shape)
        known.append((list(value) if type(value) is list else value) if shape == _CONSTANT else None)
    return _Slots(bound, shapes, known)


def _shape(slot: Any, value: Any) -> int | None:
    if slot.covariance_of:
        return None  # other parts of the message may depend on it
    if value is None or isinstance(value, (str, bool)) or not slot.dtype.startswith("float"):
        words = isinstance(value, (list, tuple)) and all(isinstance(one, str) for one in value)
        return _CONSTANT if words or value is None or isinstance(value, (str, bool, int)) else None
    if slot.shape == ():
        return _SINGLE_NUMBER
    return len(value) if np.ndim(value) == 1 else None


def _places(sensor: _Sensor, columns: int, template: Template, stamp: int) -> list[tuple[int, int, int]]:
    """Form, offset in the template and column of each number, found by messages of numbers that differ."""
    numbers = np.random.default_rng(2).uniform(0.1, 0.9, size=columns).tolist()
    turns = sensor.turns()
    quaternions = {first + k for first in turns for k in range(4)}
    messages, zeros = sensor.messages(numbers, stamp), sensor.messages([-0.0] * columns, stamp)
    found: list[tuple[int, int, int]] = []
    for begin, message, zero in zip(template.begins.tolist(), messages or (), zeros or (), strict=True):
        for column in range(columns):
            if column in turns:
                looked = [(TURN, struct.pack("<4d", *xyzw(numbers[column : column + 4])))]
            elif column in quaternions:
                looked = []
            else:
                looked = [(DOUBLE, struct.pack("<d", numbers[column])), (SINGLE, struct.pack("<f", numbers[column]))]
            for form, wanted in looked:
                for place in _all_of(message, wanted):
                    is_sum = form == DOUBLE and zero[place : place + 8] == bytes(8)
                    found.append((SUM if is_sum else form, begin + place, column))
    return found


def _all_of(message: bytes, wanted: bytes) -> list[int]:
    found, at = [], message.find(wanted)
    while at >= 0:
        found.append(at)
        at = message.find(wanted, at + 1)
    return found
