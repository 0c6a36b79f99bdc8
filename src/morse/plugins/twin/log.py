"""Logs of robots as columns of numbers: MCAP, bags of ROS, PX4, ArduPilot, CSV."""

from __future__ import annotations

import csv
import io
import math
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.exceptions import MorseError
from morse.core.reports.quoting import escaped, nearest, quoted, short
from morse.recording.fields import COMPONENT, FIELDS
from morse.recording.fields.blocks import block_of
from morse.recording.inputs import readable_entry
from morse.recording.mcap.reader import McapFile
from morse.rosmsgs.cdr import CdrError, decode
from morse.system.extras import install
from morse.system.regular_files import open_regular

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

#: the topic with the commands of a recording of MORSE, and the kind of their entries
_INPUTS, _COMMAND = "/morse/inputs", "command"
#: largest number of numbers of a log, of items of a list in a message, of columns of a topic, and of topics
_MOST_NUMBERS, _MOST_ITEMS, _MOST_COLUMNS, _MOST_TOPICS = 100_000_000, 2048, 4096, 2000
#: most places of a log of ArduPilot without a message
_MOST_SKIPPED = 1_000_000
#: latest time of a log, s; differences of later ones say nothing
_LATEST = 1e15
#: largest size of a CSV file, bytes, and of a file that a package reads as a whole
_LARGEST_CSV, _LARGEST = 1 << 30, 4 << 30
#: names of the column of time in CSV files, and the unit of each, s
_TIMES = {
    "time": 1.0, "t": 1.0, "timestamp": 1.0, "time_s": 1.0, "stamp": 1.0, "seconds": 1.0,
    "time_ms": 1e-3, "timestamp_ms": 1e-3, "time_us": 1e-6, "timestamp_us": 1e-6, "timeus": 1e-6,
    "time_ns": 1e-9, "timestamp_ns": 1e-9, "#timestamp": 1e-9, "#timestamp [ns]": 1e-9,
}  # fmt: skip
#: prefix of the topics with the commands of a recording of MORSE
COMMANDS = "commands of "


class LogError(MorseError):
    """A log cannot be read, or has nothing that could be used."""


@dataclass
class Series:
    """The messages of a topic.

    Attributes:
        topic: its name; ``robot.imu`` for the data fields of a recording of MORSE.
        type: of its messages; the class of the component for data fields.
        times: (N,) s, by the stamps of the messages if they have any.
        columns: by names such as ``pose.position.x``: (N,) numbers, or (N, K) lists.
        latency: mean time between stamp and reception, s; NaN if it is not known.
        is_exact: whether the names are those of fields of a component.
    """

    topic: str
    type: str
    times: Floats
    columns: dict[str, Floats]
    latency: float = math.nan
    is_exact: bool = False


@dataclass
class Log:
    """A log.

    Attributes:
        path: of the file.
        form: ``MCAP``, ``PX4``, ...
        series: by topic.
        begin: the earliest time, s; all times of series are relative to it.
        remarks: what was left out, and why.
    """

    path: str
    form: str
    series: dict[str, Series]
    begin: float = 0.0
    remarks: list[str] = field(default_factory=list)

    @property
    def duration(self) -> float:
        """Time from the first to the last sample, s."""
        return max((float(one.times[-1]) for one in self.series.values() if len(one.times)), default=0.0)


class _Rows:
    """The messages of one topic, while a log is read."""

    def __init__(self, topic: str, kind: str, budget: list[int]) -> None:
        self.topic, self.kind, self._budget = topic, kind, budget
        self.times: list[float] = []
        self.received: list[float] = []
        self.rows: list[dict[str, Any]] = []
        self.is_exact = False

    def add(self, time: float, values: Mapping[str, Any], received: float = math.nan) -> None:
        """Add a message, whose values are numbers and lists of numbers.

        Raises:
            LogError: the log is too large.
        """
        self._budget[0] -= 1 + sum(len(one) if isinstance(one, np.ndarray) else 1 for one in values.values())
        if self._budget[0] < 0:
            raise LogError(f"the log has more than {_MOST_NUMBERS:,} numbers: select topics, or cut it into parts")
        self.times.append(time)
        self.received.append(received)
        self.rows.append(dict(values))

    def series(self) -> Series | None:
        """All of them in the order of time; None if there is no number."""
        times = np.array(self.times, float)
        if not len(times):
            return None
        names = dict.fromkeys(
            name for row in (self.rows[0], self.rows[-1], self.rows[len(self.rows) // 2]) for name in row
        )
        columns: dict[str, Floats] = {}
        for name in list(names)[:_MOST_COLUMNS]:
            values = [row.get(name) for row in self.rows]
            column = _column(values)
            if column is not None:
                columns[name] = column
        return _sorted(Series(self.topic, self.kind, times, columns, self._latency(times), self.is_exact))

    def _latency(self, times: Floats) -> float:
        late = np.array(self.received) - times
        return float(np.nanmean(late)) if np.isfinite(late).any() else math.nan


def _column(values: list[Any]) -> Floats | None:
    """Numbers, or lists of the same length; None for anything else. Missing ones are NaN."""
    first = next((value for value in values if value is not None), None)
    if isinstance(first, np.ndarray):
        size = len(first)
        missing = np.full(size, math.nan)
        fitting = [value if isinstance(value, np.ndarray) and len(value) == size else missing for value in values]
        return np.array(fitting, float) if size else None
    try:
        column = np.array(
            [math.nan if value is None or isinstance(value, np.ndarray) else value for value in values], float
        )
    except (TypeError, ValueError, OverflowError):
        return None
    return column if np.isfinite(column).any() else None


def _sorted(one: Series) -> Series | None:
    """By time, without samples that have none or one that no clock shows."""
    order = np.argsort(one.times, kind="stable")
    order = order[np.abs(one.times[order]) <= _LATEST]
    if not len(order) or not one.columns:
        return None
    one.times = one.times[order]
    one.columns = {name: column[order] for name, column in one.columns.items()}
    return one


def _flat(message: Any, prefix: str = "", depth: int = 0) -> dict[str, Any]:
    """The numbers of a message by their names, ``a.b.c``."""
    found: dict[str, Any] = {}
    if depth > 8:
        return found
    names = message.get("name") if isinstance(message, dict) else None
    for key, value in message.items():
        name = f"{prefix}{key}"
        if isinstance(value, dict):
            found.update(_flat(value, f"{name}.", depth + 1))
        elif isinstance(value, np.ndarray) or (isinstance(value, (list, tuple)) and value):
            found.update(_list(name, value, names, depth))
        elif isinstance(value, (int, float, np.number)):
            found[name] = _float(value)
        if len(found) > _MOST_COLUMNS:
            break
    return found


def _list(name: str, value: Any, names: Any, depth: int) -> dict[str, Any]:
    if isinstance(value, (bytes, str)) or len(value) > _MOST_ITEMS:
        return {}
    if isinstance(value[0] if len(value) else None, dict):
        # transforms, points of trajectories: the first ones
        return {
            key: number
            for index, one in enumerate(value[:8])
            if isinstance(one, dict)
            for key, number in _flat(one, f"{name}.{index}.", depth + 1).items()
        }
    try:
        numbers = np.asarray(value, float)
    except (TypeError, ValueError, OverflowError):
        return {}
    if numbers.ndim != 1:
        return {}
    if isinstance(names, list) and len(names) == len(numbers) and all(isinstance(one, str) for one in names):
        # the joints of a JointState
        return {f"{name}.{escaped(one)}": float(number) for one, number in zip(names, numbers, strict=True)}
    return {name: numbers}


def _stamp(message: Any) -> float | None:
    """The time in the header of a message, s; None for none, and for 0."""
    header = message.get("header")
    stamp = header.get("stamp") if isinstance(header, dict) else None
    if not isinstance(stamp, dict):
        return None
    try:
        seconds = float(stamp["sec"]) + 1e-9 * float(stamp["nanosec"])
    except (TypeError, ValueError, LookupError):
        return None
    return seconds if seconds > 0.0 and math.isfinite(seconds) else None


# -- MCAP ------------------------------------------------------------------------------------


def _read_mcap(path: Path, budget: list[int]) -> tuple[str, list[Series | None], list[str]]:
    remarks: list[str] = []
    with McapFile(path) as file:
        if not file.complete:
            remarks.append("the file is incomplete: it was read up to its last whole chunk")
        if "morse" in file.metadata:
            return "recording of MORSE", _all(_read_own(file, budget, remarks)), remarks
        return "MCAP", _all(_read_ros(file, budget, remarks)), remarks


def _all(topics: Iterable[_Rows]) -> list[Series | None]:
    return [rows.series() for rows in topics]


def _read_own(file: McapFile, budget: list[int], remarks: list[str]) -> list[_Rows]:
    """The data fields of sensors, and the commands, of a recording of MORSE."""
    topics: dict[int, _Rows] = {}
    commands: dict[str, _Rows] = {}
    rate = _number(file.metadata["morse"].get("frequency"), 60.0)
    inputs = set()
    for channel in file.channels.values():
        name = channel.metadata.get(COMPONENT)
        if channel.topic.startswith(f"{FIELDS}/") and name:
            topics[channel.number] = rows = _Rows(name, channel.metadata.get("morse.class", ""), budget)
            rows.is_exact = True
        elif channel.topic == _INPUTS:
            inputs.add(channel.number)
    restarts = 0
    for one in file.messages({*topics, *inputs}):
        if one.channel in inputs:
            entry = readable_entry(one.data)
            if entry.get("kind") in ("reset", "restore"):
                restarts += 1
            if entry.get("kind") == _COMMAND:
                name = str(entry.get("name"))
                rows = commands.setdefault(name, _Rows(f"{COMMANDS}{name}", "command", budget))
                rows.is_exact = True
                # the tick tells when it took effect: the message was written in that tick
                rows.add(_number(entry.get("tick"), math.nan) / rate, _flat(entry["content"]))
            continue
        block = block_of(one, file.path)
        rows = topics[one.channel]
        for index in range(len(block)):
            row = block.row(index)
            values = {key: value for key, value in row.values.items() if key != "timestamp"}
            rows.add(row.time / 1e9, _flat(values))
    if restarts:
        remarks.append("the simulation was restarted during the recording: times of several lives are mixed")
    return [*topics.values(), *commands.values()]


def _number(value: Any, default: float) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        return default
    return number if math.isfinite(number) and number >= 0.0 else default


def _read_ros(file: McapFile, budget: list[int], remarks: list[str]) -> list[_Rows]:
    """The messages of ROS 2 in an MCAP file of others."""
    topics: dict[int, _Rows] = {}
    unknown: set[int] = set()
    # channels may be described in the chunks alone
    for one in file.messages():
        if one.channel in unknown:
            continue
        rows = topics.get(one.channel)
        if rows is None:
            channel = file.channels.get(one.channel)
            if channel is None or channel.encoding != "cdr" or len(topics) >= _MOST_TOPICS:
                unknown.add(one.channel)
                if channel is not None:
                    kind = quoted(channel.encoding)
                    remarks.append(f"{short(channel.topic)} is left out: its messages are {kind}, expected 'cdr'")
                continue
            rows = topics[one.channel] = _Rows(channel.topic, channel.type, budget)
        try:
            message = decode(rows.kind, one.data)
        except (CdrError, ValueError, LookupError) as error:
            unknown.add(one.channel)
            remarks.append(f"{short(rows.topic)} ({short(rows.kind)}) is left out: {str(error)[:120]}")
            continue
        stamp = _stamp(message)
        received = one.log_time / 1e9
        rows.add(received if stamp is None else stamp, _flat(message), received if stamp is not None else math.nan)
    return [rows for number, rows in topics.items() if number not in unknown]


# -- other formats ---------------------------------------------------------------------------


def _package(name: str, what: str, extra: str = "twin") -> Any:
    from importlib import import_module

    try:
        return import_module(name)
    except ImportError:
        raise LogError(f"{what} needs the package {name.partition('.')[0]}: {install(extra)}") from None


def _read_bag(path: Path, budget: list[int]) -> tuple[str, list[Series | None], list[str]]:
    reading, typesys = _package("rosbags.highlevel", "a bag of ROS"), _package("rosbags.typesys", "a bag of ROS")
    folder = path.parent if path.suffix == ".db3" else path
    remarks: list[str] = []
    topics: dict[str, _Rows] = {}
    store = typesys.get_typestore(typesys.Stores.LATEST)
    with reading.AnyReader([folder], default_typestore=store) as reader:
        unknown: set[str] = set()
        for connection, time, data in reader.messages():
            topic = connection.topic
            if topic in unknown or (topic not in topics and len(topics) >= _MOST_TOPICS):
                continue
            rows = topics.setdefault(topic, _Rows(topic, connection.msgtype, budget))
            try:
                message = _plain(reader.deserialize(data, connection.msgtype))
            except Exception as error:  # of definitions in the file
                unknown.add(topic)
                remarks.append(f"{short(topic)} ({short(connection.msgtype)}) is left out: {str(error)[:120]}")
                continue
            stamp = _stamp(message)
            rows.add(
                time / 1e9 if stamp is None else stamp, _flat(message), time / 1e9 if stamp is not None else math.nan
            )
    return "bag of ROS", _all(topics.values()), remarks


def _plain(message: Any, depth: int = 0) -> Any:
    """A message of rosbags as dictionaries."""
    names = getattr(message, "__dataclass_fields__", None)
    if names is None or depth > 8:
        return message
    return {
        name: [_plain(one, depth + 1) for one in value] if isinstance(value, list) else _plain(value, depth + 1)
        for name in names
        if name != "__msgtype__" and not name.startswith("_")
        for value in (getattr(message, name),)
    }


def _read_ulog(path: Path, budget: list[int]) -> tuple[str, list[Series | None], list[str]]:
    package = _package("pyulog", "a log of PX4")
    with redirect_stdout(_Skipped()):
        file = package.ULog(str(path))
    topics: list[Series | None] = []
    remarks: list[str] = []
    for data in file.data_list:
        topic = data.name if data.multi_id == 0 else f"{data.name}.{data.multi_id}"
        if "timestamp" not in data.data:
            remarks.append(f"{short(topic)} is left out: it has no time")
            continue
        times = np.asarray(data.data["timestamp"], float) * 1e-6
        columns = {name: np.asarray(column, float) for name, column in data.data.items() if name != "timestamp"}
        budget[0] -= sum(map(len, columns.values()))
        if budget[0] < 0:
            raise LogError(f"the log has more than {_MOST_NUMBERS:,} numbers: cut it into parts")
        topics.append(_sorted(Series(topic, f"px4/{data.name}", times, columns)) if len(times) else None)
    if file.file_corruption:
        remarks.append("the file is damaged: some of its records are missing")
    return "PX4", topics, remarks


def _read_dataflash(path: Path, budget: list[int]) -> tuple[str, list[Series | None], list[str]]:
    reader = _package("pymavlink.DFReader", "a log of ArduPilot", "mavlink")
    binary = reader.DFReader_binary
    # its other index is written in C, and prints where nothing redirects it
    quiet = type("DFReader", (binary,), {"init_arrays_fast": binary.init_arrays})
    kind = reader.DFReader_text if path.suffix.lower() == ".log" else quiet
    topics: dict[str, _Rows] = {}
    skipped = _Skipped()
    with redirect_stdout(skipped), redirect_stderr(skipped):
        _read_messages(iter(kind(str(path), zero_time_base=True).recv_match, None), topics, budget)
    remarks = [f"the file is damaged: in {skipped.count:,} places there is no message"] if skipped.count else []
    return "ArduPilot", _all(topics.values()), remarks


class _Skipped(io.TextIOBase):
    """Counts what packages write about damaged logs: pymavlink, a line about each byte that it skips."""

    def __init__(self) -> None:
        super().__init__()
        self.count = 0

    def write(self, text: str) -> int:
        """Take a text.

        Raises:
            LogError: the file has hardly anything else.
        """
        self.count += text.count("\n")
        if self.count > _MOST_SKIPPED:
            raise LogError(f"the file is damaged: in more than {_MOST_SKIPPED:,} places there is no message")
        return len(text)


def _read_messages(messages: Iterable[Any], topics: dict[str, _Rows], budget: list[int]) -> None:
    """Add the messages of ArduPilot to their topics."""
    for message in messages:
        name = message.get_type()
        values = message.to_dict()
        values.pop("mavpackettype", None)
        time = _number(values.pop("TimeUS", None), math.nan) * 1e-6
        number = values.get("I", values.get("C", 0))
        topic = f"{name}.{number:g}" if isinstance(number, (int, float)) and number else name
        if not math.isfinite(time) or (topic not in topics and len(topics) >= _MOST_TOPICS):
            continue
        topics.setdefault(topic, _Rows(topic, f"ardupilot/{name}", budget)).add(time, _flat(values))


def _read_csv(path: Path, budget: list[int]) -> tuple[str, list[Series | None], list[str]]:
    with open_regular(path, _LARGEST_CSV) as file:
        text = io.TextIOWrapper(file, "utf-8-sig", "replace", newline="")
        reader = csv.reader(text)
        header = [name.strip() for name in next(reader, [])]
        if len(header) > _MOST_COLUMNS:
            raise LogError(f"{path} has {len(header):,} columns, expected at most {_MOST_COLUMNS:,}")
        known = [index for index, name in enumerate(header) if name.lower() in _TIMES]
        if not known:
            raise LogError(
                f"{path} has no column of times: expected one called time (s), time_ms, time_us or time_ns, found "
                f"{', '.join(quoted(name) for name in header[:8]) or 'nothing'}"
            )
        place, unit = known[0], _TIMES[header[known[0]].lower()]
        rows = _Rows(path.stem, "csv", budget)
        for line in reader:
            if len(line) != len(header):
                continue
            numbers = [_float(cell) for cell in line]
            rows.add(
                numbers[place] * unit,
                {
                    name: number
                    for index, (name, number) in enumerate(zip(header, numbers, strict=True))
                    if index != place
                },
            )
    return "CSV", _all([rows]), []


def _float(value: Any) -> float:
    try:
        return float(value)
    except (ValueError, OverflowError):
        return math.nan


_READERS: dict[str, Callable[[Path, list[int]], tuple[str, list[Series | None], list[str]]]] = {
    ".mcap": _read_mcap,
    ".bag": _read_bag,
    ".db3": _read_bag,
    ".ulg": _read_ulog,
    ".bin": _read_dataflash,
    ".log": _read_dataflash,
    ".csv": _read_csv,
}


def read_log(path: str | os.PathLike[str]) -> Log:
    """Read a log, by the suffix of its name; a folder is a bag of ROS 2.

    Raises:
        LogError: it cannot be read, is too large, or has no numbers; or a package is missing.
    """
    file = Path(path)
    if not file.exists():
        near = [one.name for one in file.parent.iterdir() if one.suffix in _READERS] if file.parent.is_dir() else []
        raise LogError(f"there is no log {file}{nearest(file.name, near)}")
    read = _read_bag if file.is_dir() else _READERS.get(file.suffix.lower())
    if read is None:
        raise LogError(f"{file.name} is no log: expected {', '.join(_READERS)}, or a folder with a bag of ROS 2")
    budget = [_MOST_NUMBERS]
    try:
        if not file.is_dir():
            open_regular(file, _LARGEST).close()
        form, topics, remarks = read(file, budget)
    except MorseError as error:
        raise LogError(str(error)) from None
    except OSError as error:
        raise LogError(f"{file} cannot be read: {error.strerror or error}") from None
    except MemoryError:
        raise LogError(f"{file} cannot be read: it needs more memory than there is") from None
    except Exception as error:  # packages that read damaged files raise anything
        raise LogError(f"{file} cannot be read: {type(error).__name__}: {str(error)[:200]}") from None
    return _relative(Log(str(file), form, _named(topics), 0.0, remarks))


def _named(topics: Iterable[Series | None]) -> dict[str, Series]:
    return {one.topic: one for one in topics if one is not None}


def _relative(log: Log) -> Log:
    """All times from the beginning of a log on; those of a recording of MORSE from that of the simulation."""
    if not log.series:
        raise LogError(f"{log.path} has no numbers{': ' + '; '.join(log.remarks[:3]) if log.remarks else ''}")
    if log.form != "recording of MORSE":
        log.begin = min(float(one.times[0]) for one in log.series.values())
    for one in log.series.values():
        one.times = one.times - log.begin
    return log


def summary(log: Log) -> Sequence[str]:
    """A line for each topic."""
    return [
        f"{short(one.topic)}: {len(one.times):,} of {short(one.type)}, "
        f"{(len(one.times) - 1) / max(float(one.times[-1] - one.times[0]), 1e-9):.4g} Hz"
        for one in log.series.values()
    ]
