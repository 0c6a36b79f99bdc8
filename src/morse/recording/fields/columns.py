"""The data of a sensor in many ticks: a tick keeps a row, and the thread of the recording takes columns."""

from __future__ import annotations

import struct
from bisect import bisect_right
from operator import itemgetter
from struct import Struct
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.core.state import NoReferences, Reader, Writer
from morse.core.streams.local_data import Later
from morse.core.values import Fields
from morse.rosmsgs.cdr import encode, encode_rows

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from morse.core.kinds import BoundKind, Message
    from morse.core.values import Value
    from morse.rosmsgs.table import Outlet


# The messages of a sensor in many ticks, from the columns of its fields.

# What a tick keeps of the values of data fields, which may change afterwards.

#: the format of numbers for `struct`, by their type
NUMBERS = {float: "d", int: "q", bool: "?"}
_CONSTANT = frozenset((float, int, bool, str, type(None)))


class Written(NamedTuple):
    """A value of any other kind, as plain data; see `morse.core.state.Writer`."""

    data: Value

    def value(self) -> Value:
        """The value."""
        return Reader(NoReferences()).value(self.data)


class Keeper:
    """Keeps values; for one thread."""

    def __init__(self) -> None:
        self._writer = Writer(NoReferences())
        self._ways: dict[type, Callable[[Value], object]] = {
            **dict.fromkeys((float, int, bool, str, np.float64), _itself),
            np.ndarray: self._array,
            list: self._list,
            Later: self._made,
        }

    def kept(self, value: object) -> object:
        """Return a copy: of numbers, words, arrays and flat lists of these as they are, of others as `Written`."""
        way = self._ways.get(type(value))
        return self.written(value) if way is None else way(value)

    def way_of(self, kind: type) -> Callable[[object], object] | None:
        """The function that keeps values of a type; None if they are constant."""
        way = self._ways.get(kind, self.written)
        return None if way is _itself else way

    def written(self, value: object) -> Written:
        """Return a value as plain data; None in place of an object that cannot be written."""
        data = self._writer.value(value)
        self._writer.release()
        self._writer.unsaved.clear()
        return Written(data)

    def _array(self, value: Value) -> Value:
        if value.dtype.kind not in "biuf":
            return self.written(value)
        copy = value.copy()
        copy.flags.writeable = False
        return copy

    def _made(self, value: object) -> object:
        """A value that was made for the recording."""
        return value if type(value) is np.ndarray and value.dtype.kind in "biuf" else self.kept(value)

    def _list(self, value: list[object]) -> object:
        return value[:] if _CONSTANT.issuperset(map(type, value)) else self.written(value)


def _itself(value: object) -> object:
    return value


_WORDS = frozenset((str, bool, int, tuple))
#: errors of values that do not fit their messages
UNFIT = (struct.error, ValueError, TypeError, OverflowError, LookupError, ArithmeticError, RecursionError)


class Line(NamedTuple):
    """A topic of a sensor in the file.

    Attributes:
        channel: id of its channel.
        topic: its name.
        outlet: makes its messages.
        frame: frame of its messages.
        bound: the kind.
        properties: names of the attributes of the component whose values are the first ones in `Rows.live`.
        slots: of each slot of the kind, the place of its values in `Rows.live`; None if it follows from the fields.
        message: place in `Rows.live` of messages of the kind, if these are kept; else None.
        ready: place in `Rows.live` of encoded messages, if the tick encodes them; else None.
    """

    channel: int
    topic: str
    outlet: Outlet
    frame: str
    bound: BoundKind
    properties: Sequence[str] = ()
    slots: Sequence[int | None] = ()
    message: int | None = None
    ready: int | None = None


class Batch(NamedTuple):
    """Encoded messages of one topic.

    Attributes:
        channel: id of the channel.
        ticks: (R,) numbers of the ticks.
        data: (R, size) messages of one size, or a list of R messages.
    """

    channel: int
    ticks: NDArray[np.int64]
    data: NDArray[np.uint8] | Sequence[bytes]


def messages_of(
    line: Line, rows: Rows, stamps: NDArray[np.int64], complain: Callable[[Line, BaseException], object]
) -> list[Batch]:
    """Encode the messages of some ticks.

    Args:
        rows: the data.
        stamps: (R,) times of the measurements, whole ns.
        complain: called if a message is left out because a value does not fit it.
    """
    if line.ready is not None:
        return _one_by_one(line, rows, rows.live[line.ready].__getitem__, complain)
    if line.message is not None:
        live_values = rows.live[line.message]
        return _one_by_one(line, rows, lambda row: live_values[row] and _encoded(line, live_values[row]), complain)
    try:
        return [_together(line, rows, stamps, part) for part in _alike(line, rows)]
    except UNFIT:  # one of them shows which
        return _one_by_one(
            line, rows, lambda row: _encoded(line, _message(line, rows, int(stamps[row]), row)), complain
        )


def _alike(line: Line, rows: Rows) -> list[NDArray[np.intp]]:
    """The rows whose messages differ only in numbers."""
    live = [rows.live[place] for place in line.slots if place is not None]
    if line.properties:
        live.append(rows.live[0])
    names = {name for _, source in line.bound.sources for name in source.fields}
    others = [rows.columns[str(name)] for name in sorted(map(str, names)) if type(rows.columns.get(str(name))) is tuple]
    if not live and not others:
        return [np.arange(len(rows.ticks))]
    if not others and all(values.count(values[0]) == len(values) for values in live):
        return [np.arange(len(rows.ticks))]
    groups: dict[tuple[object, ...], list[int]] = {}
    for row, values in enumerate(zip(*live, *others, strict=True)):
        groups.setdefault(tuple(map(_form, values)), []).append(row)
    return [np.array(group) for group in groups.values()]


def _form(value: Value) -> object:
    """What messages of one size have in common."""
    kind = type(value)
    if issubclass(kind, float):
        return float
    if kind is np.ndarray:
        return value.dtype.str, value.shape
    if kind is list:
        return list, len(value), frozenset(map(type, value))
    return kind, value


def _together(line: Line, rows: Rows, stamps: NDArray[np.int64], part: NDArray[np.intp]) -> Batch:
    columns = _Chosen(rows.columns, part)
    component = _attributes(line, rows, int(part[0]))
    values = [
        source.rows(columns, component) if place is None else _stacked([rows.live[place][row] for row in part.tolist()])
        for (_, source), place in zip(line.bound.sources, line.slots, strict=True)
    ]
    message = line.bound.message_of_rows(values, stamps[part])
    content = line.outlet.make(message, line.frame)
    ticks = rows.ticks[part]
    if content is None:
        return Batch(line.channel, ticks[:0], [])
    return Batch(line.channel, ticks, encode_rows(line.outlet.type, content, len(part)))


class _Chosen(Fields):
    """Columns of some rows, which are stacked when they are read."""

    def __init__(self, columns: Mapping[str, Value], part: NDArray[np.intp]) -> None:
        super().__init__()
        self._columns, self._part = columns, part

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    def __missing__(self, name: str) -> object:
        column = self._columns[name]
        if isinstance(column, np.ndarray):
            self[name] = column[self._part]
        else:
            self[name] = _stacked([column[row] for row in self._part.tolist()])
        return self[name]


def _stacked(values: Sequence[Value]) -> object:
    """Numbers and arrays with a first axis of rows; words are the same in all rows.

    Raises:
        TypeError: values of that kind are read one by one.
    """
    first = values[0]
    if isinstance(first, np.ndarray):
        return np.stack(values)
    if isinstance(first, float):
        return float(first) if values.count(first) == len(values) else np.array(values)
    if type(first) is list and all(set(map(type, value)) == {float} for value in values):
        return np.array(values)
    if first is None or type(first) in _WORDS:
        return first
    raise TypeError(f"values of the type {type(first).__name__} are read one by one")


def _message(line: Line, rows: Rows, stamp: int, row: int) -> Message:
    holder = _attributes(line, rows, row)
    holder.local_data = {name: _at(column, row) for name, column in rows.columns.items()}
    values = [
        source.get(holder) if place is None else rows.live[place][row]
        for (_, source), place in zip(line.bound.sources, line.slots, strict=True)
    ]
    return line.bound.message_of(values, stamp)


def _attributes(line: Line, rows: Rows, row: int) -> SimpleNamespace:
    """The attributes of the component in a tick."""
    return SimpleNamespace(**dict(zip(line.properties, rows.live[0][row], strict=True)) if line.properties else {})


def _at(column: Value, row: int) -> object:
    value = column[row]
    if isinstance(column, np.ndarray):
        return value.item() if column.ndim == 1 else value
    return value.value() if type(value) is Written else value


def _encoded(line: Line, message: Message) -> bytes | None:
    content = line.outlet.make(message, line.frame)
    return None if content is None else encode(line.outlet.type, content)


def _one_by_one(
    line: Line, rows: Rows, encode_row: Callable[[int], bytes | None], complain: Callable[[Line, BaseException], object]
) -> list[Batch]:
    numbers, messages = [], []
    for row in range(len(rows.ticks)):
        try:
            data = encode_row(row)
        except Exception as error:  # data of the user may be anything
            complain(line, error)
            continue
        if data is not None:
            messages.append(data)
            numbers.append(row)
    return [Batch(line.channel, rows.ticks[numbers], messages)] if messages else []


#: number of values of a row in the flat list
_STRIDE = 3
#: number of rows after which their size is determined again
_LOOK = 16


class Rows(NamedTuple):
    """The data of R ticks.

    Attributes:
        ticks: (R,) numbers of the ticks.
        columns: of each field: (R,) numbers, (R, ...) arrays, or a list of R values that a `Keeper` returned.
        live: of each value that does not follow from the fields, the R values.
    """

    ticks: NDArray[np.int64]
    columns: Mapping[str, Any]
    live: Sequence[Sequence[Any]]

    def some(self, part: slice) -> Rows:
        """Some of the ticks."""
        columns = {name: column[part] for name, column in self.columns.items()}
        return Rows(self.ticks[part], columns, [values[part] for values in self.live])


def runs_of(parts: Sequence[Rows]) -> list[Rows]:
    """The rows in the order of their ticks: those of consecutive ticks of one part together."""
    if len(parts) < 2:
        return list(parts)
    ticks = np.concatenate([rows.ticks for rows in parts])
    owners = np.repeat(np.arange(len(parts)), [len(rows.ticks) for rows in parts])
    places = np.concatenate([np.arange(len(rows.ticks)) for rows in parts])
    order = np.argsort(ticks, kind="stable")
    changes = np.flatnonzero(np.diff(owners[order])) + 1
    return [parts[owners[run[0]]].some(slice(places[run[0]], places[run[-1]] + 1)) for run in np.split(order, changes)]


class Columns:
    """Keeps the values of fields whose types stay the same.

    Args:
        names: of the fields.
        kinds: types of their values.
        keeper: of the thread of the simulation.
        live: return values that do not follow from the fields.

    Attributes:
        size: approximate size of a row, bytes.
    """

    def __init__(
        self, names: Sequence[str], kinds: Sequence[type], keeper: Keeper, live: Sequence[Callable[[], object]]
    ) -> None:
        numbers = [index for index, kind in enumerate(kinds) if kind in NUMBERS]
        others = [index for index, kind in enumerate(kinds) if kind not in NUMBERS]
        self._number_names = [names[index] for index in numbers]
        self._other_names = [names[index] for index in others]
        form = "".join(NUMBERS[kinds[index]] for index in numbers)
        self._dtype = np.dtype([(name, f"<{letter}") for name, letter in zip(self._number_names, form, strict=True)])
        self._pack = Struct(f"<{form}").pack
        self._numbers = _getter(numbers)
        self._others = [(index, keeper.way_of(kinds[index])) for index in others]
        self._live = list(live)
        self._is_plain = not (self._others or self._live)
        self.size = self._dtype.itemsize
        self._row_count = 0
        # each operation on a list is atomic: the simulation appends, and only the thread of the recording removes
        self._rows: list[Any] = []

    def keep(self, tick: int, values: Sequence[object]) -> int:
        """Keep the values of a tick, and return their approximate size, bytes.

        Raises:
            struct.error: an integer has more than 64 bits.
        """
        data = self._pack(*self._numbers(values))
        if self._is_plain:
            self._rows += (tick, data, None)
            return self.size
        others = [values[index] if way is None else way(values[index]) for index, way in self._others]
        others += [live() for live in self._live]
        self._rows += (tick, data, others)
        self._row_count += 1
        if self._row_count % _LOOK == 1:
            self.size = self._dtype.itemsize + sum(map(_size, others))
        return self.size

    def take(self, until: int) -> Rows | None:
        """Return the rows up to a tick, and forget them; None if there are none."""
        some = self._rows[:]
        ticks = some[::_STRIDE]
        count = bisect_right(ticks, until)
        if not count:
            return None
        del self._rows[: _STRIDE * count]
        rows_of_numbers, others = some[1 : _STRIDE * count : _STRIDE], some[2 : _STRIDE * count : _STRIDE]
        columns: Fields = {}
        if self._number_names:
            numbers = np.frombuffer(b"".join(rows_of_numbers), dtype=self._dtype)
            columns.update({name: np.ascontiguousarray(numbers[name]) for name in self._number_names})
        live: Sequence[Sequence[object]] = ()
        if not self._is_plain:
            values = list(zip(*others, strict=True))
            columns.update(zip(self._other_names, values, strict=False))
            live = values[len(self._other_names) :]
        return Rows(np.array(ticks[:count], dtype=np.int64), columns, live)


def _getter(indices: Sequence[int]) -> Callable[[Sequence[object]], Sequence[object]]:
    if len(indices) > 1:
        return itemgetter(*indices)
    return lambda values: [values[index] for index in indices]


def _size(value: object) -> int:
    if isinstance(value, np.ndarray):
        return int(value.nbytes)
    return 100 if isinstance(value, Written) else 16
