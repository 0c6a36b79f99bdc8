"""Encodes the messages of a chunk."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.kernel.recording import Similar
from morse.recording.captures.poses import groups_of_arrays
from morse.recording.mcap.index import ChunkIndex, index_of
from morse.recording.mcap.records import CHUNK_ROOM, INDEX_HEAD, MESSAGE_FIXED, MESSAGE_HEAD
from morse.recording.mcap.records import MESSAGE as MESSAGE_OPCODE

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from morse.kernel.recording import NativeRecords
    from morse.recording.captures import Capture, Layout, Moments
    from morse.recording.mcap.index import Entries
    from morse.recording.mcap.records import Message

#: number of values of a tick in a flat list: its number, its records, positions (K, 3) m and rotations (K, 9) of rigid
#: groups, their addresses (see `groups_of_arrays`), other data by capture. The arrays never change.
VALUES = 7
#: share of a chunk above which messages that no capture encodes are compressed by the library
_MOST_OTHERS = 0.2


class Memory:
    """Memory for one chunk at a time; it is reused.

    The first access to a page of new memory takes as long as encoding the messages of a tick.
    """

    def __init__(self) -> None:
        self._bytes: dict[str, NDArray[np.uint8]] = {}

    def of(self, name: str, size: int) -> NDArray[np.uint8]:
        """Return (size,) bytes, which are valid until the next call with that name."""
        memory = self._bytes.get(name)
        if memory is None or len(memory) < size:
            memory = self._bytes[name] = np.empty(size + size // 4, dtype=np.uint8)
        return memory[:size]


class Encoded(NamedTuple):
    """The messages of a chunk as records.

    Attributes:
        plain: the records.
        positions: the positions of the messages.
        packed: `CHUNK_ROOM` bytes, the compressed records and those of the positions; None if they are not compressed.
        size: size of the compressed records, bytes.
    """

    plain: NDArray[np.uint8]
    positions: ChunkIndex
    packed: NDArray[np.uint8] | None = None
    size: int = 0


class Gathered:
    """The messages of a chunk, in order.

    Args:
        moments: computes the times of the ticks; only needed for ticks.
        native: the encoder; only needed for ticks.

    Attributes:
        ticks: the ticks that are encoded now, `VALUES` values of each.
        messages: number of these ticks before each other message, and the message.
    """

    def __init__(self, moments: Moments | None, native: NativeRecords | None) -> None:
        self.ticks: list[Any] = []
        self.messages: list[tuple[int, Message]] = []
        self._moments, self._native = moments, native

    def __bool__(self) -> bool:
        return bool(self.ticks or self.messages)

    def encoded(self, memory: Memory, is_quick: Callable[[int], bool]) -> Encoded:
        """Return the records; they are valid until the next call with the same memory.

        Args:
            memory: for the records.
            is_quick: returns for the size of the records in bytes whether to compress them here, if most of them
                resemble each other.
        """
        if not self.ticks:
            return self._encoded_messages(memory)
        return _Ticks(self, memory).encoded(is_quick)

    def _encoded_messages(self, memory: Memory) -> Encoded:
        begins = sums([MESSAGE_HEAD.size + len(one.data) for _, one in self.messages])
        chunk = memory.of("chunk", int(begins[-1]))
        return Encoded(chunk, index_of(self.write_messages(begins[:-1], chunk)))

    def write_messages(self, begins: NDArray[np.int64], chunk: NDArray[np.uint8]) -> dict[int, Entries]:
        """Write the messages, and return their positions by channel."""
        places: dict[int, list[tuple[int, int]]] = {}
        view = chunk.data
        for begin, (_, one) in zip(begins.tolist(), self.messages, strict=True):
            end = begin + MESSAGE_HEAD.size
            size = MESSAGE_FIXED + len(one.data)
            numbers = one.channel, one.sequence, one.log_time, one.publish_time
            MESSAGE_HEAD.pack_into(view, begin, MESSAGE_OPCODE, size, *numbers)
            view[end : end + len(one.data)] = one.data
            places.setdefault(one.channel, []).append((one.log_time, begin))
        return {channel: np.array(entries, dtype=np.int64) for channel, entries in places.items()}


class _Part(NamedTuple):
    """The records of a capture: where they begin in each tick, and the times of these ticks."""

    capture: Capture
    begins: NDArray[np.int64]
    moments: NDArray[np.int64]


class _Ticks:
    """Encodes a chunk with ticks."""

    def __init__(self, gathered: Gathered, memory: Memory) -> None:
        assert gathered._moments is not None
        assert gathered._native is not None
        self._gathered, self._memory = gathered, memory
        self._batch = gathered._native.batch()
        # a slice takes a tenth of the time of a loop, during which the simulation would wait
        numbers, layouts, positions, rotations, *places, data = (gathered.ticks[k::VALUES] for k in range(VALUES))
        self._groups = groups_of_arrays(positions, rotations, *places)
        self._moments = gathered._moments.of(numbers)
        self._known: list[Layout] = list(dict.fromkeys(layouts))
        if len(self._known) == 1:
            self._which = np.zeros(len(layouts), dtype=np.int64)
        else:
            codes = {layout: code for code, layout in enumerate(self._known)}
            self._which = np.fromiter(map(codes.__getitem__, layouts), np.int64, len(layouts))
        self._data: dict[Capture, list[NDArray[np.float64]]] = {}
        for pairs in filter(None, data):
            for capture, one in pairs:
                self._data.setdefault(capture, []).append(one)

    def encoded(self, is_quick: Callable[[int], bool]) -> Encoded:
        """See `Gathered.encoded`."""
        messages, ticks = self._gathered.messages, np.array([layout.size for layout in self._known])[self._which]
        begins = sums(ticks)
        others = 0
        entries: dict[int, Entries] = {}
        if messages:
            # number of all messages before each tick, and of all ticks before each message
            before = np.array([count for count, _ in messages], dtype=np.int64)
            sizes = sums([MESSAGE_HEAD.size + len(one.data) for _, one in messages])
            others = int(sizes[-1])
            chunk = self._memory.of("chunk", int(begins[-1]) + others)
            entries = self._gathered.write_messages(sizes[:-1] + begins[before], chunk)
            begins[:-1] += sizes[np.searchsorted(before, np.arange(len(ticks)), side="right")]
        else:
            chunk = self._memory.of("chunk", int(begins[-1]))
        parts = self._encode(begins[:-1], chunk)
        index = self._index(parts, entries)
        if not is_quick(len(chunk)) or others > _MOST_OTHERS * len(chunk):
            self._batch.run()
            return Encoded(chunk, index)
        positions = np.frombuffer(index.records, dtype=np.uint8)
        packed = self._memory.of("packed", CHUNK_ROOM + 5 * len(chunk) // 4 + 1024 + len(positions))
        similar = self._similar(begins[:-1], parts)
        size = self._batch.pack(chunk, similar, packed[CHUNK_ROOM:], positions)
        self._batch.run()
        return Encoded(chunk, index, packed[: CHUNK_ROOM + size() + len(positions)], size())

    def _encode(self, begins: NDArray[np.int64], chunk: NDArray[np.uint8]) -> list[_Part]:
        groups = self._groups
        parts = []
        for capture in dict.fromkeys(capture for layout in self._known for capture in layout.offsets):
            offsets = np.array([layout.offsets.get(capture, -1) for layout in self._known], dtype=np.int64)[self._which]
            is_all = len(self._known) == 1 or int(offsets.min()) >= 0
            rows: Any = slice(None) if is_all else np.flatnonzero(offsets >= 0)
            part = _Part(capture, begins[rows] + offsets[rows], self._moments[rows])
            data: Any = self._data.get(capture)
            if data is None:
                data = groups if is_all else groups.some(rows)
            capture.encode(self._batch, part.begins, part.moments, data, chunk)
            parts.append(part)
        return parts

    def _index(self, parts: Sequence[_Part], entries: dict[int, Entries]) -> ChunkIndex:
        channels = [channel for part in parts for channel in part.capture.template.channels]
        if len({*channels, *entries}) < len(channels) + len(entries):
            return index_of(_merged(parts, entries))
        others = index_of(entries) if entries else ChunkIndex(0, 0, b"", {}, {})
        sizes = [INDEX_HEAD.size + 16 * len(part.begins) for part in parts]
        total = sum(size * len(part.capture.template.heads) for size, part in zip(sizes, parts, strict=True))
        index = self._memory.of("index", total + len(others.records))
        places: dict[int, int] = {}
        counts: dict[int, int] = {}
        at = 0
        for size, (capture, begins, moments) in zip(sizes, parts, strict=True):
            template = capture.template
            end = at + size * len(template.channels)
            self._batch.index(begins, moments, template.heads, template.numbers, index[at:end])
            places.update(zip(template.channels, range(at, end, size), strict=True))
            counts.update(dict.fromkeys(template.channels, len(begins)))
            at = end
        start, stop = int(self._moments[0, 1]), int(self._moments[-1, 1])
        if entries:
            index[at:] = np.frombuffer(others.records, dtype=np.uint8)
            places.update({channel: at + place for channel, place in others.places.items()})
            counts.update(others.counts)
            start, stop = min(start, others.start), max(stop, others.end)
        return ChunkIndex(start, stop, index.data, places, counts)

    def _similar(self, begins: NDArray[np.int64], parts: Sequence[_Part]) -> Similar:
        columns = {part.capture: column for column, part in enumerate(parts)}
        spans, firsts = [], [0]
        for layout in self._known:
            for capture, offset in layout.offsets.items():
                spans += [(offset + at, length, distance, columns[capture])
                          for at, length, distance in capture.template.spans]  # fmt: skip
            firsts.append(len(spans))
        table = np.array(spans, dtype=np.int64).reshape(-1, 4)
        return Similar(begins, self._which, np.array(firsts, dtype=np.int64), table, len(columns))


def _merged(parts: Sequence[_Part], others: dict[int, Entries]) -> dict[int, Entries]:
    """The positions of all messages, of which some channels have messages in several parts."""
    found = {channel: [entries] for channel, entries in others.items()}
    for capture, begins, moments in parts:
        for channel, head in zip(capture.template.channels, capture.template.heads.tolist(), strict=True):
            found.setdefault(channel, []).append(np.stack((moments[:, 1], begins + head), axis=1))
    index = {}
    for channel, several in found.items():
        entries = several[0] if len(several) == 1 else np.concatenate(several)
        index[channel] = entries if len(several) == 1 else entries[np.argsort(entries[:, 1], kind="stable")]
    return index


def sums(values: Sequence[int] | NDArray[np.int64]) -> NDArray[np.int64]:
    """(N + 1,) sums of the first 0, 1, ... N values."""
    found = np.zeros(len(values) + 1, dtype=np.int64)
    np.cumsum(values, out=found[1:])
    return found
