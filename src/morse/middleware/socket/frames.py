"""Messages as binary frames.

A frame is a header of 16 bytes, a text and arrays, all little-endian:

====== ===== ==================================================================
offset bytes
====== ===== ==================================================================
0      2     ``MF``
2      1     version, 1
3      1     kind: `NOTICE`, `DATA` or `LINE`
4      4     number of the stream, unsigned; 0 for a notice
8      4     bytes of the text, unsigned; a multiple of 8
12     4     bytes of numbers and arrays, unsigned; a multiple of 8
====== ===== ==================================================================

The text of `DATA` is JSON, padded with blanks: ``{"numbers": [name, ...], "arrays": [[name, type, shape], ...],
"fields": {...}}``. The floating-point numbers follow the text, 8 bytes each, then the arrays, row by row, each padded
with zeros to a multiple of 8 bytes. Types are those of `TYPES`, or ``bytes``. ``fields`` contains all other values.
"""

from __future__ import annotations

import functools
import json
import struct
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from morse.core.streams.local_data import Later
from morse.wire.encoding import plain

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.values import JsonObject

VERSION = 1
NOTICE, DATA, LINE = 0, 1, 2
"""A notice about the connection; a message; a message of a publisher that writes its own lines."""
TYPES = frozenset(("|b1", "|i1", "|u1", "<i2", "<u2", "<i4", "<u4", "<i8", "<u8", "<f4", "<f8"))
"""Types of the elements of arrays, in the notation of numpy: boolean, integer, unsigned, floating-point, and bytes."""

_HEAD = struct.Struct("<2sBBIII")
_ALIGNMENT = 8
#: maximum size of the text and of the arrays of a frame, bytes
_MAX_SIZE = (1 << 32) - _ALIGNMENT
_FLOATS = {float}
_encoder = msgspec.json.Encoder(enc_hook=plain)


def data_frame(number: int, fields: JsonObject) -> bytes:
    """Encode a message as a frame; floats, numpy arrays and bytes are binary, all other values are JSON.

    Args:
        number: id of the stream.
        fields: data by name.

    Raises:
        TypeError: a value has neither a binary nor a JSON representation.
        ValueError: a value contains itself, or the message is too large.
    """
    # copying a LocalData by its own methods takes several times as long as the rest
    values: JsonObject = dict.copy(fields)
    if {*map(type, values.values())} == _FLOATS:
        beginning, fixed = _prepared(number, tuple(values))
        return beginning + fixed.pack(*values.values())
    return _mixed_frame(number, fields, values)


@functools.lru_cache(maxsize=4096)
def _prepared(number: int, names: tuple[str, ...]) -> tuple[bytes, struct.Struct]:
    """The beginning of frames that only have numbers, and the format of the numbers."""
    layout = struct.Struct(f"<{len(names)}d")
    return _beginning(number, _described(names, ()), layout.size), layout


@functools.lru_cache(maxsize=4096)
def _described(numbers: tuple[str, ...], arrays: tuple[object, ...]) -> bytes:
    """The text of messages without other fields."""
    return _compact({"numbers": numbers, "arrays": arrays, "fields": {}})


def _mixed_frame(number: int, fields: Mapping[str, object], values: JsonObject) -> bytes:
    numbers: list[float] = []
    names: list[str] = []
    arrays: list[tuple[str, str, tuple[int, ...]]] = []
    others: JsonObject = {}
    parts: list[bytes | memoryview] = []
    for name, value in values.items():
        if type(value) is Later:
            value = fields[name]  # which computes it
        if isinstance(value, float):
            names.append(name)
            numbers.append(value)
        elif isinstance(value, np.ndarray) and (kind := _type_of(value.dtype)):
            arrays.append((name, kind, value.shape))
            _append(parts, np.ascontiguousarray(value, kind).data.cast("B") if value.size else b"")
        elif isinstance(value, (bytes, bytearray, memoryview)):
            content = bytes(value)
            arrays.append((name, "bytes", (len(content),)))
            _append(parts, content)
        else:
            others[name] = value
    parts.insert(0, struct.pack(f"<{len(numbers)}d", *numbers))
    if others:
        text = _compact({"numbers": names, "arrays": arrays, "fields": others})
    else:
        text = _described(tuple(names), tuple(arrays))
    return b"".join((_beginning(number, text, sum(map(len, parts))), *parts))


@functools.lru_cache(maxsize=64)
def _type_of(dtype: Any) -> str:
    """The type of the elements of an array; empty if frames do not support it."""
    kind = str(dtype.newbyteorder("<").str)
    return kind if kind in TYPES else ""


def _append(parts: list[bytes | memoryview], content: bytes | memoryview) -> None:
    parts.append(content)
    if rest := -len(content) % _ALIGNMENT:
        parts.append(bytes(rest))


def line_frame(number: int, line: bytes) -> bytes:
    """The frame of a message that is already a line of text."""
    return _beginning(number, line, 0, LINE)


def notice_frame(notice: Mapping[str, object]) -> bytes:
    """The frame of a notice."""
    return _beginning(0, _compact(notice), 0, NOTICE)


def _beginning(number: int, text: bytes, size: int, kind: int = DATA) -> bytes:
    """Header and text of a frame with a number of bytes of numbers and arrays."""
    filling = b" " * (-len(text) % _ALIGNMENT)
    if max(size, len(text)) > _MAX_SIZE:
        raise ValueError(f"a message of {size + len(text)} bytes is too large for a frame")
    return b"".join((_HEAD.pack(b"MF", VERSION, kind, number, len(text) + len(filling), size), text, filling))


def _compact(value: Mapping[str, object]) -> bytes:
    try:
        text = _encoder.encode(value)
    except (TypeError, ValueError, OverflowError, RecursionError):
        return _slowly(value)
    # "null" may also be infinity or NaN
    return _slowly(value) if b"null" in text else text


def _slowly(value: Mapping[str, object]) -> bytes:
    try:
        return json.dumps(value, default=plain, separators=(",", ":")).encode("ascii")
    except RecursionError:
        raise ValueError("the value is nested too deeply, or contains itself") from None
