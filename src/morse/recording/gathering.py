"""Collects messages until there are enough for a chunk."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.recording.mcap.records import MESSAGE as MESSAGE_OPCODE
from morse.recording.mcap.records import MESSAGE_FIXED, MESSAGE_HEAD

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.recording.captures import Capture, Layout, Moments
    from morse.recording.mcap.records import Message
    from morse.recording.mcap.writer import Entries, Index

#: approximate overhead of a message, bytes
_OVERHEAD = 100
#: approximate size of the poses in a block, bytes, and ticks of a block: writing to uncached memory takes time
_BLOCK, _LEAST_TICKS, _MOST_TICKS = 1 << 18, 16, 1024


class Block:
    """Memory for the poses of many ticks; it is reused after they are encoded.

    Attributes:
        first, last: the rigid groups whose poses are stored: ``range(first, last)``.
        positions, rotations: (R, K, 3) m and (R, K, 9) of these groups.
        count: R.
        rows: pairs of views, one for each tick.
    """

    def __init__(self, first: int, last: int) -> None:
        self.first, self.last = first, last
        slots = last - first
        count = min(max(_BLOCK // (96 * max(slots, 1)), _LEAST_TICKS), _MOST_TICKS)
        self.count = count
        self.positions, self.rotations = np.empty((count, slots, 3)), np.empty((count, slots, 9))
        self.rows = list(zip(self.positions, self.rotations, strict=True))


class Gathered:
    """The messages of a chunk, in order.

    Attributes:
        ticks: number and records of each tick that is encoded later.
        block: poses of these ticks, or None.
        moments: computes the times of these ticks.
        scans: data of captures, by capture.
        held: approximate memory of the messages, bytes.
    """

    __slots__ = ("_messages", "block", "held", "moments", "scans", "ticks")

    def __init__(self) -> None:
        self.held = 0
        self.block: Block | None = None
        self.moments: Moments | None = None
        self.ticks: list[tuple[int, Layout]] = []
        self.scans: dict[Capture, list[Any]] = {}
        #: number of ticks before each message, and the message
        self._messages: list[tuple[int, Message]] = []

    def __bool__(self) -> bool:
        return bool(self.ticks or self._messages)

    def message(self, one: Message) -> None:
        """Add a message."""
        self._messages.append((len(self.ticks), one))
        self.held += _OVERHEAD + len(one.data)

    def weight(self) -> int:
        """Approximate total memory, bytes."""
        return self.held + (len(self.ticks) * self.ticks[-1][1].held if self.ticks else 0)

    # -- encoding ----------------------------------------------------------------------------

    def encoded(self) -> tuple[NDArray[np.uint8], Index]:
        """Return the records, and the positions of the messages of each channel in them."""
        sizes = np.array([MESSAGE_HEAD.size + len(one.data) for _, one in self._messages], dtype=np.int64)
        before = np.array([count for count, _ in self._messages], dtype=np.int64)
        ticks = np.array([layout.size for _, layout in self.ticks], dtype=np.int64)
        # number of all ticks and messages before each one
        ticks_before, sizes_before = _sums(ticks), _sums(sizes)
        chunk = np.empty(ticks_before[-1] + sizes_before[-1], dtype=np.uint8)
        found: dict[int, list[Entries]] = {}
        if self.ticks:
            begins = ticks_before[:-1] + sizes_before[np.searchsorted(before, np.arange(len(ticks)), side="right")]
            self._encode_ticks(begins, chunk, found)
        if self._messages:
            self._encode_messages((sizes_before[:-1] + ticks_before[before]).tolist(), chunk.data, found)
        index: dict[int, Entries] = {}
        for channel, parts in found.items():
            entries = parts[0] if len(parts) == 1 else np.concatenate(parts)
            index[channel] = entries if len(parts) == 1 else entries[np.argsort(entries[:, 1], kind="stable")]
        return chunk, index

    def _encode_ticks(
        self, begins: NDArray[np.int64], chunk: NDArray[np.uint8], found: dict[int, list[Entries]]
    ) -> None:
        assert self.moments is not None
        numbers, layouts = zip(*self.ticks, strict=True)
        moments = self.moments.of(numbers)
        known = list(dict.fromkeys(layouts))
        codes = {layout: code for code, layout in enumerate(known)}
        which = np.array([codes[layout] for layout in layouts], dtype=np.int64)
        for capture in dict.fromkeys(capture for layout in known for capture in layout.offsets):
            offsets = np.array([layout.offsets.get(capture, -1) for layout in known], dtype=np.int64)[which]
            rows = np.flatnonzero(offsets >= 0)
            starts, times = begins[rows] + offsets[rows], moments[rows]
            capture.encode(starts, times, self._data_of(capture, rows), chunk)
            heads = capture.template.heads
            entries = np.empty((len(heads), len(rows), 2), dtype=np.int64)
            entries[:, :, 0] = times[:, 1]
            entries[:, :, 1] = starts + heads[:, None]
            for channel, part in zip(capture.template.channels, entries, strict=True):
                found.setdefault(channel, []).append(part)

    def _data_of(self, capture: Capture, rows: NDArray[np.int64]) -> Sequence[Any]:
        taken = self.scans.get(capture)
        if taken is not None:
            return taken
        block = self.block
        assert block is not None
        some = slice(len(rows)) if len(rows) == len(self.ticks) else rows
        return block.positions[some], block.rotations[some], block.first

    def _encode_messages(self, begins: list[int], chunk: memoryview, found: dict[int, list[Entries]]) -> None:
        places: dict[int, list[tuple[int, int]]] = {}
        for begin, (_, one) in zip(begins, self._messages, strict=True):
            end = begin + MESSAGE_HEAD.size
            size = MESSAGE_FIXED + len(one.data)
            numbers = one.channel, one.sequence, one.log_time, one.publish_time
            MESSAGE_HEAD.pack_into(chunk, begin, MESSAGE_OPCODE, size, *numbers)
            chunk[end : end + len(one.data)] = one.data
            places.setdefault(one.channel, []).append((one.log_time, begin))
        for channel, entries in places.items():
            found.setdefault(channel, []).append(np.array(entries, dtype=np.int64))


def _sums(values: NDArray[np.int64]) -> NDArray[np.int64]:
    """(N + 1,) sums of the first 0, 1, ... N values."""
    return np.concatenate((np.zeros(1, dtype=np.int64), np.cumsum(values)))
