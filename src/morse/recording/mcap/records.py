"""The records of an MCAP file, as bytes. All numbers are little-endian."""

from __future__ import annotations

import struct
import zlib
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = range(1, 9)
ATTACHMENT, ATTACHMENT_INDEX, STATISTICS, METADATA, METADATA_INDEX, SUMMARY_OFFSET, DATA_END = range(9, 16)

#: opcode and length of the content
PREFIX = struct.Struct("<BQ")
#: format of a message: the prefix of the record; channel, sequence, log time (ns), publish time (ns)
MESSAGE_HEAD = struct.Struct("<BQHIQQ")
#: size of a message between the prefix and its data, bytes
MESSAGE_FIXED = MESSAGE_HEAD.size - PREFIX.size
#: format of a message index: the prefix of the record; channel, size of its entries, bytes
INDEX_HEAD = struct.Struct("<BQHI")
#: format of a chunk: first and last log time (ns), uncompressed size, CRC-32 of the uncompressed data
CHUNK_HEAD = struct.Struct("<QQQI")


class Message(NamedTuple):
    """A message of a recording.

    Attributes:
        channel: id of its channel.
        sequence: the low 32 bits of the number of ticks.
        log_time: ns, never decreases.
        publish_time: simulated time, ns; a restart sets it back.
        data: the content.
    """

    channel: int
    sequence: int
    log_time: int
    publish_time: int
    data: bytes


def record(opcode: int, content: bytes) -> bytes:
    """A record with its prefix."""
    return PREFIX.pack(opcode, len(content)) + content


def text(value: str) -> bytes:
    """A string with its length."""
    data = value.encode("utf-8", "surrogateescape")
    return struct.pack("<I", len(data)) + data


def table(entries: Mapping[str, str]) -> bytes:
    """A map of strings with its length."""
    data = b"".join(text(key) + text(value) for key, value in entries.items())
    return struct.pack("<I", len(data)) + data


def header(profile: str, library: str) -> bytes:
    """The first record."""
    return record(HEADER, text(profile) + text(library))


def schema(number: int, name: str, encoding: str, definition: bytes) -> bytes:
    """The type of the messages of some channels."""
    return record(
        SCHEMA,
        struct.pack("<H", number) + text(name) + text(encoding) + struct.pack("<I", len(definition)) + definition,
    )


def channel(number: int, schema_number: int, topic: str, encoding: str, metadata: Mapping[str, str]) -> bytes:
    """A topic."""
    return record(CHANNEL, struct.pack("<HH", number, schema_number) + text(topic) + text(encoding) + table(metadata))


def message(one: Message) -> bytes:
    """A message."""
    head = MESSAGE_HEAD.pack(
        MESSAGE, MESSAGE_FIXED + len(one.data), one.channel, one.sequence, one.log_time, one.publish_time
    )
    return head + one.data


def chunk_head(start: int, end: int, size: int, compression: str, size_in_file: int) -> bytes:
    """The beginning of a chunk: the compressed records follow it.

    Args:
        start, end: first and last log time, ns.
        size: of the records, bytes. Their CRC-32 is omitted: compressed data have a checksum of their own.
        compression: name of the algorithm; empty for none.
        size_in_file: size of the records after compression, bytes.
    """
    content = CHUNK_HEAD.pack(start, end, size, 0) + text(compression)
    return PREFIX.pack(CHUNK, len(content) + 8 + size_in_file) + content + struct.pack("<Q", size_in_file)


#: size of a chunk before its compressed records: the name of the algorithm has four letters
CHUNK_ROOM = PREFIX.size + CHUNK_HEAD.size + 4 + 4 + 8


def message_index(number: int, entries: NDArray[np.int64]) -> bytes:
    """The positions of the messages of a channel in the preceding chunk.

    Args:
        number: id of the channel.
        entries: (N, 2) log time (ns) and offset in the records of the chunk.
    """
    content = np.ascontiguousarray(entries, dtype="<i8").tobytes()
    return record(MESSAGE_INDEX, struct.pack("<HI", number, len(content)) + content)


class ChunkPlace(NamedTuple):
    """The position of a chunk, for the index at the end of the file.

    Attributes:
        start, end: first and last log time, ns.
        offset, length: of the record, bytes.
        indexes: id of a channel to the offset of its message index.
        index_length: size of all message indexes, bytes.
        compression: name of the algorithm.
        compressed, size: compressed and uncompressed size of the records, bytes.
    """

    start: int
    end: int
    offset: int
    length: int
    indexes: Mapping[int, int]
    index_length: int
    compression: str
    compressed: int
    size: int


def chunk_index(place: ChunkPlace) -> bytes:
    """The entry of a chunk in the summary."""
    offsets = b"".join(struct.pack("<HQ", number, offset) for number, offset in place.indexes.items())
    content = struct.pack("<QQQQI", place.start, place.end, place.offset, place.length, len(offsets)) + offsets
    content += struct.pack("<Q", place.index_length) + text(place.compression)
    return record(CHUNK_INDEX, content + struct.pack("<QQ", place.compressed, place.size))


def attachment(log_time: int, name: str, media_type: str, data: bytes) -> bytes:
    """An attached file."""
    content = struct.pack("<QQ", log_time, log_time) + text(name) + text(media_type)
    content += struct.pack("<Q", len(data)) + data
    return record(ATTACHMENT, content + struct.pack("<I", zlib.crc32(content)))


def attachment_index(offset: int, length: int, log_time: int, name: str, media_type: str, size: int) -> bytes:
    """The entry of an attachment in the summary."""
    numbers = struct.pack("<QQQQQ", offset, length, log_time, log_time, size)
    return record(ATTACHMENT_INDEX, numbers + text(name) + text(media_type))


def metadata(name: str, entries: Mapping[str, str]) -> bytes:
    """Named strings."""
    return record(METADATA, text(name) + table(entries))


def metadata_index(offset: int, length: int, name: str) -> bytes:
    """The entry of metadata in the summary."""
    return record(METADATA_INDEX, struct.pack("<QQ", offset, length) + text(name))


def statistics(
    counts: Mapping[int, int], schemas: int, attachments: int, metadata_count: int, chunks: int, start: int, end: int
) -> bytes:
    """Statistics; ``counts`` are numbers of messages by the id of the channel."""
    numbers = struct.pack("<QHIIII", sum(counts.values()), schemas, len(counts), attachments, metadata_count, chunks)
    each = b"".join(struct.pack("<HQ", number, count) for number, count in counts.items() if count)
    return record(STATISTICS, numbers + struct.pack("<QQI", start, end, len(each)) + each)


def footer(summary_start: int, summary: bytes) -> bytes:
    """The last record; ``summary`` are the records between the end of the data and this one."""
    head = PREFIX.pack(FOOTER, 20) + struct.pack("<QQ", summary_start if summary else 0, 0)
    return head + struct.pack("<I", zlib.crc32(summary + head))
