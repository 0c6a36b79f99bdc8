"""Bottles, the messages of YARP, in binary form.

A bottle is a list of values. Each value is a tag and its data, integers little-endian; in a list of values of one
type the tag of the type is part of the tag of the list.

Source: www.yarp.it, class yarp::os::Bottle; the tags are those of yarp/os/Bottle.h.
"""

from __future__ import annotations

import re
import struct
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.streams.extent import listed
from morse.wire.encoding import plain

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from morse.core.values import Fields, Value


INT32, INT64, FLOAT64, STRING, BLOB, VOCAB, LIST, DICT = 1, 17, 10, 4, 12, 9, 256, 512
_INT8, _INT16, _FLOAT32 = 32, 64, 128
_UNIT = 255
#: format of the numbers of each tag
_NUMBERS = {
    _INT8: struct.Struct("<b"),
    _INT16: struct.Struct("<h"),
    INT32: struct.Struct("<i"),
    INT64: struct.Struct("<q"),
    _FLOAT32: struct.Struct("<f"),
    FLOAT64: struct.Struct("<d"),
}
_SIZE = _NUMBERS[INT32]
_DEEPEST = 32
_FALSE, _TRUE = b"\0\0\0\0", b"1\0\0\0"


class Vocab(str):
    """A word of at most four letters, which YARP sends as an integer and writes as ``[word]``."""


class BottleError(ValueError):
    """Data are not a bottle, or a value cannot be part of a bottle."""


def encode(values: Sequence[object] | np.ndarray) -> bytes:
    """A bottle of some values: numbers, booleans as 0 and 1, strings, bytes, lists, dictionaries as lists of pairs.

    Raises:
        BottleError: a value has no representation, contains itself, or is an integer of more than 64 bits.
    """
    tag, data = _list(values, 0)
    return _SIZE.pack(tag) + data


def _list(values: Any, depth: int) -> tuple[int, bytes]:
    if depth > _DEEPEST:
        raise BottleError("it is nested too deeply, or contains itself")
    if isinstance(values, np.ndarray):
        if values.ndim == 1 and values.dtype.kind == "f":
            return LIST | FLOAT64, _SIZE.pack(len(values)) + values.astype("<f8").tobytes()
        values = listed(values)
    items = [_item(value, depth + 1) for value in values]
    count = _SIZE.pack(len(items))
    tags = {tag for tag, _ in items}
    if len(tags) == 1 and (common := tags.pop()) <= _UNIT:
        return LIST | common, count + b"".join(data for _, data in items)
    return LIST, count + b"".join(_SIZE.pack(tag) + data for tag, data in items)


def _item(value: Value, depth: int) -> tuple[int, bytes]:
    kind = type(value)
    if kind is float:
        return FLOAT64, _NUMBERS[FLOAT64].pack(value)
    if kind is int or kind is bool:
        return _integer(int(value))
    if kind is Vocab:
        return VOCAB, value.encode("latin-1", "replace")[:4].ljust(4, b"\0")
    if kind is str:
        data = value.encode("utf-8", "replace")
        return STRING, _SIZE.pack(len(data)) + data
    if kind is bytes:
        return BLOB, _SIZE.pack(len(value)) + value
    if isinstance(value, dict):
        return _list([[str(key), value[key]] for key in value], depth)
    if isinstance(value, (list, tuple, np.ndarray)):
        return _list(value, depth)
    if value is None:
        return VOCAB, b"null"
    try:
        return _item(plain(value), depth)
    except TypeError as error:
        raise BottleError(str(error).replace("JSON", "a value of a bottle")) from None


def _integer(value: int) -> tuple[int, bytes]:
    for tag in (INT32, INT64):
        try:
            return tag, _NUMBERS[tag].pack(value)
        except struct.error:
            continue
    raise BottleError(f"an integer of {value.bit_length()} bits does not fit, expected at most 64")


def decode(data: bytes) -> list[Any]:
    """The values of a bottle; words are `Vocab`, ``true`` and ``false`` booleans.

    Raises:
        BottleError: the data are not a bottle.
    """
    reader = _Reader(data)
    values = reader.list(reader.number(INT32) & _UNIT, 0)
    if reader.left:
        raise BottleError(f"{reader.left} bytes follow the bottle")
    return values


class _Reader:
    def __init__(self, data: bytes) -> None:
        self._data, self._place = data, 0

    @property
    def left(self) -> int:
        return len(self._data) - self._place

    def number(self, tag: int) -> Any:
        form = _NUMBERS[tag]
        return form.unpack(self._take(form.size))[0]

    def _take(self, size: int) -> bytes:
        if not 0 <= size <= self.left:
            raise BottleError(f"{size} bytes are announced, and {self.left} are left")
        begin, self._place = self._place, self._place + size
        return self._data[begin : self._place]

    def list(self, common: int, depth: int) -> list[Any]:
        count = self.number(INT32)
        # each value takes at least one byte
        if depth > _DEEPEST or not 0 <= count <= self.left:
            raise BottleError("it is nested too deeply" if depth > _DEEPEST else f"a list has {count} values")
        if common in _NUMBERS:
            size, form = _NUMBERS[common].size, _NUMBERS[common].format
            numbers: list[object] = np.frombuffer(self._take(count * size), dtype=form).tolist()
            return numbers
        return [self._value(common or self.number(INT32), depth + 1) for _ in range(count)]

    def _value(self, tag: int, depth: int) -> Value:
        if tag in _NUMBERS:
            return self.number(tag)
        if tag == STRING:
            return self._take(self.number(INT32)).decode("utf-8", "replace")
        if tag == BLOB:
            return self._take(self.number(INT32))
        if tag == VOCAB:
            return word(self._take(4))
        if tag & (LIST | DICT):
            return self.list(tag & _UNIT, depth)
        raise BottleError(f"{tag} is not a tag of a value")


def word(data: bytes) -> Vocab | bool:
    """A word from its four bytes; YARP writes booleans as two of the words."""
    if data in (_FALSE, _TRUE):
        return data == _TRUE
    return Vocab(data.rstrip(b"\0").decode("latin-1"))


def as_dict(pairs: Iterable[Any]) -> Fields | None:
    """The dictionary of a list of pairs; None if it is none."""
    entries = list(pairs)
    if all(isinstance(pair, list) and len(pair) == 2 and isinstance(pair[0], str) for pair in entries):
        return {str(key): value for key, value in entries}
    return None


#: a value: brackets, a text in quotes, or a word up to the next blank
_TOKEN = re.compile(r'[\s,]*([()]|\[[^\]\s]{0,8}\]|\{[^}]*\}|"(?:[^"\\]|\\.)*"|[^\s,()"\[\]{}]+)', re.DOTALL)
_INTEGER = re.compile(r"[+-]?(?:0[xX][0-9a-fA-F]{1,8}|\d{1,19})$")
#: a run of digits belongs to one part only: the time for a word of n digits that is not a number is O(n), not O(n²)
_NUMBER = re.compile(r"[+-]?(?:\d++(?:\.\d*+)?|\.\d++)(?:[eE][+-]?\d++)?$|-?inf$|nan$")
_BARE = re.compile(r"[A-Za-z_][A-Za-z_0-9.-]*$")
_ESCAPES = {"n": "\n", "r": "\r", "0": "\0"}
_ESCAPED = {"\\": r"\\", '"': r"\"", "\n": r"\n", "\r": r"\r", "\0": r"\0"}


def to_text(values: list[object]) -> str:
    """The text of a bottle, on one line."""
    return " ".join(map(_text, values))


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Vocab):
        return f"[{value}]"
    if isinstance(value, str):
        if _BARE.match(value) and value not in ("true", "false", "inf", "nan", "null"):
            return value
        return '"' + "".join(_ESCAPED.get(letter, letter) for letter in value) + '"'
    if isinstance(value, bytes):
        return "{" + " ".join(map(str, value)) + "}"
    if isinstance(value, (list, tuple)):
        return "(" + to_text(list(value)) + ")"
    return repr(value)


def from_text(text: str) -> list[object]:
    """The values of a text.

    Raises:
        BottleError: a bracket or a quote is not closed, or it is nested too deeply.
    """
    stack: list[list[object]] = [[]]
    place = 0
    text = text.rstrip()
    while place < len(text):
        match = _TOKEN.match(text, place)
        if match is None:
            raise BottleError("a bracket or a quote is not closed")
        place = match.end()
        token = match[1]
        if token == "(":
            stack.append([])
            if len(stack) > _DEEPEST:
                raise BottleError("it is nested too deeply")
        elif token == ")":
            if len(stack) == 1:
                raise BottleError("a bracket is closed that was not opened")
            inner = stack.pop()
            stack[-1].append(inner)
        else:
            stack[-1].append(_value(token))
    if len(stack) > 1:
        raise BottleError("a bracket is not closed")
    return stack[0]


def _value(token: str) -> object:
    if token[0] == '"':
        return re.sub(r"\\(.)", lambda match: _ESCAPES.get(match[1], match[1]), token[1:-1], flags=re.DOTALL)
    if token[0] == "[":
        return Vocab(token[1:-1])
    if token[0] == "{":
        return _bytes(token[1:-1])
    if _INTEGER.match(token):
        return int(token, 16 if "x" in token.lower() else 10)
    if _NUMBER.match(token):
        return float(token)
    if token in ("true", "false"):
        return token == "true"
    return token


def _bytes(text: str) -> bytes:
    try:
        return bytes(int(number) for number in text.split())
    except ValueError:
        raise BottleError("the bytes of a blob are numbers from 0 to 255") from None
