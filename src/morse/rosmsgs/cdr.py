"""Messages as bytes and back: CDR as ROS 2 uses it (OMG DDSI-RTPS 2.5, chapter 10; XCDR version 1).

A message is a dictionary of its fields; missing fields have the defaults of their definition. Numbers in
sequences may be numpy arrays, ``uint8[]`` may be bytes.
"""

from __future__ import annotations

import struct
from functools import cache, lru_cache
from operator import itemgetter
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.rosmsgs.definitions import PRIMITIVES, SEQUENCE, SINGLE, fields_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from morse.core.values import DecodedMessage, RosMessage
    from morse.rosmsgs.definitions import MessageField

    Write = Callable[[bytearray, Any], None]
    Read = Callable[["_Bytes"], Any]

_HEADER = b"\x00\x01\x00\x00"  # CDR, little endian, no options
_BIG, _LITTLE = b"\x00\x00", b"\x00\x01"
#: sizes of numbers, bytes
_SIZES = (2, 4, 8)
#: size of the largest number, bytes
_LARGEST = 8


class CdrError(ValueError):
    """The bytes are not a message of that type."""


def encode(type_name: str, message: RosMessage) -> bytes:
    """Encode a message, with the header of four bytes that contains the encoding.

    Raises:
        ValueError, TypeError, OverflowError, struct.error: a value does not fit its field.
    """
    buffer = bytearray(_HEADER)
    _struct_writer(type_name)(buffer, message)
    return bytes(buffer)


def encode_rows(type_name: str, message: RosMessage, count: int) -> NDArray[np.uint8]:
    """Encode many messages of the same size at once.

    Args:
        message: as for `encode`. A number that differs between the messages is a column (R,), a sequence of numbers
            is rows (R, N). All other parts are those of each message.
        count: R, the number of messages.

    Returns:
        (R, size) the bytes of `encode` for each row.

    Raises:
        ValueError, TypeError, OverflowError, struct.error: a value does not fit its field.
    """
    rows = _Rows(count)
    rows.put_struct(type_name, message)
    return rows.joined()


def decode(type_name: str, data: bytes) -> DecodedMessage:
    """Decode a message from untrusted bytes; sequences of numbers become numpy arrays.

    Raises:
        CdrError: the bytes are not a message of that type.
    """
    kind = bytes(data[:2])
    if len(data) < len(_HEADER) or kind not in (_BIG, _LITTLE):
        raise CdrError(f"{type_name}: not CDR version 1: {bytes(data[:4])!r}")
    message: DecodedMessage = _struct_reader(type_name, "<" if kind == _LITTLE else ">")(_Bytes(memoryview(data)[4:]))
    return message


# -- writing -----------------------------------------------------------------------------------


@cache
def _struct_writer(type_name: str) -> Write:
    if _letters(type_name) is not None:
        return _plain_writer(type_name)
    if type_name == "std_msgs/msg/Header":
        return _write_header
    parts = [(field.name, _writer(field)) for field in fields_of(type_name)]
    names = frozenset(name for name, _ in parts)

    def write(buffer: bytearray, value: RosMessage) -> None:
        for name, write_field in parts:
            write_field(buffer, value.get(name))
        _check_names(type_name, names, value)

    return write


def _write_header(buffer: bytearray, value: DecodedMessage) -> None:
    """The beginning of most messages; the frames of a simulation are few."""
    _check_names("std_msgs/msg/Header", _HEADER_FIELDS, value)
    stamp = value.get("stamp") or {}
    _align(buffer, 4)
    buffer += _STAMP(stamp.get("sec", 0), stamp.get("nanosec", 0))
    buffer += _string_bytes(value.get("frame_id") or "")


#: maximum length of a string that may be a name
_NAME = 100
_HEADER_FIELDS = frozenset(("stamp", "frame_id"))
_STAMP = struct.Struct("<iI").pack


@lru_cache(maxsize=4096)
def _string_bytes(text: str) -> bytes:
    """A string with its length, at an offset that is a multiple of 4."""
    data = text.encode("utf-8", "replace").replace(b"\0", b"?")  # 0 ends a string
    return (len(data) + 1).to_bytes(4, "little") + data + b"\0"


def _check_names(type_name: str, names: frozenset[str], value: RosMessage) -> None:
    if not names.issuperset(value):
        raise ValueError(f"{type_name} has no field {sorted(value.keys() - names)}")


@cache
def _letters(type_name: str) -> str | None:
    """The numbers of a message of fixed length; None if its length is not fixed."""
    letters = ""
    for field in fields_of(type_name):
        inner = PRIMITIVES.get(field.type) or (None if field.type == "string" else _letters(field.type))
        if inner is None or field.size == SEQUENCE:
            return None
        letters += inner * max(field.size, 1)
    return letters


def _plain_writer(type_name: str) -> Write:
    """Writes all numbers of a message of fixed length at once."""
    letters = _letters(type_name) or ""
    collect = _collector(type_name)
    # the padding between the numbers depends on the offset of the message
    packers = [_padded(letters, begin) for begin in range(_LARGEST)]

    def write(buffer: bytearray, value: RosMessage) -> None:
        numbers: list[object] = []
        collect(value, numbers)
        buffer += packers[(len(buffer) - len(_HEADER)) % _LARGEST](*numbers)

    return write


def _padded(letters: str, begin: int) -> Callable[..., bytes]:
    return struct.Struct("<" + _padding(letters, begin)).pack


def _padding(letters: str, begin: int) -> str:
    """The format of numbers from an offset on."""
    form, at = "", begin
    for letter in letters:
        size = struct.calcsize("<" + letter)
        remainder = -at % size
        form += "x" * remainder + letter
        at += remainder + size
    return form


@cache
def _collector(type_name: str) -> Callable[[RosMessage, list[object]], None]:
    """Appends the numbers of a message of fixed length to a list."""
    fields = fields_of(type_name)
    parts = [
        (field.name, field.size, None if field.type in PRIMITIVES else _collector(field.type), _default(field))
        for field in fields
    ]
    names = frozenset(name for name, _, _, _ in parts)

    def collect(value: DecodedMessage, numbers: list[object]) -> None:
        _check_names(type_name, names, value)
        for name, size, inner, default in parts:
            content = value.get(name)
            if inner is not None:
                inner(content or {}, numbers)
            elif size == SINGLE:
                numbers.append(default if content is None else content)
            elif content is None:
                numbers += [default] * size
            else:
                if len(content) != size:
                    raise ValueError(f"field '{name}' has {size} items, not {len(content)}")
                numbers += content.tolist() if hasattr(content, "tolist") else content

    if len(fields) < 2 or any(field.size != SINGLE or field.type not in PRIMITIVES for field in fields):
        return collect
    all_of = itemgetter(*(field.name for field in fields))

    def collect_all(value: RosMessage, numbers: list[object]) -> None:
        """Vectors and quaternions, which usually contain all their numbers."""
        if len(value) != len(fields):
            collect(value, numbers)
            return
        try:
            content = all_of(value)
        except KeyError:
            content = (None,)
        if None in content:
            collect(value, numbers)
        else:
            numbers += content

    return collect_all


def _default(field: MessageField) -> float:
    return field.default if PRIMITIVES.get(field.type, "d") in "fd" else int(field.default)


def _writer(field: MessageField) -> Write:
    if field.size == SINGLE:
        return _single_writer(field)
    if field.type in PRIMITIVES:
        return _numbers_writer(field)
    item = _single_writer(field._replace(size=SINGLE))

    def write(buffer: bytearray, value: Any) -> None:
        items = value or ()
        if field.size != SEQUENCE and len(items) != field.size:
            raise ValueError(f"field '{field.name}' has {field.size} items, not {len(items)}")
        if field.size == SEQUENCE:
            _write_count(buffer, len(items))
        for one in items:
            item(buffer, one)

    return write


def _single_writer(field: MessageField) -> Write:
    if field.type == "string":
        return _write_string
    if field.type not in PRIMITIVES:
        inner = _struct_writer(field.type)
        return lambda buffer, value: inner(buffer, value or {})
    letter = PRIMITIVES[field.type]
    packer = struct.Struct("<" + letter)
    size, pack, default = packer.size, packer.pack, _default(field)

    def write(buffer: bytearray, value: object) -> None:
        _align(buffer, size)
        buffer += pack(default if value is None else value)

    return write


def _numbers_writer(field: MessageField) -> Write:
    dtype = np.dtype("<" + PRIMITIVES[field.type])

    def write(buffer: bytearray, value: object) -> None:
        if value is None:
            value = np.zeros(field.size)
        if isinstance(value, (bytes, bytearray, memoryview)):
            data, count = value, len(value) // dtype.itemsize
        else:
            array = np.ascontiguousarray(value, dtype=dtype)
            data, count = array.reshape(-1).view(np.uint8).data, array.size
        if field.size not in (SEQUENCE, count):
            raise ValueError(f"field '{field.name}' has {field.size} items, not {count}")
        if field.size == SEQUENCE:
            _write_count(buffer, count)
        if count:
            _align(buffer, dtype.itemsize)
            buffer += data

    return write


def _align(buffer: bytearray, size: int) -> None:
    rest = (len(buffer) - len(_HEADER)) % size
    if rest:
        buffer += bytes(size - rest)


def _write_count(buffer: bytearray, count: int) -> None:
    _align(buffer, 4)
    buffer += count.to_bytes(4, "little")


def _write_string(buffer: bytearray, value: Any) -> None:
    text = "" if value is None else value
    _align(buffer, 4)
    # names of frames and joints are repeated often, texts are not
    buffer += _string_bytes(text) if len(text) < _NAME else _string_bytes.__wrapped__(text)


# -- writing many ------------------------------------------------------------------------------


class _Rows:
    """The bytes that all messages share, and columns that replace some of them."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._common = bytearray(_HEADER)
        self._columns: list[tuple[int, NDArray[np.uint8]]] = []

    def joined(self) -> NDArray[np.uint8]:
        table = np.empty((self._count, len(self._common)), dtype=np.uint8)
        table[:] = np.frombuffer(self._common, dtype=np.uint8)
        for begin, column in self._columns:
            size = column.shape[1]
            if size in _SIZES and self._count:  # one number is copied as a number, not byte by byte
                form = f"<u{size}"
                places = np.ndarray(self._count, form, buffer=table.data, offset=begin, strides=table.strides[:1])
                places[:] = column.view(form)[:, 0]
            else:
                table[:, begin : begin + size] = column
        return table

    def put_struct(self, type_name: str, value: RosMessage) -> None:
        fields = fields_of(type_name)
        _check_names(type_name, frozenset(field.name for field in fields), value)
        for field in fields:
            self._put(field, value.get(field.name))

    def _put(self, field: MessageField, value: Any) -> None:
        if field.type in PRIMITIVES and getattr(value, "ndim", 0) == (1 if field.size == SINGLE else 2):
            self._put_column(field, value)
        elif field.type in PRIMITIVES or field.type == "string":
            _writer(field)(self._common, value)
        elif field.size == SINGLE:
            self.put_struct(field.type, value or {})
        else:
            items = value or ()
            if field.size == SEQUENCE:
                _write_count(self._common, len(items))
            for item in items:
                self.put_struct(field.type, item)

    def _put_column(self, field: MessageField, value: NDArray[np.generic]) -> None:
        dtype = np.dtype("<" + PRIMITIVES[field.type])
        numbers = np.ascontiguousarray(_of_type(dtype, field, value)).reshape(self._count, -1)
        items = numbers.shape[1]
        if field.size == SEQUENCE:
            _write_count(self._common, items)
        elif field.size not in (SINGLE, items):
            raise ValueError(f"field '{field.name}' has {field.size} items, not {items}")
        if items:
            _align(self._common, dtype.itemsize)
            self._columns.append((len(self._common), numbers.view(np.uint8)))
            self._common += bytes(items * dtype.itemsize)


def _of_type(dtype: np.dtype[np.generic], field: MessageField, value: NDArray[np.generic]) -> NDArray[np.generic]:
    """Numbers of the type of a field; single ones that do not fit it are refused, as by the module struct."""
    if value.dtype == dtype:  # nothing to convert: true of nearly all columns
        return value
    with np.errstate(all="ignore"):
        numbers = value.astype(dtype)
    if field.size == SINGLE:
        exact = np.isfinite(numbers) == np.isfinite(value) if dtype.kind == "f" else numbers == value
        if not exact.all():
            raise OverflowError(f"field '{field.name}' has a number that does not fit {field.type}")
    return numbers


# -- reading -----------------------------------------------------------------------------------


class _Bytes:
    """Bytes and the present offset."""

    __slots__ = ("at", "data")

    def __init__(self, data: memoryview) -> None:
        self.data, self.at = data, 0

    def take(self, count: int, alignment: int) -> memoryview:
        begin = -(-self.at // alignment) * alignment
        self.at = begin + count
        if self.at > len(self.data):
            raise CdrError(f"{len(self.data)} bytes are too few")
        return self.data[begin : self.at]


@cache
def _struct_reader(type_name: str, order: str) -> Read:
    parts = [(field.name, _reader(field, order)) for field in fields_of(type_name)]
    return lambda source: {name: read(source) for name, read in parts}


def _reader(field: MessageField, order: str) -> Read:
    if field.size == SINGLE:
        return _single_reader(field.type, order)
    count_of = _single_reader("uint32", order)
    if field.type in PRIMITIVES:
        dtype = np.dtype(order + PRIMITIVES[field.type])

        def read_numbers(source: _Bytes) -> object:
            count = field.size or count_of(source)
            data = source.take(count * dtype.itemsize, dtype.itemsize if count else 1)
            return np.frombuffer(bytes(data), dtype=np.uint8 if dtype.kind == "b" else dtype)

        return read_numbers
    item = _single_reader(field.type, order)

    def read(source: _Bytes) -> list[object]:
        count = field.size or count_of(source)
        if count > len(source.data) - source.at:  # each item takes at least one byte
            raise CdrError(f"{len(source.data)} bytes are too few for {count} items")
        return [item(source) for _ in range(count)]

    return read


def _single_reader(type_name: str, order: str) -> Read:
    if type_name == "string":
        count_of = _single_reader("uint32", order)
        return lambda source: bytes(source.take(count_of(source), 1)).rstrip(b"\0").decode("utf-8", "replace")
    if type_name not in PRIMITIVES:
        return _struct_reader(type_name, order)
    unpacker = struct.Struct(order + PRIMITIVES[type_name])
    size, unpack = unpacker.size, unpacker.unpack
    if type_name == "bool":
        return lambda source: source.take(1, 1)[0] != 0
    return lambda source: unpack(source.take(size, size))[0]
