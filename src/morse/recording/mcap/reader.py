"""Reads MCAP files from front to back, also incomplete ones, with bounded memory for malicious ones."""

from __future__ import annotations

import os
import struct
import zlib
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import zstandard

from morse.recording.errors import RecordingError
from morse.recording.mcap import records
from morse.recording.mcap.records import Message
from morse.system.regular_files import open_regular

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator


class RecordBytes:
    """The content of one record.

    Args:
        data: the bytes.
        what: name of the record, for error messages.
    """

    def __init__(self, data: bytes | memoryview, what: str) -> None:
        self._data = memoryview(data)
        self._what = what
        self._at = 0

    @property
    def left(self) -> int:
        """The number of unread bytes."""
        return len(self._data) - self._at

    def bytes(self, count: int) -> memoryview:
        """Read bytes.

        Raises:
            RecordingError: fewer bytes are left.
        """
        if count > self.left:
            raise RecordingError(f"{self._what} is damaged: {count} bytes expected, {self.left} left")
        begin, self._at = self._at, self._at + count
        return self._data[begin : self._at]

    def numbers(self, form: str) -> tuple[Any, ...]:
        """Numbers, in a format of `struct`."""
        layout = struct.Struct(form)
        return layout.unpack(self.bytes(layout.size))

    def text(self) -> str:
        """A string."""
        (size,) = self.numbers("<I")
        try:
            return str(self.bytes(size), "utf-8", "surrogateescape")
        except ValueError as error:
            raise RecordingError(f"{self._what} is damaged: {error}") from None

    def table(self) -> dict[str, str]:
        """A map of strings."""
        (size,) = self.numbers("<I")
        inner = RecordBytes(self.bytes(size), self._what)
        entries = {}
        while inner.left:
            key = inner.text()
            entries[key] = inner.text()
        return entries

    def records(self) -> Iterator[tuple[int, memoryview]]:
        """The records in these bytes: opcode and content.

        Raises:
            RecordingError: they are damaged.
        """
        while self.left:
            opcode, size = self.numbers("<BQ")
            if not opcode:
                # many zeros take few bytes in a file, and would be millions of empty records
                raise RecordingError(f"{self._what} is damaged: no record has the opcode 0")
            yield opcode, self.bytes(size)


#: maximum size of a record, and of an uncompressed chunk, bytes: larger ones are damaged
LARGEST = 256 << 20
#: maximum size of all schemas, channels and metadata of a file
_LARGEST_TABLES = 64 << 20
#: what chunks hold, relative to the size of the file: records that differ take more than a byte each, while millions of
#: equal ones take nothing; a picture of one colour takes nothing as well, so their bytes have a wide limit
_FEW_RECORDS, _MOST_PLAIN, _RATIO = 100_000, 16 << 30, 2048
_NAMES = {records.HEADER: "the header", records.CHUNK: "a chunk", records.ATTACHMENT: "an attachment"}


class Channel(NamedTuple):
    """A topic of a file.

    Attributes:
        number: id of the channel in the file.
        topic: ``/robot/pose``.
        type: name of the schema, ``geometry_msgs/msg/PoseStamped``; empty if it has none.
        definition: text of the schema.
        encoding: encoding of the messages, ``cdr``.
        schema_encoding: ``ros2msg``.
        metadata: named strings, such as the quality of service.
    """

    number: int
    topic: str
    type: str
    definition: str
    encoding: str
    schema_encoding: str
    metadata: dict[str, str]


class Attached(NamedTuple):
    """An attached file.

    Attributes:
        log_time: ns.
        media_type: ``text/x-python``.
        data: the content.
    """

    log_time: int
    media_type: str
    data: bytes


class Chunk(NamedTuple):
    """The position of a chunk.

    Attributes:
        offset, size: of its content, bytes.
        start, end: first and last log time, ns.
        channels: ids of the channels in its index; empty if it has no index.
    """

    offset: int
    size: int
    start: int
    end: int
    channels: set[int]

    def may_hold(self, channel: int) -> bool:
        """Whether it may have messages of a channel."""
        return not self.channels or channel in self.channels


class McapFile:
    """A file with an index of its chunks; messages are read on demand.

    Attributes:
        path: of the file.
        profile, library: of the header.
        channels: by id.
        metadata: named tables of strings; of several with the same name, the last one.
        complete: whether the end of the file is complete; otherwise the last messages may be missing.

    Raises:
        OSError: the file cannot be read.
        RecordingError: the file is not an MCAP file, or damaged at its beginning.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = os.fspath(path)
        self.profile = self.library = ""
        self.channels: dict[int, Channel] = {}
        self.metadata: dict[str, dict[str, str]] = {}
        self.complete = False
        self._schemas: dict[int, tuple[str, str, str]] = {}
        self.chunks: list[Chunk] = []
        self._attachments: dict[str, tuple[int, int]] = {}
        self._tables = 0
        self._file = open_regular(self.path)
        self._size = os.fstat(self._file.fileno()).st_size
        #: records that were read, by the chunk
        self._records: dict[int, int] = {}
        self._all_records = self._plain_bytes = 0
        try:
            self._scan(self._size)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # -- index -------------------------------------------------------------------------------

    def _damaged(self, why: str) -> RecordingError:
        return RecordingError(f"{self.path}: {why}")

    def _scan(self, size: int) -> None:
        """Locate all records; an incomplete record at the end is ignored."""
        magic = self._file.read(len(records.MAGIC))
        if magic != records.MAGIC:
            what = "it is empty" if not magic else f"it begins with {magic[:8].hex(' ')}, an MCAP file with 89 4d 43 41"
            raise self._damaged(f"this is not a recording, which morse run --record writes: {what}")
        at = len(records.MAGIC)
        while at + records.PREFIX.size <= size:
            self._file.seek(at)
            opcode, length = records.PREFIX.unpack(self._file.read(records.PREFIX.size))
            at += records.PREFIX.size
            if at + length > size:
                return
            if opcode == records.DATA_END:
                self.complete = self._ends_well(size)
                return
            if not opcode:
                raise self._damaged(f"damaged at byte {at - records.PREFIX.size}: no record has the opcode 0")
            self._take(opcode, at, length)
            at += length

    def _ends_well(self, size: int) -> bool:
        self._file.seek(size - len(records.MAGIC))
        return self._file.read() == records.MAGIC

    def _take(self, opcode: int, at: int, length: int) -> None:
        if opcode == records.CHUNK:
            fields = self._content(opcode, min(length, records.CHUNK_HEAD.size))
            start, end, _, _ = fields.numbers("<QQQI")
            self.chunks.append(Chunk(at, length, start, end, set()))
        elif opcode == records.MESSAGE_INDEX and self.chunks:
            (number,) = self._content(opcode, min(length, 2)).numbers("<H")
            self.chunks[-1].channels.add(number)
        elif opcode == records.ATTACHMENT:
            fields = self._content(opcode, min(length, 1 << 16))
            fields.numbers("<QQ")
            self._attachments[fields.text()] = (at, length)
        elif opcode in (records.HEADER, records.SCHEMA, records.CHANNEL, records.METADATA):
            self._tables += length
            if self._tables > _LARGEST_TABLES:
                raise self._damaged(f"its tables have more than {_LARGEST_TABLES >> 20} MiB")
            fields = self._content(opcode, length)
            if opcode == records.HEADER:
                self.profile, self.library = fields.text(), fields.text()
            elif opcode == records.METADATA:
                name = fields.text()
                self.metadata[name] = fields.table()
            else:
                self._describe(opcode, fields)
        elif opcode == records.MESSAGE:
            raise self._damaged("its messages are not in chunks; `morse` only reads files with chunks")

    def _describe(self, opcode: int, fields: RecordBytes) -> None:
        if opcode == records.SCHEMA:
            (number,) = fields.numbers("<H")
            name, encoding = fields.text(), fields.text()
            (size,) = fields.numbers("<I")
            definition = str(fields.bytes(size), "utf-8", "replace")
            self._schemas[number] = (name, definition, encoding)
        else:
            number, schema = fields.numbers("<HH")
            topic, encoding = fields.text(), fields.text()
            name, definition, schema_encoding = self._schemas.get(schema, ("", "", ""))
            self.channels[number] = Channel(number, topic, name, definition, encoding, schema_encoding, fields.table())

    def _content(self, opcode: int, length: int) -> RecordBytes:
        what = f"{self.path}: {_NAMES.get(opcode, 'a record')}"
        if length > LARGEST:
            raise RecordingError(f"{what} has {length} bytes; more than {LARGEST >> 20} MiB are not read")
        return RecordBytes(self._file.read(length), what)

    # -- messages ----------------------------------------------------------------------------

    def __iter__(self) -> Iterator[Message]:
        """All messages, in the order in which they were written."""
        return self.messages()

    def messages(self, channels: Collection[int] | None = None) -> Iterator[Message]:
        """Messages, in the order in which they were written.

        Args:
            channels: ids of the selected channels; None for all.

        Raises:
            RecordingError: a chunk is damaged.
        """
        for chunk in self.chunks:
            if channels is None or any(map(chunk.may_hold, channels)):
                yield from self.messages_of(chunk, channels)

    def messages_of(self, chunk: Chunk, channels: Collection[int] | None = None) -> Iterator[Message]:
        """Messages of a chunk, in the order in which they were written.

        Raises:
            RecordingError: the chunk is damaged.
        """
        for opcode, content in self._counted(chunk):
            if opcode in (records.SCHEMA, records.CHANNEL):
                self._describe(opcode, RecordBytes(content, f"{self.path}: a record in a chunk"))
            if opcode != records.MESSAGE:
                continue
            fields = RecordBytes(content, f"{self.path}: a message")
            number, sequence, log_time, publish_time = fields.numbers("<HIQQ")
            if channels is None or number in channels:
                yield Message(number, sequence, log_time, publish_time, bytes(fields.bytes(fields.left)))

    def _counted(self, chunk: Chunk) -> Iterator[tuple[int, memoryview]]:
        """The records of a chunk, each of which is counted once, however often it is read."""
        before = count = self._records.get(chunk.offset, 0)
        others = self._all_records - before
        try:
            for number, record in enumerate(self._plain(chunk).records(), 1):
                if number > count:
                    count = number
                    if others + count > _FEW_RECORDS + self._size:
                        raise self._damaged(
                            f"its {self._size:,} bytes hold more than {others + count - 1:,} records: no recorder "
                            "writes that"
                        )
                yield record
        finally:
            now = self._records.get(chunk.offset, 0)
            if count > now:
                self._records[chunk.offset] = count
                self._all_records += count - now

    def last(self, channel: int, until: int, most_chunks: int) -> Message | None:
        """The last message of a channel whose log time is not later than ``until``, ns.

        Args:
            most_chunks: chunks that are searched, from the latest one backward.

        Raises:
            RecordingError: a chunk is damaged.
        """
        chunks = [chunk for chunk in self.chunks if chunk.start <= until and chunk.may_hold(channel)][-most_chunks:]
        for chunk in reversed(chunks):
            messages = [one for one in self.messages_of(chunk, (channel,)) if one.log_time <= until]
            if messages:
                return messages[-1]
        return None

    def _plain(self, place: Chunk) -> RecordBytes:
        self._file.seek(place.offset)
        fields = self._content(records.CHUNK, place.size)
        _, _, size, checksum = fields.numbers("<QQQI")
        compression = fields.text()
        (size_in_file,) = fields.numbers("<Q")
        data = fields.bytes(size_in_file)
        if size > LARGEST:
            raise self._damaged(f"a chunk declares {size} bytes; more than {LARGEST >> 20} MiB are not read")
        if place.offset not in self._records:
            self._plain_bytes += size
            if self._plain_bytes > _MOST_PLAIN + _RATIO * self._size:
                raise self._damaged(f"its {self._size:,} bytes would grow to more than {self._plain_bytes >> 30} GiB")
        if compression == "zstd":
            plain = self._decompressed(data, size)
        elif compression:
            raise self._damaged(f"a chunk is compressed by {compression[:20]!r}, expected zstd or nothing")
        else:
            plain = bytes(data)
        if len(plain) != size or (checksum and zlib.crc32(plain) != checksum):
            raise self._damaged(f"the chunk at byte {place.offset} is damaged")
        return RecordBytes(plain, f"{self.path}: the chunk at byte {place.offset}")

    def _decompressed(self, data: memoryview, size: int) -> bytes:
        # the declared size in the frame may be wrong: never read more than the chunk has declared
        reader = zstandard.ZstdDecompressor(max_window_size=LARGEST).stream_reader(bytes(data))
        parts, remaining = [], size + 1
        try:
            while remaining and (part := reader.read(min(remaining, 1 << 20))):
                parts.append(part)
                remaining -= len(part)
        except (zstandard.ZstdError, MemoryError) as error:
            raise self._damaged(f"a chunk cannot be decompressed: {error}") from None
        return b"".join(parts)

    # -- attachments -------------------------------------------------------------------------

    @property
    def attachments(self) -> list[str]:
        """The names of the attached files."""
        return list(self._attachments)

    def attachment(self, name: str) -> bytes | None:
        """The content of an attached file; None if there is none of that name.

        Raises:
            RecordingError: it is damaged.
        """
        content = self.attached(name)
        return None if content is None else content.data

    def attached(self, name: str) -> Attached | None:
        """An attached file; None if there is none of that name.

        Raises:
            RecordingError: it is damaged.
        """
        if name not in self._attachments:
            return None
        at, length = self._attachments[name]
        self._file.seek(at)
        fields = self._content(records.ATTACHMENT, length)
        log_time, _ = fields.numbers("<QQ")
        fields.text()
        media_type = fields.text()
        (size,) = fields.numbers("<Q")
        return Attached(log_time, media_type, bytes(fields.bytes(size)))
