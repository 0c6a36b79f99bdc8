"""Finds MAVLink messages in bytes from untrusted senders."""

from __future__ import annotations

import re
from functools import cache
from operator import itemgetter
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

if TYPE_CHECKING:
    from collections.abc import Collection


class MavlinkMessage(Protocol):
    """A message of the dialect; its fields are attributes by the names of the dialect.

    pymavlink makes the classes of messages at run time and has no types for them.
    """

    def get_type(self) -> str:
        """The name of the message, in upper case."""

    def __getattr__(self, field: str) -> Any:
        """A field: a number, a string, or a list of numbers."""


V1, V2 = 0xFE, 0xFD
_HEADS = {V1: 6, V2: 10}
_CHECKSUM, _SIGNATURE, _SIGNED = 2, 13, 1
#: maximum length of a message
LONGEST = 10 + 255 + _CHECKSUM + _SIGNATURE


class Frame(NamedTuple):
    """A candidate for a message; its checksum is not verified.

    Attributes:
        number: id of the message type.
        data: all its bytes.
    """

    number: int
    data: bytes


class Framer:
    """Keeps an incomplete message until the rest arrives.

    Args:
        ids: ids of the message types to search for; the bytes of others are skipped.
    """

    def __init__(self, ids: Collection[int]) -> None:
        self._starts = _starts(frozenset(ids))
        self._rest = b""
        #: the candidates in the rest up to this one are known
        self._looked_at = 0

    def feed(self, data: bytes) -> list[Frame]:
        """Candidates for messages in the received bytes; a candidate may be a part of another message."""
        old, looked_at, data = len(self._rest), self._looked_at, self._rest + data
        self._rest, self._looked_at = b"", 0
        incomplete, end = len(data), len(data)
        complete: list[tuple[int, Frame]] = []
        for start in self._starts.finditer(data):
            at = start.start()
            frame = _frame(data, at)
            if frame is None:
                # it need not be a message: it holds up none that follows
                incomplete = min(incomplete, at)
                if len(data) - at < _HEADS[V2]:
                    end = at
                    break
            elif at > looked_at or at + len(frame.data) > old:
                complete.append((at + len(frame.data), frame))  # it was not complete before
        self._rest, self._looked_at = data[incomplete:], end - incomplete
        # in the order in which they are complete, also if the data arrive in pieces
        complete.sort(key=itemgetter(0))
        return [frame for _, frame in complete]


@cache
def _starts(messages: frozenset[int]) -> re.Pattern[bytes]:
    """Matches the first byte of a message of wanted types, also of one whose type has not arrived."""
    ids = [number.to_bytes(3, "little") for number in sorted(messages)]
    first = b"|".join(re.escape(number[:1]) for number in ids if number[1:] == b"\0\0") or b"(?!)"
    second = b"|".join(map(re.escape, ids)) or b"(?!)"
    # fewer bytes than a head at the end of the data
    return re.compile(rb"\xfe(?=.{4}(?:%b)|.{0,4}\Z)|\xfd(?=.{6}(?:%b)|.{0,8}\Z)" % (first, second), re.DOTALL)


def _frame(data: bytes, at: int) -> Frame | None:
    """The candidate at an offset; None if more bytes are needed."""
    version = data[at]
    head = _HEADS[version]
    if len(data) - at < head:
        return None
    has_signature = version == V2 and data[at + 2] & _SIGNED
    end = at + head + data[at + 1] + _CHECKSUM + (_SIGNATURE if has_signature else 0)
    if end > len(data):
        return None
    number = data[at + 5] if version == V1 else int.from_bytes(data[at + 7 : at + 10], "little")
    return Frame(number, data[at:end])
