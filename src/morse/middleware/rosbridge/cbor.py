"""CBOR (RFC 8949), with arrays of numbers as typed arrays (RFC 8746): the compression ``cbor`` of rosbridge."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

#: major types; simple values and numbers of 64 bits
_POSITIVE, _NEGATIVE, _BYTES, _TEXT, _LIST, _MAP, _TAG = range(7)
_FALSE, _TRUE, _NULL, _DOUBLE = b"\xf4", b"\xf5", b"\xf6", b"\xfb"
#: tags of little-endian arrays; bytes of rosbridge have none
_TAGS = {"u2": 69, "u4": 70, "u8": 71, "i1": 72, "i2": 77, "i4": 78, "i8": 79, "f4": 85, "f8": 86}


def encode(value: object) -> bytes:
    """Encode numbers, texts, bytes, arrays (N,) of numpy, lists and dictionaries with names as keys.

    Raises:
        TypeError: a value is none of these.
        OverflowError: an integer needs more than 64 bits.
    """
    parts: list[bytes] = []
    _write(value, parts.append)
    return b"".join(parts)


def _head(major: int, number: int) -> bytes:
    if number < 24:
        return bytes((major << 5 | number,))
    size = next((size for size in (1, 2, 4, 8) if number < 1 << 8 * size), 16)
    return bytes((major << 5 | 23 + size.bit_length(),)) + number.to_bytes(min(size, 8), "big")


def _write(value: object, put: Callable[[bytes], None]) -> None:
    if isinstance(value, (bool, np.bool_)) or value is None:
        put(_NULL if value is None else _TRUE if value else _FALSE)
    elif isinstance(value, (int, np.integer)):
        number = int(value)
        put(_head(_POSITIVE, number) if number >= 0 else _head(_NEGATIVE, -1 - number))
    elif isinstance(value, (float, np.floating)):
        put(_DOUBLE + struct.pack(">d", value))
    elif isinstance(value, str):
        text = value.encode()
        put(_head(_TEXT, len(text)) + text)
    elif isinstance(value, (bytes, bytearray, memoryview)):
        put(_head(_BYTES, len(value)) + bytes(value))
    elif isinstance(value, np.ndarray):
        _write_array(value, put)
    elif isinstance(value, (list, tuple)):
        put(_head(_LIST, len(value)))
        for item in value:
            _write(item, put)
    elif isinstance(value, dict):
        _write_map(value, put)
    else:
        raise TypeError(f"CBOR has no {type(value).__name__}")


def _write_map(value: Mapping[str, object], put: Callable[[bytes], None]) -> None:
    put(_head(_MAP, len(value)))
    for name, item in value.items():
        _write(name, put)
        _write(item, put)


def _write_array(array: np.ndarray, put: Callable[[bytes], None]) -> None:
    kind = array.dtype.str[1:]
    if kind not in _TAGS and kind != "u1":
        _write(array.tolist(), put)
        return
    data = np.ascontiguousarray(array, array.dtype.newbyteorder("<")).tobytes()
    if kind in _TAGS:
        put(_head(_TAG, _TAGS[kind]))
    put(_head(_BYTES, len(data)))
    put(data)
