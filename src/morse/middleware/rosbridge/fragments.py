"""Messages in parts: the operation ``fragment``."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import msgspec

if TYPE_CHECKING:
    from morse.middleware.rosbridge.operations import Operation

#: characters of all parts of a client that wait for others, parts of a message, and messages of which parts lack
MOST, _MOST_PARTS, _MOST_OPEN = 1 << 20, 1 << 14, 8
_SMALLEST = 128

_numbers = itertools.count(1)


def in_parts(frame: str, size: float) -> list[str]:
    """A message in parts of at most about ``size`` characters; the message itself if it is not longer."""
    length = max(_SMALLEST, int(size))
    if len(frame) <= length:
        return [frame]
    number = f"fragment:{next(_numbers)}"
    pieces = [frame[at : at + length] for at in range(0, len(frame), length)]
    return [
        msgspec.json.encode(
            {"op": "fragment", "id": number, "data": piece, "num": index, "total": len(pieces)}
        ).decode()
        for index, piece in enumerate(pieces)
    ]


class Puzzle:
    """Puts messages of a client together."""

    def __init__(self) -> None:
        #: the pieces of each message by its id, and how many it has
        self._open: dict[str | int | None, tuple[int, dict[int, str]]] = {}
        self._size = 0

    def add(self, operation: Operation) -> str | None:
        """Add a part; the message if it is complete.

        Raises:
            ValueError: the part is not valid, or all parts together are too long.
        """
        total, index = operation.total, operation.num
        if not 0 < total <= _MOST_PARTS or not 0 <= index < total:
            raise ValueError(f"'fragment' needs 'total' from 1 to {_MOST_PARTS}, and 'num' from 0 and below it")
        if operation.id not in self._open and len(self._open) >= _MOST_OPEN:
            self._close(next(iter(self._open)))
        count, pieces = self._open.setdefault(operation.id, (total, {}))
        self._size += len(operation.data) - len(pieces.get(index, ""))
        pieces[index] = operation.data
        if count != total or self._size > MOST:
            self._close(operation.id)
            raise ValueError(f"fragments of a message have one 'total'; those of all have at most {MOST} characters")
        if len(pieces) < total:
            return None
        self._close(operation.id)
        return "".join(pieces[number] for number in range(total))

    def _close(self, number: str | int | None) -> None:
        _, pieces = self._open.pop(number)
        self._size -= sum(map(len, pieces.values()))
