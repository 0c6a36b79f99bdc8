"""JSON in the format of MORSE: ``{"x": 1.5, "y": [1.0, 2.0]}``, infinity as ``Infinity``."""

from __future__ import annotations

import base64
import json
import re
from enum import Enum
from functools import lru_cache
from typing import Any

import msgspec

from morse.core.streams.extent import listed
from morse.core.streams.local_data import LocalData
from morse.helpers.transformation import Transformation3d
from morse.mathutils import Euler, Matrix, Quaternion, Vector


def plain(value: object) -> Any:
    """Convert a value without a JSON representation to a value with one.

    Vectors become lists, matrices lists of rows, quaternions ``{x, y, z, w}``, Euler angles
    ``{yaw, pitch, roll}``, transformations ``{x, y, z, yaw, pitch, roll}``, numpy arrays lists,
    bytes base64.

    Raises:
        TypeError: it has no JSON representation.
    """
    if isinstance(value, Vector):
        return list(value)
    if isinstance(value, Matrix):
        return [list(row) for row in value]
    if isinstance(value, Quaternion):
        return {"x": value.x, "y": value.y, "z": value.z, "w": value.w}
    if isinstance(value, Euler):
        return {"yaw": value.z, "pitch": value.y, "roll": value.x}
    if isinstance(value, Transformation3d):
        return {name: getattr(value, name) for name in ("x", "y", "z", "yaw", "pitch", "roll")}
    if isinstance(value, (bytes, bytearray, memoryview)):
        return base64.b64encode(value).decode("ascii")
    if isinstance(value, float):
        return float(value)
    if isinstance(value, int):
        return int(value)
    if isinstance(value, str):
        return str(value)
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, (set, frozenset)):
        return sorted(value, key=str)  # the order of a set differs between processes
    if hasattr(value, "tolist"):  # numpy arrays and numbers
        return listed(value)
    raise TypeError(f"{type(value).__name__} {value!r:.80} cannot be written as JSON")


#: an escape that may be a lone surrogate, and such a surrogate
_SURROGATE, _HALF_PAIR = re.compile(rb"\\u[dD][89a-fA-F]"), re.compile("[\ud800-\udfff]")

_encoder = msgspec.json.Encoder(enc_hook=plain)
_MESSAGES: set[type] = {dict, LocalData}
_STRINGS = {str}


@lru_cache(maxsize=4096)
def _are_simple(keys: tuple[object, ...]) -> bool:
    return all(isinstance(key, str) and key.isidentifier() and key.isascii() and "null" not in key for key in keys)


def to_json(value: object) -> bytes:
    """Encode a value as one line of JSON, without the line end.

    Raises:
        TypeError: a value has no JSON representation (see `plain`).
        ValueError: the value contains itself.
    """
    # Most of the data are numbers, which msgspec writes ten times as fast as json.
    # If the keys are the only strings, only the blanks have to be added.
    if isinstance(value, dict):
        if value and {*map(type, value.values())} <= _MESSAGES and {*map(type, value)} == _STRINGS:
            # the data of several components: each of them may be quick to encode
            parts = [b"%b: %b" % (json.dumps(key).encode("ascii"), to_json(value[key])) for key in value]
            return b"{%b}" % b", ".join(parts)
        quotes = 2 * len(value)
        if not _are_simple(tuple(value)):
            return _slowly(value)
    else:
        quotes = 0
    try:
        text = _encoder.encode(value)
    except (TypeError, ValueError, OverflowError, RecursionError):
        return _slowly(value)
    # "null" may also be infinity or NaN; searching one character is much faster than four
    if text.count(b'"') != quotes or (b"u" in text and b"null" in text):
        return _slowly(value)
    return text.replace(b",", b", ").replace(b":", b": ")


def _slowly(value: object) -> bytes:
    try:
        return json.dumps(value, default=plain).encode("ascii")
    except RecursionError:
        raise ValueError("the value is nested too deeply, or contains itself") from None


#: maximum number of lists and objects of a text: to create more takes longer than a tick
_MOST_PARTS = 100_000


def from_json(text: bytes) -> object:
    """Decode a JSON text; ``NaN`` and ``Infinity`` are accepted.

    A lone surrogate, which is not a character and cannot be encoded, is replaced by U+FFFD.

    Raises:
        ValueError: it is not JSON, nested too deeply, or has more than 100000 lists and objects.
    """
    if len(text) > _MOST_PARTS and text.count(b"[") + text.count(b"{") > _MOST_PARTS:
        raise ValueError(f"more than {_MOST_PARTS} lists and objects")
    try:
        return msgspec.json.decode(text)
    except (msgspec.DecodeError, RecursionError, UnicodeDecodeError):
        pass
    try:
        value = json.loads(text.decode("utf-8", "replace"))
        if _SURROGATE.search(text):
            value = json.loads(_HALF_PAIR.sub("\ufffd", json.dumps(value, ensure_ascii=False)))
    except RecursionError:
        raise ValueError("nested too deeply") from None
    return value


def written(value: object) -> str:
    """The value in Python notation on one line; arrays as lists, a set in a fixed order."""
    return repr(_plain(value)).replace("\n", " ")


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):  # numpy
        return listed(value)
    if isinstance(value, dict):
        return {name: _plain(inner) for name, inner in value.items()}
    if type(value) in (list, tuple):
        return type(value)(_plain(inner) for inner in value)
    if isinstance(value, (set, frozenset)):
        return sorted(value, key=str)  # the order of a set differs between processes
    return value
