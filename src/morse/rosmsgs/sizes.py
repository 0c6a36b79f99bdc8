"""The sizes of received messages: a message that is far larger than its type is refused before it is decoded."""

from __future__ import annotations

from functools import cache
from struct import calcsize

from morse.rosmsgs.cdr import CdrError
from morse.rosmsgs.definitions import PRIMITIVES, SEQUENCE, fields_of

#: size of a message with lists, bytes: more than ten thousand names of joints, whose decoding takes some ticks
_LARGEST = 1 << 19
#: a message without lists may have this multiple of its usual size: texts, and the text of numbers in JSON, are longer
_MULTIPLE, _LEAST = 100, 1 << 13
#: usual length of a text
_TEXT = 16


@cache
def largest(type_name: str) -> int:
    """The size up to which a message of a type is decoded, bytes."""
    usual = _usual(type_name)
    return _LARGEST if usual is None else min(_LARGEST, max(_LEAST, _MULTIPLE * usual))


def check_size(type_name: str, data: object) -> None:
    """Refuse a message that is too large for its type.

    Raises:
        CdrError: it is.
    """
    if isinstance(data, (bytes, str)) and len(data) > largest(type_name):
        raise CdrError(f"it has {len(data)} bytes; a {type_name} of at most {largest(type_name)} is accepted")


def _usual(type_name: str) -> int | None:
    """The usual size of a message; None if it has a list."""
    size = 0
    for field in fields_of(type_name):
        if field.size == SEQUENCE:
            return None
        one = _TEXT if field.type == "string" else calcsize(PRIMITIVES.get(field.type, "x"))
        if field.type != "string" and field.type not in PRIMITIVES:
            inner = _usual(field.type)
            if inner is None:
                return None
            one = inner
        size += one * max(field.size, 1)
    return size
