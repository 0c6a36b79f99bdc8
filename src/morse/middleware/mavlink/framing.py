"""Finds MAVLink messages in bytes from untrusted senders."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Container, Iterator

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
        wanted: ids of the message types to search for; the bytes of others are skipped.
    """

    def __init__(self, wanted: Container[int]) -> None:
        self._wanted = wanted
        self._rest = b""

    def feed(self, data: bytes) -> Iterator[Frame]:
        """Candidates for messages in the received bytes; call `found` for those that are valid."""
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
            # a candidate may be a part of another message
            at += 1


def _next_start(data: bytes, at: int) -> int:
    found = [place for place in (data.find(V1, at), data.find(V2, at)) if place >= 0]
    return min(found, default=-1)


def _frame(data: bytes, at: int) -> Frame | None:
    """The candidate at an offset; None if more bytes are needed."""
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
