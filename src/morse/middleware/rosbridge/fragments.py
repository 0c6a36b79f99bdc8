"""Messages in parts: the operation ``fragment``."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import msgspec

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.middleware.rosbridge.operations import Operation

#: characters of all parts of a client that wait for others, parts of a message, and messages of which parts lack
MOST, _MOST_PARTS, _MOST_OPEN = 1 << 20, 1 << 14, 8
_SMALLEST = 128

_numbers = itertools.count(1)


class Parts:
    """A message in parts, each of which is made when it is sent: there may be thousands.

    Args:
        frame: the message.
        size: maximum number of characters of a part, about.
    """

    def __init__(self, frame: str, size: float) -> None:
        self._frame, self._length = frame, max(_SMALLEST, int(size))

    def __len__(self) -> int:
        return len(self._frame)

    def __iter__(self) -> Iterator[str]:
        """The parts; the message itself if it is not longer than one."""
        frame, length = self._frame, self._length
        if len(frame) <= length:
            yield frame
            return
        number, total = f"fragment:{next(_numbers)}", -(-len(frame) // length)
        for index in range(total):
            data = frame[index * length : (index + 1) * length]
            part = {"op": "fragment", "id": number, "data": data, "num": index, "total": total}
            yield msgspec.json.encode(part).decode()


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
