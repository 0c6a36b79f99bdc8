"""Collects messages until there are enough for a chunk."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.recording.mcap.records import MESSAGE as MESSAGE_OPCODE
from morse.recording.mcap.records import MESSAGE_FIXED, MESSAGE_HEAD

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.recording.captures import Capture, Layout, Moments
    from morse.recording.mcap.records import Message
    from morse.recording.mcap.writer import Entries, Index

#: approximate overhead of a message, bytes
_OVERHEAD = 100
#: approximate size of the poses in a block, bytes, and ticks of a block: writing to uncached memory takes time
_BLOCK, _LEAST_TICKS, _MOST_TICKS = 1 << 20, 16, 2048


class Block:
    """Memory for the poses and scans of many ticks; it is reused after they are encoded.

    The first access to a page of new memory takes as long as encoding the messages of a tick.

    Attributes:
        first, last: the rigid groups whose poses are stored: ``range(first, last)``.
        positions, rotations: (R, K, 3) m and (R, K, 9) of these groups.
        scans: (R, B, rays) m by capture; pages without a scan are not accessed.
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
        self.scans: dict[Capture, NDArray[np.float64]] = {}


class Memory:
    """Memory for the records of one chunk at a time."""

    def __init__(self) -> None:
        self._bytes = np.empty(0, dtype=np.uint8)

    def of(self, size: int) -> NDArray[np.uint8]:
        """Return (size,) bytes, which are valid until the next call."""
        if len(self._bytes) < size:
            self._bytes = np.empty(size + size // 4, dtype=np.uint8)
        return self._bytes[:size]


class Gathered:
    """The messages of a chunk, in order.

    Attributes:
        ticks: number and records of each tick that is encoded later.
        block: poses of these ticks, or None.
        moments: computes the times of these ticks.
        scans: number of scans by capture.
        held: approximate memory of all messages, bytes.
    """

    __slots__ = ("_messages", "block", "held", "moments", "scans", "ticks")

    def __init__(self) -> None:
        self.held = 0
        self.block: Block | None = None
        self.moments: Moments | None = None
        self.ticks: list[tuple[int, Layout]] = []
        self.scans: dict[Capture, int] = {}
        #: number of ticks before each message, and the message
        self._messages: list[tuple[int, Message]] = []

    def __bool__(self) -> bool:
        return bool(self.ticks or self._messages)

    def scan(self, capture: Capture, distances: NDArray[np.float64]) -> None:
        """Copy the scans (B, rays) of a tick into the block."""
        assert self.block is not None
        memory = self.block.scans.get(capture)
        if memory is None:
            memory = self.block.scans[capture] = np.empty((self.block.count, *distances.shape))
        row = self.scans.get(capture, 0)
        memory[row] = distances
        self.scans[capture] = row + 1

    def message(self, one: Message) -> None:
        """Add a message."""
        self._messages.append((len(self.ticks), one))
        self.held += _OVERHEAD + len(one.data)

    # -- encoding ----------------------------------------------------------------------------

    def encoded(self, memory: Memory) -> tuple[NDArray[np.uint8], Index]:
        """Return the records, and the positions of the messages of each channel in them.

        Args:
            memory: receives the records.
        """
        sizes = np.array([MESSAGE_HEAD.size + len(one.data) for _, one in self._messages], dtype=np.int64)
        before = np.array([count for count, _ in self._messages], dtype=np.int64)
        ticks = np.array([layout.size for _, layout in self.ticks], dtype=np.int64)
        # number of all ticks and messages before each one
        ticks_before, sizes_before = _sums(ticks), _sums(sizes)
        chunk = memory.of(int(ticks_before[-1] + sizes_before[-1]))
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

    def _data_of(self, capture: Capture, rows: NDArray[np.int64]) -> Any:
        block = self.block
        assert block is not None
        if capture in self.scans:
            return block.scans[capture][: self.scans[capture]]
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
