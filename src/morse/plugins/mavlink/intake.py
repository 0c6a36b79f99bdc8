"""Limits what one tick takes from the senders of a link: to search a flood of bytes takes longer than a tick."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.plugins.mavlink.framing import Frame, Framer

#: limits for one sender in one tick: bytes, and candidates for messages; ten times what an autopilot sends at 1 kHz
_MOST_BYTES, _MOST_FRAMES = 1 << 14, 256
#: all senders of a link together may use as much as this number of senders, and each of them this part in any case
_SENDERS, _PART = 2, 1 / 32


class Intake:
    """The bytes and messages that one tick takes from a link.

    Attributes:
        lost: whether bytes or messages were dropped.
    """

    def __init__(self) -> None:
        self.lost = False
        self._bytes: Counter[object] = Counter()
        self._frames: Counter[object] = Counter()

    def frames(self, sender: object, framer: Framer, data: bytes) -> Iterator[Frame]:
        """The candidates for messages that the tick takes.

        Args:
            sender: identifies the sender.
            framer: has the earlier bytes of the sender.
            data: newly received bytes.
        """
        room = _room(self._bytes, sender, _MOST_BYTES)
        self._bytes[sender] += min(len(data), room)
        self.lost |= len(data) > room
        frames = framer.feed(data[:room])
        count = min(len(frames), _room(self._frames, sender, _MOST_FRAMES))
        self._frames[sender] += count
        self.lost |= len(frames) > count
        yield from frames[:count]


def _room(counts: Counter[object], sender: object, most: int) -> int:
    free = max(_SENDERS * most - counts.total(), int(most * _PART) - counts[sender])
    return max(0, min(most - counts[sender], free))
