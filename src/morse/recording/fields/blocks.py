"""The data fields of a component in several ticks as bytes, column by column.

A block is MessagePack: the names of the fields, the ticks and the log times (int64, little-endian), and the columns.
A column has a type, an element type of numpy, a shape, and its data: the numbers of all rows, one after the other.
"""

from __future__ import annotations

from bisect import bisect_right
from math import prod
from typing import TYPE_CHECKING, Any, NamedTuple

import msgspec
import numpy as np

from morse.core.state import StateError
from morse.recording.errors import RecordingError
from morse.recording.fields import COMPONENT, FIELDS, FIELDS_TYPE
from morse.recording.fields.columns import Keeper, Written
from morse.recording.recording import History
from morse.rosmsgs.cdr import CdrError, decode
from morse.system.packed_keys import check_keys

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from morse.recording.mcap.reader import McapFile
    from morse.recording.mcap.records import Message


#: types of columns
_NUMBER, _SCALAR, _ARRAY, _LIST, _SAME, _OTHER = "number", "scalar", "array", "list", "same", "other"
#: of the thread that writes
_keeper = Keeper()
_encoder = msgspec.msgpack.Encoder()
#: errors of damaged blocks
_DAMAGED = (ValueError, TypeError, LookupError, RecursionError, ArithmeticError, StateError, AttributeError)


class Column(msgspec.Struct, array_like=True):
    """The values of a field.

    Attributes:
        type: ``number`` of Python, ``scalar`` of numpy, ``array`` or ``list`` of numbers, ``same`` value in all
            rows, or ``other``.
        dtype: of numpy, little-endian.
        shape: of the value in a row.
        data: bytes of all rows; of the types ``same`` and ``other``, one or several values as MessagePack.
    """

    type: str
    dtype: str
    shape: list[int]
    data: bytes | list[bytes]


class Block(msgspec.Struct, array_like=True):
    """The fields in R ticks.

    Attributes:
        names: of the fields.
        ticks: (R,) numbers of the ticks, as bytes.
        times: (R,) log times, ns, as bytes.
        columns: one for each name.
    """

    names: list[str]
    ticks: bytes
    times: bytes
    columns: list[Column]


_decoder = msgspec.msgpack.Decoder(Block)


def encode_block(
    ticks: Sequence[int] | NDArray[np.int64], times: NDArray[np.int64], columns: Mapping[str, object]
) -> bytes:
    """Encode the fields of some ticks.

    Args:
        ticks: (R,) their numbers.
        times: (R,) their log times, ns.
        columns: by the name of the field: an array (R,) of numbers or (R, ...) of arrays, or a list of R values that a
            `Keeper` returned.
    """
    return _encoder.encode(
        Block(list(columns), _integers(ticks), _integers(times), [_column(values) for values in columns.values()])
    )


def _integers(values: object) -> bytes:
    return np.ascontiguousarray(values, dtype="<i8").tobytes()


def _column(values: Any) -> Column:
    if isinstance(values, np.ndarray):
        kind = _NUMBER if values.ndim == 1 else _ARRAY
        return Column(kind, values.dtype.newbyteorder("<").str, list(values.shape[1:]), _little(values))
    first = values[0]
    if isinstance(first, np.ndarray) and all(_alike(first, value) for value in values):
        numbers = np.stack(values)
        return Column(_ARRAY, numbers.dtype.newbyteorder("<").str, list(first.shape), _little(numbers))
    if type(first) is np.float64 and all(type(value) is np.float64 for value in values):
        return Column(_SCALAR, "<f8", [], np.array(values, dtype="<f8").tobytes())
    if type(first) is list and first and all(_is_list(value, len(first)) for value in values):
        return Column(_LIST, "<f8", [len(first)], np.array(values, dtype="<f8").tobytes())
    if len(values) > 1 and type(first) is str and all(value is first or value == first for value in values):
        return Column(_SAME, "", [], _packed(first))
    return Column(_OTHER, "", [], [_packed(value) for value in values])


def _alike(first: NDArray[np.generic], value: object) -> bool:
    return isinstance(value, np.ndarray) and value.shape == first.shape and value.dtype == first.dtype


def _is_list(value: object, length: int) -> bool:
    return type(value) is list and len(value) == length and set(map(type, value)) == {float}


def _little(numbers: NDArray[np.generic]) -> bytes:
    return numbers.astype(numbers.dtype.newbyteorder("<"), copy=False).tobytes()


def _packed(value: object) -> bytes:
    return _encoder.encode((value if type(value) is Written else _keeper.written(value)).data)


class Measurement(NamedTuple):
    """The data fields of a component in one tick.

    Attributes:
        tick: its number, counted since the last reset.
        time: log time, ns.
        values: by name.
    """

    tick: int
    time: int
    values: dict[str, object]


class ReadBlock:
    """A block of a file.

    Args:
        data: the bytes.
        what: where they are, for errors.

    Attributes:
        names: of the fields.
        times: (R,) log times, ns.

    Raises:
        RecordingError: it is damaged.
    """

    def __init__(self, data: bytes, what: str) -> None:
        self._what = what
        try:
            check_keys(data)
            block = _decoder.decode(data)
            self.names = block.names
            self.times = np.frombuffer(block.times, dtype="<i8")
            self._ticks = np.frombuffer(block.ticks, dtype="<i8")
            if len(block.columns) != len(self.names) or len(self._ticks) != len(self.times):
                raise ValueError("its parts have different lengths")
            self._readers = [_reader(column, len(self.times)) for column in block.columns]
        except _DAMAGED as error:
            raise self._damaged(error) from None

    def _damaged(self, error: BaseException) -> RecordingError:
        return RecordingError(f"{self._what}: the fields are damaged: {str(error)[:200]}")

    def __len__(self) -> int:
        return len(self.times)

    def row(self, index: int) -> Measurement:
        """Return the fields of a tick.

        Raises:
            RecordingError: they are damaged.
        """
        try:
            values = {name: read(index) for name, read in zip(self.names, self._readers, strict=True)}
        except _DAMAGED as error:
            raise self._damaged(error) from None
        return Measurement(int(self._ticks[index]), int(self.times[index]), values)

    def until(self, time: int) -> int:
        """Return the number of ticks whose log time is not later than a time, ns."""
        return bisect_right(self.times, time)


def _reader(column: Column, count: int) -> Callable[[int], object]:
    """Return a function that returns the value of a row."""
    data = column.data
    if column.type in (_NUMBER, _SCALAR, _ARRAY, _LIST):
        dtype = np.dtype(column.dtype)
        if dtype.kind not in "biuf" or dtype.names or not all(0 <= size < 1 << 40 for size in column.shape):
            raise ValueError(f"the element type {column.dtype[:20]!r}")
        if isinstance(data, list) or len(data) != count * prod(column.shape) * dtype.itemsize:
            raise ValueError("a column has another length than its rows")
        numbers = np.frombuffer(data, dtype=dtype).reshape(count, *column.shape)
        if column.type in (_ARRAY, _SCALAR):
            return lambda index: numbers[index].copy()
        return lambda index: numbers[index].tolist()
    if column.type == _SAME and isinstance(data, bytes):
        return lambda index: _unpacked(data)
    if column.type == _OTHER and isinstance(data, list) and len(data) == count:
        return lambda index: _unpacked(data[index])
    raise ValueError(f"the type of a column is {column.type[:20]!r}")


def _unpacked(data: bytes) -> Any:
    check_keys(data)
    return Written(msgspec.msgpack.decode(data)).value()


# Reads the data fields of components in a recording.


class RecordedFields:
    """The data fields of the recorded sensors at any time.

    Args:
        file: a recording.
    """

    def __init__(self, file: McapFile) -> None:
        self._history = History(file)
        self._path = file.path
        self._channels = channels_of_fields(file)
        #: the last block of each component
        self._blocks: dict[str, tuple[Message, ReadBlock]] = {}

    def __contains__(self, name: str) -> bool:
        return name in self._channels

    def last(self, name: str, until: int) -> Measurement | None:
        """The fields of a component at its last measurement whose log time is not later than ``until``, ns.

        Returns:
            None before the first measurement, and for a component that was not recorded.

        Raises:
            RecordingError: the file is damaged.
        """
        channel = self._channels.get(name)
        message = None if channel is None else self._history.last(channel, until)
        if message is None:
            return None
        former = self._blocks.get(name)
        if former is None or former[0] is not message:
            former = self._blocks[name] = message, block_of(message, self._path)
        block = former[1]
        count = block.until(until)
        return block.row(count - 1) if count else None


def channels_of_fields(file: McapFile) -> dict[str, int]:
    """The channels of data fields by the names of their components."""
    return {
        channel.metadata.get(COMPONENT, ""): channel.number
        for channel in file.channels.values()
        if channel.topic.startswith(f"{FIELDS}/") and channel.type == FIELDS_TYPE
    }


def block_of(message: Message, path: str) -> ReadBlock:
    """The fields in a message.

    Raises:
        RecordingError: they are damaged.
    """
    try:
        data: Any = decode(FIELDS_TYPE, message.data)["data"]
    except CdrError:
        data = b""
    return ReadBlock(bytes(data), f"{path}: tick {message.sequence}")
