"""Finds messages of MAVLink among bytes that may come from anybody."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Container, Iterator

V1, V2 = 0xFE, 0xFD
_HEADS = {V1: 6, V2: 10}
_CHECKSUM, _SIGNATURE, _SIGNED = 2, 13, 1
#: the longest message
LONGEST = 10 + 255 + _CHECKSUM + _SIGNATURE


class Frame(NamedTuple):
    """What may be a message; its checksum is not checked.

    Attributes:
        number: of the kind of message.
        data: all its bytes.
    """

    number: int
    data: bytes


class Framer:
    """Keeps the beginning of a message until the rest arrives.

    Args:
        wanted: numbers of the messages to look for; the bytes of others are passed over.
    """

    def __init__(self, wanted: Container[int]) -> None:
        self._wanted = wanted
        self._rest = b""

    def feed(self, data: bytes) -> Iterator[Frame]:
        """What may be messages in the bytes that have arrived; call `found` for those that are."""
        data = self._rest + data
        self._rest = b""
        at = 0
        while True:
            at = _next_start(data, at)
            if at < 0:
                return
            frame = _frame(data, at)
            if frame is None:
                self._rest = data[at:]
                return
            if frame.number in self._wanted:
                yield frame
            # what looks like a message may be the middle of another one
            at += 1


def _next_start(data: bytes, at: int) -> int:
    found = [place for place in (data.find(V1, at), data.find(V2, at)) if place >= 0]
    return min(found, default=-1)


def _frame(data: bytes, at: int) -> Frame | None:
    """What begins at a place; None if more bytes are needed."""
    version = data[at]
    head = _HEADS[version]
    if len(data) - at < head:
        return None
    signed = version == V2 and data[at + 2] & _SIGNED
    end = at + head + data[at + 1] + _CHECKSUM + (_SIGNATURE if signed else 0)
    if end > len(data):
        return None
    number = data[at + 5] if version == V1 else int.from_bytes(data[at + 7 : at + 10], "little")
    return Frame(number, data[at:end])
