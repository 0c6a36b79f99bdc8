"""Exports the topics of a recording: tables, trajectories, point clouds, pictures with labels, data sets of robots."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.core.exceptions import MorseError
from morse.core.reports.quoting import nearest
from morse.core.validation.names import file_name
from morse.recording.coco import cameras_with_labels, write_labels
from morse.recording.errors import RecordingError
from morse.recording.fields import DECLARED, FIELDS
from morse.recording.fields.blocks import block_of
from morse.recording.formats import Clouds, Csv, Numpy, Parquet, Sink, Trajectory
from morse.recording.lerobot import robots_of, write_robot
from morse.recording.mcap.writer import McapWriter
from morse.rosmsgs.cdr import CdrError, decode
from morse.rosmsgs.definitions import PRIMITIVES, SEQUENCE, SINGLE, fields_of
from morse.system.extras import install

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator

    from morse.core.values import DecodedMessage
    from morse.recording.mcap.reader import Channel, McapFile
    from morse.recording.mcap.records import Message
    from morse.rosmsgs.definitions import MessageField


# Messages as rows of tables.

#: maximum length of fixed arrays with one column for each item
_MOST_ITEMS = 36
#: the columns before those of the message: simulated time (s), the same without the jumps of restarts, number of ticks
FIRST = ("time", "log_time", "tick")


class Table:
    """The messages of one type as rows.

    A column has the name of its field: ``pose.position.x``, ``header.frame_id``. A message that only contains a list of
    others, such as ``tf2_msgs/TFMessage``, gives a row for each of them.

    Args:
        type_name: of the messages, ``geometry_msgs/msg/PoseStamped``.
        without_data: leave out fields of bytes (images, point clouds).

    Attributes:
        columns: name and type, of `PRIMITIVES` or ``string``, with ``[]`` at the end for a list; a list of messages
            has the type ``json``.
        left_out: fields without a column.

    Raises:
        RecordingError: the type is not known.
    """

    def __init__(self, type_name: str, *, without_data: bool = False) -> None:
        self.columns: list[tuple[str, str]] = list(zip(FIRST, ("float64", "float64", "int64"), strict=True))
        self.left_out: list[str] = []
        self._type = type_name
        self._without_data = without_data
        self._getters: list[Callable[[DecodedMessage], object]] = []
        try:
            fields = fields_of(type_name)
        except MorseError as error:
            raise RecordingError(str(error)) from None
        self._list = ""
        if len(fields) == 1 and fields[0].size == SEQUENCE and "/" in fields[0].type:
            self._list, fields = fields[0].name, fields_of(fields[0].type)
        self._add(fields, (), lambda message: message)

    def _add(
        self, fields: tuple[MessageField, ...], above: tuple[str, ...], owner: Callable[[DecodedMessage], Any]
    ) -> None:
        for field in fields:
            path = (*above, field.name)

            def get(message: DecodedMessage, name: str = field.name) -> object:
                return owner(message)[name]

            if "/" in field.type and field.size == SINGLE:
                self._add(fields_of(field.type), path, get)
            else:
                self._column(".".join(path), field, get)

    def _column(self, name: str, field: MessageField, get: Callable[[DecodedMessage], Any]) -> None:
        if self._without_data and field.type == "uint8" and field.size == SEQUENCE:
            self.left_out.append(name)
        elif field.size == SINGLE:
            self.columns.append((name, field.type))
            self._getters.append(get)
        elif field.type in PRIMITIVES and 0 < field.size <= _MOST_ITEMS:
            for item in range(field.size):
                self.columns.append((f"{name}[{item}]", field.type))
                self._getters.append(lambda message, item=item: _number(get(message)[item]))  # type: ignore[misc]
        else:
            is_plain = field.type in PRIMITIVES or field.type == "string"
            self.columns.append((name, f"{field.type}[]" if is_plain else "json"))
            self._getters.append(lambda message: get(message))

    def rows(self, one: Message) -> Iterator[list[object]]:
        """The rows of a message.

        Raises:
            RecordingError: it is damaged.
        """
        try:
            message = decode(self._type, one.data)
        except (CdrError, ValueError) as error:
            raise RecordingError(f"a message of tick {one.sequence} is damaged: {error}") from None
        first = [one.publish_time / 1e9, one.log_time / 1e9, one.sequence]
        for row in message[self._list] if self._list else (message,):
            yield first + [get(row) for get in self._getters]


def _number(value: object) -> object:
    return value.item() if hasattr(value, "item") else value


# Data fields as rows of tables.

#: type of a column and its values in Python, by the declared type of a field
_SINGLE: dict[str, tuple[str, tuple[type, ...]]] = {
    "float": ("float64", (float, int)),
    "int": ("int64", (int,)),
    "integer": ("int64", (int,)),
    "bool": ("bool", (bool,)),
    "string": ("string", (str,)),
}
#: maximum number of fields of a component
_MOST = 1000


class FieldsTable:
    """The data fields of a component, one row for each measurement; see `morse.recording.export.Table`.

    Args:
        channel: of the fields.
        path: of the file, for errors.
        without_data: leave out images and clouds.

    Attributes:
        columns, left_out: as those of `Table`. Lists, arrays and structures have the type ``json``.

    Raises:
        RecordingError: the declarations of the fields are damaged.
    """

    def __init__(self, channel: Channel, path: str, *, without_data: bool = False) -> None:
        self.columns: list[tuple[str, str]] = list(zip(FIRST, ("float64", "float64", "int64"), strict=True))
        self.left_out: list[str] = []
        self._path = path
        self._fields: list[tuple[str, tuple[type, ...]]] = []
        try:
            declarations = json.loads(channel.metadata[DECLARED])[:_MOST]
            for field in declarations:
                name, kind, shape = str(field["name"]), str(field["type"]), field.get("shape")
                if without_data and isinstance(shape, list) and len(shape) > 1:
                    self.left_out.append(name)
                    continue
                column, types = _SINGLE.get(kind, ("json", (object,)))
                self.columns.append((name, column))
                self._fields.append((name, types))
        except (ValueError, LookupError, TypeError, RecursionError) as error:
            raise RecordingError(f"the declarations of its fields are damaged: {error}") from None

    def rows(self, one: Message) -> Iterator[list[object]]:
        """The rows of a message; a value of another type than its column is None.

        Raises:
            RecordingError: it is damaged.
        """
        block = block_of(one, self._path)
        for row in range(len(block)):
            fields = block.row(row)
            values = [_fitting(fields.values.get(name), types) for name, types in self._fields]
            yield [(fields.time - one.log_time + one.publish_time) / 1e9, fields.time / 1e9, fields.tick, *values]


def _fitting(value: object, types: tuple[type, ...]) -> object:
    if types == (object,):
        return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value
    is_number = bool not in types and isinstance(value, bool)
    return value if isinstance(value, types) and not is_number else None


#: maximum number of rows in memory
_ROWS = 1000
#: maximum size of messages in memory, bytes
_BYTES = 64 << 20
#: maximum number of open files; a recording with more topics is read several times
_FILES = 100


class Written(NamedTuple):
    """One written file.

    Attributes:
        path: of the file.
        topic: the topic of its messages; the name of the robot for a data set.
        rows: number of rows.
        left_out: fields of bytes, which CSV does not contain.
    """

    path: Path
    topic: str
    rows: int
    left_out: tuple[str, ...]


#: the suffix of the file of a topic, by the form of an export; a folder for clouds
_SUFFIXES = {
    "csv": ".csv",
    "parquet": ".parquet",
    "numpy": ".npz",
    "tum": ".tum",
    "kitti": ".kitti",
    "euroc": ".euroc.csv",
    "pcd": ".pcd",
    "las": ".las",
    "coco": ".coco",
    "lerobot": ".lerobot",
}
#: the forms of an export, and those for any topic
FORMS = tuple(_SUFFIXES)
_TABLES = ("csv", "parquet", "numpy")


def _sink(path: Path, columns: list[tuple[str, str]], form: str) -> Sink:
    if form in ("tum", "kitti", "euroc"):
        return Trajectory(path, columns, form)
    if form in ("pcd", "las"):
        return Clouds(path, columns, form)
    if form == "numpy":
        return Numpy(path, columns)
    return Csv(path, columns) if form == "csv" else Parquet(path, columns)


class _Writing:
    """The file of one topic during the export."""

    def __init__(self, folder: Path, channel: Channel, form: str, names: dict[str, int], source: str) -> None:
        is_csv = form == "csv"
        self.table: Table | FieldsTable = (
            FieldsTable(channel, source, without_data=is_csv)
            if channel.topic.startswith(f"{FIELDS}/")
            else Table(channel.type, without_data=is_csv)
        )
        if form not in _TABLES and isinstance(self.table, FieldsTable):
            raise RecordingError("data fields are exported as tables")
        self.path = folder / f"{_file_name(channel.topic, names)}{_SUFFIXES[form]}"
        self.topic = channel.topic
        self.count = 0
        self._sink = _sink(self.path, self.table.columns, form)
        self._rows: list[list[object]] = []
        self._bytes = 0

    def add(self, message: Message) -> None:
        self._rows += self.table.rows(message)
        self._bytes += len(message.data)
        if len(self._rows) >= _ROWS or self._bytes > _BYTES // _FILES:
            self._flush()

    def _flush(self) -> None:
        if self._rows:
            self.count += len(self._rows)
            self._sink.write(self._rows)
            self._rows, self._bytes = [], 0

    def close(self) -> Written:
        self._flush()
        self._sink.close()
        return Written(self.path, self.topic, self.count, tuple(self.table.left_out))

    def give_up(self) -> None:
        self._sink.close()


def _file_name(topic: str, names: dict[str, int]) -> str:
    """``robot.pose`` for ``/robot/pose``; names that exist, in any case, get numbers."""
    unique = name = file_name(topic.strip("/").replace("/", ".") or "topic")
    while unique.lower() in names:
        # numbers that were given are not tried again: a file may have thousands of topics of the same name
        names[name.lower()] += 1
        unique = f"{name}-{names[name.lower()]}"
    names[unique.lower()] = 1
    return unique


def export(
    file: McapFile, folder: str | os.PathLike[str], form: str, topics: Collection[str] = ()
) -> tuple[list[Written], list[str]]:
    """Write a table for each topic.

    Args:
        file: a recording.
        folder: is created; it must not exist, or be empty.
        form: one of `FORMS`.
        topics: the selected topics; none for all.

    Returns:
        The files, and remarks about topics that have none.

    Raises:
        RecordingError: the recording is damaged, there is no such topic, or the folder is in use; or a package is
            missing. Files that were written before remain.
        OSError: a file cannot be written.
    """
    topics_to_write = selected(file, topics)
    if form in ("parquet", "lerobot"):
        try:
            import pyarrow.parquet  # noqa: F401
        except ImportError:
            raise RecordingError(f"Parquet needs the package pyarrow: {install('parquet')}") from None
    target = Path(folder)
    if target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise RecordingError(f"{target} exists already: remove it, or give another folder; nothing is overwritten")
    target.mkdir(parents=True, exist_ok=True)
    tables: list[Written] = []
    remarks: list[str] = []
    names: dict[str, int] = {}
    if form == "coco":
        return _data_sets(file, topics_to_write, target, names)
    if form == "lerobot":
        return _robots(file, topics_to_write, target, names)
    for begin in range(0, len(topics_to_write), _FILES):
        tables += _some(file, topics_to_write[begin : begin + _FILES], target, form, names, remarks)
    if form in _TABLES or topics:
        return tables, remarks
    if not tables:
        what = "point clouds" if form in ("pcd", "las") else "poses"
        raise RecordingError(f"{file.path} has no topic with {what}")
    # the other topics have nothing of that kind
    return tables, []


def _data_sets(
    file: McapFile, channels: list[Channel], target: Path, names: dict[str, int]
) -> tuple[list[Written], list[str]]:
    """A folder for each segmentation camera."""
    cameras = cameras_with_labels(file)
    written: list[Written] = []
    remarks: list[str] = []
    for channel in channels:
        if channel.topic in cameras:
            folder = target / f"{_file_name(channel.topic, names)}{_SUFFIXES['coco']}"
            try:
                pictures = write_labels(file, channel.topic, folder)
            except RecordingError as error:
                remarks.append(f"{channel.topic} is left out: {error}")
            else:
                written.append(Written(folder, channel.topic, pictures, ()))
    if not written:
        why = "; ".join(remarks) or "it has no images of a SegmentationCamera"
        raise RecordingError(f"{file.path} has no pictures with labels: {why}")
    return written, remarks


def _robots(
    file: McapFile, channels: list[Channel], target: Path, names: dict[str, int]
) -> tuple[list[Written], list[str]]:
    """A folder for each robot."""
    robots, begins = robots_of(file, channels)
    written: list[Written] = []
    remarks: list[str] = []
    for name, robot in robots.items():
        folder = target / f"{_file_name(name, names)}{_SUFFIXES['lerobot']}"
        try:
            frames, left_out = write_robot(file, robot, begins, folder, remarks)
        except RecordingError as error:
            remarks.append(f"{name} is left out: {error}")
        else:
            written.append(Written(folder, name, frames, left_out))
    if not written:
        why = "; ".join(remarks) or "it has no data fields of sensors"
        raise RecordingError(f"{file.path} has no robot with data: {why}")
    return written, remarks


def _some(
    file: McapFile, channels: list[Channel], target: Path, form: str, names: dict[str, int], remarks: list[str]
) -> list[Written]:
    open_: dict[int, _Writing] = {}
    try:
        for channel in channels:
            if channel.encoding != "cdr":
                remarks.append(f"{channel.topic} is left out: its encoding is {channel.encoding!r:.40}, expected 'cdr'")
                continue
            try:
                open_[channel.number] = _Writing(target, channel, form, names, file.path)
            except RecordingError as error:
                remarks.append(f"{channel.topic} is left out: {error}")
        for message in file.messages(open_.keys()):
            open_[message.channel].add(message)
    except BaseException:
        for one in open_.values():
            one.give_up()
        raise
    return [one.close() for one in open_.values()]


def selected(file: McapFile, topics: Collection[str]) -> list[Channel]:
    """Some topics of a recording, none for all.

    Raises:
        RecordingError: there is no such topic.
    """
    present_topics = {channel.topic for channel in file.channels.values()}
    for topic in topics:
        if topic not in present_topics:
            raise RecordingError(f"there is no topic '{topic}' in {file.path}{nearest(topic, sorted(present_topics))}")
    return [channel for channel in file.channels.values() if not topics or channel.topic in topics]


# A recording without an end, such as that of a process that was killed, as a complete file.


class Rewritten(NamedTuple):
    """A complete file.

    Attributes:
        messages: their number.
        damaged: number of chunks that cannot be read and are left out.
    """

    messages: int
    damaged: int


def rewrite(file: McapFile, path: Path, channels: Collection[Channel]) -> Rewritten:
    """Write a complete file with an index: the intact messages of some channels, all metadata and attachments.

    Args:
        file: a recording.
        path: of a file that does not exist.
        channels: of the recording.

    Raises:
        RecordingError: the file exists, or the recording has other messages than CDR.
        OSError: the file cannot be written; no part of it is left.
    """
    for channel in channels:
        if (channel.encoding, channel.schema_encoding) != ("cdr", "ros2msg"):
            raise RecordingError(
                f"{file.path}: the messages of {channel.topic} are {channel.encoding or 'of no encoding'}, expected "
                "cdr: only files with messages of ROS 2 can be written; choose them by --topics"
            )
    try:
        target = open(path, "xb", buffering=0)  # noqa: SIM115 (closed below)
    except FileExistsError:
        raise RecordingError(f"{path} exists; choose another name by -o") from None
    try:
        with target:
            return _copied(file, McapWriter(target, file.profile), channels)
    except BaseException:
        os.unlink(path)
        raise


def _copied(file: McapFile, writer: McapWriter, channels: Collection[Channel]) -> Rewritten:
    numbers = {
        one.number: writer.channel(one.topic, writer.schema(one.type, one.definition), one.metadata) for one in channels
    }
    messages = damages = 0
    for chunk in file.chunks:
        if not any(map(chunk.may_hold, numbers)):
            continue
        try:
            messages_of_chunk = list(file.messages_of(chunk, numbers.keys()))
        except RecordingError:
            damages += 1
            continue
        writer.chunk([one._replace(channel=numbers[one.channel]) for one in messages_of_chunk])
        messages += len(messages_of_chunk)
    for name in file.attachments:
        attachment = file.attached(name)
        if attachment is not None:
            writer.attachment(name, attachment.media_type, attachment.data, attachment.log_time)
    for name, entries in file.metadata.items():
        writer.metadata(name, entries)
    writer.finish()
    return Rewritten(messages, damages)
