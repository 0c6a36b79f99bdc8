"""Writes MCAP files that can be read up to the last complete chunk, however writing ends."""

from __future__ import annotations

import contextlib
import struct
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np
import zstandard

from morse.recording.mcap import records
from morse.recording.mcap.records import MESSAGE, MESSAGE_FIXED, MESSAGE_HEAD
from morse.version import __version__

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from io import FileIO

    from numpy.typing import NDArray

    from morse.recording.mcap.records import Message


# The positions of the messages of a chunk.

#: log time (ns) and offset in the chunk of messages of a channel, (N, 2), in the order of the offsets
Entries: TypeAlias = "NDArray[np.int64]"


class ChunkIndex(NamedTuple):
    """The records ``MessageIndex`` that follow a chunk.

    Attributes:
        start, end: first and last log time, ns; log time never decreases.
        records: the records, as bytes.
        places: offset of the record of each channel.
        counts: number of messages of each channel.
    """

    start: int
    end: int
    records: bytes | memoryview
    places: Mapping[int, int]
    counts: Mapping[int, int]


def index_of(entries: Mapping[int, Entries]) -> ChunkIndex:
    """Return the index of messages by channel."""
    made, places, place = [], {}, 0
    for number, each in entries.items():
        made.append(records.message_index(number, each))
        places[number] = place
        place += len(made[-1])
    start = min(int(each[0, 0]) for each in entries.values())
    end = max(int(each[-1, 0]) for each in entries.values())
    return ChunkIndex(start, end, b"".join(made), places, {number: len(each) for number, each in entries.items()})


# Puts the messages of a chunk into the order of their times, and makes their index.

#: the begin of a message: opcode, size, channel, sequence, log time, publish time
_HEAD = np.dtype([("opcode", "u1"), ("size", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("log", "<u8"),
                  ("publish", "<u8")])  # fmt: skip
assert _HEAD.itemsize == MESSAGE_HEAD.size


class Messages(NamedTuple):
    """Messages of one channel.

    Attributes:
        channel: its id.
        moments: (R, 3) number of ticks (32 bits), log time and simulated time, ns, of each.
        data: (R, size) messages of one size, or R messages.
    """

    channel: int
    moments: NDArray[np.int64]
    data: NDArray[np.uint8] | Sequence[bytes]


def chunk_of(messages: Sequence[Messages]) -> tuple[NDArray[np.uint8], ChunkIndex]:
    """Return the records of messages as bytes, and their index.

    Messages of the same time stay in the given order.
    """
    sizes = np.concatenate([_sizes(one) for one in messages]) + MESSAGE_HEAD.size
    order = np.argsort(np.concatenate([one.moments[:, 1] for one in messages]), kind="stable")
    begins = np.empty(len(sizes), dtype=np.int64)
    ends = np.cumsum(sizes[order])
    begins[order] = ends - sizes[order]
    chunk = np.empty(int(ends[-1]), dtype=np.uint8)
    places: dict[int, list[Entries]] = {}
    first = 0
    for one in messages:
        at = begins[first : first + len(one.moments)]
        first += len(one.moments)
        if isinstance(one.data, np.ndarray):
            _put_rows(chunk, at, one, one.data)
        else:
            _put_each(chunk, at, one, one.data)
        places.setdefault(one.channel, []).append(np.stack((one.moments[:, 1], at), axis=1))
    return chunk, index_of({channel: _in_order(parts) for channel, parts in places.items()})


def _sizes(one: Messages) -> NDArray[np.int64]:
    if isinstance(one.data, np.ndarray):
        return np.full(len(one.data), one.data.shape[1], dtype=np.int64)
    return np.array([len(data) for data in one.data], dtype=np.int64)


def _heads(one: Messages, sizes: NDArray[np.int64]) -> NDArray[np.void]:
    heads = np.empty(len(one.moments), dtype=_HEAD)
    heads["opcode"], heads["size"], heads["channel"] = MESSAGE, sizes + MESSAGE_FIXED, one.channel
    heads["sequence"], heads["log"], heads["publish"] = one.moments.T
    return heads


def _put_rows(chunk: NDArray[np.uint8], begins: NDArray[np.int64], one: Messages, data: NDArray[np.uint8]) -> None:
    head = _HEAD.itemsize
    records = np.empty((len(data), head + data.shape[1]), dtype=np.uint8)
    records[:, :head] = _heads(one, _sizes(one)).view(np.uint8).reshape(-1, head)
    records[:, head:] = data
    size = records.shape[1]
    # each place of the chunk at which a record may begin
    windows = np.ndarray((len(chunk) - size + 1,), dtype=f"V{size}", buffer=chunk, strides=(1,))
    windows[begins] = records.view(f"V{size}")[:, 0]


def _put_each(chunk: NDArray[np.uint8], begins: NDArray[np.int64], one: Messages, data: Sequence[bytes]) -> None:
    view = chunk.data
    for head, begin, message in zip(_heads(one, _sizes(one)), begins.tolist(), data, strict=True):
        at = begin + _HEAD.itemsize
        view[begin:at] = head.tobytes()
        view[at : at + len(message)] = message


def _in_order(parts: list[Entries]) -> Entries:
    if len(parts) == 1:
        return parts[0]
    entries = np.concatenate(parts)
    return entries[np.argsort(entries[:, 1], kind="stable")]


_COMPRESSION = "zstd"
#: a fast level: the next one takes a fifth more time for files that are a hundredth smaller
_LEVEL = 1
#: average size of records, bytes, above which repetitions are looked for in the whole chunk: pictures are data fields,
#: and are in messages of ROS. For small records that takes half the time again, and finds little
_LARGE = 4096
#: logarithm of the distance of repetitions, bytes: that between the fields of a chunk and the messages
_WINDOW = 25


class _Named(NamedTuple):
    offset: int
    length: int
    log_time: int
    name: str
    media_type: str
    size: int


class McapWriter:
    """Writes one file. Each call passes whole records to the operating system.

    Args:
        file: opened for writing without a buffer (``open(path, "wb", buffering=0)``).
        profile: of the header.

    Raises:
        OSError: the file cannot be written. Data of previous calls remain readable.
    """

    def __init__(self, file: FileIO, profile: str = "ros2") -> None:
        self._file = file
        self._offset = 0
        self._schemas: dict[tuple[str, str], int] = {}
        self._summary_records: list[bytes] = []
        self._counts: dict[int, int] = {}
        self._chunks: list[records.ChunkPlace] = []
        self._attachments: list[_Named] = []
        self._metadata: list[_Named] = []
        # the checksum of the compressed frame takes a quarter of the time of that of the chunk, which may be omitted
        self._compressor = zstandard.ZstdCompressor(level=_LEVEL, write_checksum=True)
        far = zstandard.ZstdCompressionParameters.from_level(
            _LEVEL, enable_ldm=True, window_log=_WINDOW, write_checksum=True
        )
        self._far_compressor = zstandard.ZstdCompressor(compression_params=far)
        self._write(records.MAGIC + records.header(profile, f"morse {__version__}"))

    def _write(self, *parts: bytes | memoryview) -> int:
        """Append data; returns their offset."""
        begin = self._offset
        try:
            for part in parts:
                view = memoryview(part)
                while view:
                    view = view[self._file.write(view) :]
        except BaseException:
            with contextlib.suppress(OSError):  # not every writable file can be truncated
                self._file.seek(begin)
                self._file.truncate()
            raise
        self._offset += sum(map(len, parts))
        return begin

    def schema(self, name: str, definition: str) -> int:
        """Add a message type: its name, and its definition in the format of ROS 2; returns its id."""
        key = (name, definition)
        if key not in self._schemas:
            number = len(self._schemas) + 1
            record = records.schema(number, name, "ros2msg", definition.encode())
            self._write(record)
            self._schemas[key] = number
            self._summary_records.append(record)
        return self._schemas[key]

    def channel(self, topic: str, schema: int, metadata: Mapping[str, str]) -> int:
        """Add a topic of messages in CDR; returns its id."""
        number = len(self._counts) + 1
        record = records.channel(number, schema, topic, "cdr", metadata)
        self._write(record)
        self._counts[number] = 0
        self._summary_records.append(record)
        return number

    def chunk(self, messages: Sequence[Message]) -> None:
        """Write messages, compressed and with an index."""
        plain = bytearray()
        entries: dict[int, list[tuple[int, int]]] = {}
        for one in messages:
            entries.setdefault(one.channel, []).append((one.log_time, len(plain)))
            plain += records.message(one)
        if messages:
            index = index_of({number: np.array(entry, dtype=np.int64) for number, entry in entries.items()})
            self.encoded(memoryview(plain), index)

    def encoded(self, plain: memoryview, index: ChunkIndex) -> None:
        """Write encoded messages, compressed and with an index.

        Args:
            plain: their records, as bytes.
            index: their positions in ``plain``.
        """
        is_large = len(plain) > _LARGE * sum(index.counts.values())
        frame = (self._far_compressor if is_large else self._compressor).compress(plain)
        sizes = len(frame), len(plain)
        head = records.chunk_head(index.start, index.end, sizes[1], _COMPRESSION, sizes[0])
        offset = self._write(head, frame, index.records)
        length = records.CHUNK_ROOM + len(frame)
        places = {number: offset + length + at for number, at in index.places.items()}
        self._chunks.append(
            records.ChunkPlace(index.start, index.end, offset, length, places, len(index.records), _COMPRESSION, *sizes)
        )
        counts = self._counts
        for number, count in index.counts.items():
            counts[number] += count

    def attachment(self, name: str, media_type: str, data: bytes, log_time: int = 0) -> None:
        """Attach a file."""
        record = records.attachment(log_time, name, media_type, data)
        offset = self._write(record)
        self._attachments.append(_Named(offset, len(record), log_time, name, media_type, len(data)))

    def metadata(self, name: str, entries: Mapping[str, str]) -> None:
        """Named strings."""
        record = records.metadata(name, entries)
        self._metadata.append(_Named(self._write(record), len(record), 0, name, "", 0))

    def finish(self) -> None:
        """Write the summary, by which readers find everything without reading the whole file; must be the last call."""
        start = min((place.start for place in self._chunks), default=0)
        end = max((place.end for place in self._chunks), default=0)
        counts = self._counts
        summary = [
            *self._summary_records,
            records.statistics(
                counts, len(self._schemas), len(self._attachments), len(self._metadata), len(self._chunks), start, end
            ),
            *(records.chunk_index(place) for place in self._chunks),
            *(records.attachment_index(*one) for one in self._attachments),
            *(records.metadata_index(one.offset, one.length, one.name) for one in self._metadata),
        ]
        end_of_data = records.record(records.DATA_END, struct.pack("<I", 0))
        content = b"".join(summary)
        footer = records.footer(self._offset + len(end_of_data), content)
        self._write(end_of_data + content + footer + records.MAGIC)
