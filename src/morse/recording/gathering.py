"""Collects messages until there are enough for a chunk."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.recording.mcap.records import MESSAGE as MESSAGE_OPCODE
from morse.recording.mcap.records import MESSAGE_FIXED, MESSAGE_HEAD

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from numpy.typing import NDArray

    from morse.recording.captures import Capture, Layout, Moments
    from morse.recording.mcap.records import Message
    from morse.recording.mcap.writer import Entries, Index

#: approximate overhead of a message, bytes
_OVERHEAD = 100


class Memory:
    """Memory for one chunk at a time; it is reused.

    The first access to a page of new memory takes as long as encoding the messages of a tick.
    """

    def __init__(self) -> None:
        self._bytes = np.empty(0, dtype=np.uint8)
        self._stacks: dict[object, NDArray[np.float64]] = {}

    def of(self, size: int) -> NDArray[np.uint8]:
        """Return (size,) bytes, which are valid until the next call."""
        if len(self._bytes) < size:
            self._bytes = np.empty(size + size // 4, dtype=np.uint8)
        return self._bytes[:size]

    def stacked(self, key: object, arrays: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
        """Return R arrays of one shape (N, D) as one array (R, N, D), valid until the next call with that key."""
        count, shape = len(arrays), arrays[0].shape
        memory = self._stacks.get(key)
        if memory is None or len(memory) < count or memory.shape[1:] != shape:
            memory = self._stacks[key] = np.empty((count + count // 4, *shape))
        stack = memory[:count]
        np.concatenate(arrays, out=stack.reshape(-1, shape[1]))
        return stack

    def keep(self, keys: Collection[object]) -> None:
        """Release the memory of all other keys."""
        self._stacks = {key: stack for key, stack in self._stacks.items() if key in keys}


class Gathered:
    """The messages of a chunk, in order.

    Attributes:
        ticks: number and records of each tick that is encoded later.
        positions, rotations: poses of rigid groups in each of these ticks, (K, 3) m and (K, 9).
        window: the rigid groups of the poses, see `Layout.window`.
        moments: computes the times of these ticks.
        scans: the distances (B, rays) in each tick with a scan, m, by capture.
        held: approximate memory of all messages, bytes.
    """

    __slots__ = ("_messages", "held", "moments", "positions", "rotations", "scans", "ticks", "window")

    def __init__(self) -> None:
        self.held = 0
        self.positions: list[NDArray[np.float64]] = []
        self.rotations: list[NDArray[np.float64]] = []
        self.window: tuple[int, int, int] | None = None
        self.moments: Moments | None = None
        self.ticks: list[tuple[int, Layout]] = []
        self.scans: dict[Capture, list[NDArray[np.float64]]] = {}
        #: number of ticks before each message, and the message
        self._messages: list[tuple[int, Message]] = []

    def __bool__(self) -> bool:
        return bool(self.ticks or self._messages)

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
            self._encode_ticks(begins, chunk, memory, found)
        if self._messages:
            self._encode_messages((sizes_before[:-1] + ticks_before[before]).tolist(), chunk.data, found)
        index: dict[int, Entries] = {}
        for channel, parts in found.items():
            entries = parts[0] if len(parts) == 1 else np.concatenate(parts)
            index[channel] = entries if len(parts) == 1 else entries[np.argsort(entries[:, 1], kind="stable")]
        return chunk, index

    def _encode_ticks(
        self, begins: NDArray[np.int64], chunk: NDArray[np.uint8], memory: Memory, found: dict[int, list[Entries]]
    ) -> None:
        assert self.moments is not None
        assert self.window is not None
        memory.keep({"positions", "rotations", *self.scans})
        poses = memory.stacked("positions", self.positions), memory.stacked("rotations", self.rotations)
        numbers, layouts = zip(*self.ticks, strict=True)
        moments = self.moments.of(numbers)
        known = list(dict.fromkeys(layouts))
        codes = {layout: code for code, layout in enumerate(known)}
        which = np.array([codes[layout] for layout in layouts], dtype=np.int64)
        for capture in dict.fromkeys(capture for layout in known for capture in layout.offsets):
            offsets = np.array([layout.offsets.get(capture, -1) for layout in known], dtype=np.int64)[which]
            rows = np.flatnonzero(offsets >= 0)
            starts, times = begins[rows] + offsets[rows], moments[rows]
            if capture in self.scans:
                data: Any = memory.stacked(capture, self.scans[capture])
            else:
                some = slice(None) if len(rows) == len(self.ticks) else rows
                data = poses[0][some], poses[1][some], self.window[2]
            capture.encode(starts, times, data, chunk)
            heads = capture.template.heads
            entries = np.empty((len(heads), len(rows), 2), dtype=np.int64)
            entries[:, :, 0] = times[:, 1]
            entries[:, :, 1] = starts + heads[:, None]
            for channel, part in zip(capture.template.channels, entries, strict=True):
                found.setdefault(channel, []).append(part)

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
