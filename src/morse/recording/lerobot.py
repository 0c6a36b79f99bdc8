"""Data sets for learning from demonstrations, in the layout of LeRobot, version 2.1 (Cadene et al. 2024).

A robot is a data set; each life of the simulation, from one restart to the next, is an episode. Frames have a constant
rate. A frame has the last measurement of each sensor until its time, and the last command before the next frame: the
one with which a controller answers to what the frame shows.
"""

from __future__ import annotations

import bisect
import io
import json
import math
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.recording.coco import COLORS, IMAGE, Camera, decoded, pixels_of
from morse.recording.errors import RecordingError
from morse.recording.fields import COMPONENT, FIELDS
from morse.recording.fields.blocks import block_of
from morse.recording.inputs import TOPIC as INPUTS
from morse.recording.inputs import readable_entry

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from morse.recording.mcap.reader import Channel, McapFile
    from morse.recording.mcap.records import Message

VERSION = "v2.1"
#: paths of the layout, and number of episodes in a folder
_DATA, _CHUNK = "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet", 1000
#: lists with more numbers are features of their own
_MOST_ITEMS = 36
#: largest numbers of values in memory, of numbers in a list, of frames of an episode, and of frames in a batch
_MOST, _LONGEST, _FRAMES, _BATCH = 50_000_000, 100_000, 10_000_000, 100
#: times that differ by less are the same, ns: those after a restart are rounded
_SAME = 1000
#: the columns that each data set has
_INDICES = {
    "timestamp": "float32",
    "frame_index": "int64",
    "episode_index": "int64",
    "index": "int64",
    "task_index": "int64",
}


class _Signal:
    """A number or a list of numbers over time.

    Attributes:
        names: of the items.
        times, values: of the samples, ns; rows of float32.
    """

    def __init__(self, name: str, size: int, is_list: bool) -> None:
        self.names = [f"{name}.{item}" for item in range(size)] if is_list else [name]
        self.name, self.times = name, list[int]()
        self.values: list[NDArray[np.float32]] = []

    def at(self, time: float, first: float) -> NDArray[np.float32] | None:
        """The last values until a time and not before another, ns; None without a sample."""
        place = bisect.bisect_right(self.times, time) - 1
        return self.values[place] if place >= 0 and self.times[place] >= first else None

    def first(self, begin: float, end: float) -> float:
        """The time of the first sample from a time to another, ns; infinity without one."""
        place = bisect.bisect_left(self.times, begin)
        return self.times[place] if place < len(self.times) and self.times[place] < end else math.inf


class _Signals:
    """The numbers of some components, by name; what is no number, or changes its length, is left out.

    Attributes:
        found: by name.
        left_out: names without numbers.
        elsewhere: names of what has another feature.
    """

    def __init__(self, budget: list[int]) -> None:
        self.found: dict[str, _Signal] = {}
        self.left_out: set[str] = set()
        self.elsewhere: set[str] = set()
        self._budget = budget

    def add(self, component: str, time: int, values: dict[str, Any]) -> None:
        """Add the fields of a component at a time, ns."""
        for field, value in values.items():
            name = f"{component}.{field}"
            if field == "timestamp" or value is None or name in self.left_out or name in self.elsewhere:
                continue
            row = _numbers(value)
            signal = self.found.get(name)
            if row is None or (signal is not None and len(row) != len(signal.names)):
                self.left_out.add(name)
                self.found.pop(name, None)
                continue
            if signal is None:
                signal = self.found[name] = _Signal(
                    name, len(row), not isinstance(value, (bool, int, float, np.number))
                )
            self._budget[0] -= len(row)
            if self._budget[0] < 0:
                raise RecordingError(f"it has more than {_MOST:,} numbers: select some --topics")
            if signal.times and time <= signal.times[-1]:
                # the last command of a tick counts
                signal.values[-1] = row
            else:
                signal.times.append(time)
                signal.values.append(row)


def _numbers(value: Any) -> NDArray[np.float32] | None:
    """The values as a row; None for what is no number and no list of numbers."""
    try:
        row = np.asarray(value)
    except (ValueError, TypeError, OverflowError):
        return None
    if row.dtype.kind not in "biuf" or row.ndim > 1 or not 0 < row.size <= _LONGEST:
        return None
    return np.atleast_1d(row).astype(np.float32)


class _View(NamedTuple):
    """A color camera.

    Attributes:
        name: of the feature.
        camera: channel, encoding and size.
        times: of its pictures, ns.
    """

    name: str
    camera: Camera
    times: list[int]


class _Pictures:
    """The pictures of a camera, read one after the other."""

    def __init__(self, file: McapFile, view: _View) -> None:
        self._messages: Iterator[Message] = file.messages([view.camera.channel.number])
        self._view, self._next = view, next(self._messages, None)
        self._last: Message | None = None
        self._png, self._moments = b"", np.zeros((4, 3))

    def at(self, time: float) -> tuple[bytes, NDArray[np.float64]]:
        """The last picture until a time, ns: a PNG; minima, maxima, means and mean squares of its colors, 0 to 1."""
        passed = None
        while self._next is not None and self._next.log_time <= time:
            passed, self._next = self._next, next(self._messages, None)
        if passed is not None:
            self._png, self._moments = _encoded(pixels_of(passed, self._view.camera))
        return self._png, self._moments


def _encoded(pixels: NDArray[np.uint8]) -> tuple[bytes, NDArray[np.float64]]:
    from PIL import Image

    target = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels)).save(target, "png")
    colors = pixels.reshape(-1, 3) / 255.0
    moments = [colors.min(axis=0), colors.max(axis=0), colors.mean(axis=0), (colors**2).mean(axis=0)]
    return target.getvalue(), np.stack(moments)


class Robot:
    """What a recording has of a robot.

    Attributes:
        name: of the robot.
        sensors, commands: numbers over time.
        views: color cameras.
    """

    def __init__(self, name: str, budget: list[int]) -> None:
        self.name = name
        self.sensors, self.commands = _Signals(budget), _Signals(budget)
        self.views: list[_View] = []
        self.others: list[str] = []

    def features(self) -> dict[str, list[_Signal]]:
        """The signals of each feature: state, actions, and long lists."""
        groups: dict[str, list[_Signal]] = {}
        for signal in self.sensors.found.values():
            is_long = len(signal.names) > _MOST_ITEMS
            groups.setdefault(f"observation.{_key(signal.name)}" if is_long else "observation.state", []).append(signal)
        if self.commands.found:
            groups["action"] = list(self.commands.found.values())
        return groups

    def rate(self, frequency: float) -> float:
        """The highest rate of its cameras, or without cameras of its sensors, Hz; it divides that of the ticks."""
        times = [view.times for view in self.views] or [signal.times for signal in self.sensors.found.values()]
        periods = [float(np.median(np.diff(one))) for one in times if len(one) > 1]
        ticks = round(min(periods, default=0.0) / 1e9 * frequency)
        return frequency / max(ticks, 1)


def _key(name: str) -> str:
    """A name of a feature: LeRobot allows no slashes."""
    return name.replace("/", "_").replace("\\", "_")


def robots_of(file: McapFile, channels: Sequence[Channel]) -> tuple[dict[str, Robot], list[int]]:
    """The robots with sensors in a recording, and the times at which their episodes begin, ns.

    Raises:
        RecordingError: the recording is damaged, or has too many numbers.
    """
    budget = [_MOST]
    robots: dict[str, Robot] = {}
    sensors: dict[int, tuple[Robot, str]] = {}
    for channel in channels:
        name = channel.metadata.get(COMPONENT, "")
        if channel.topic.startswith(f"{FIELDS}/") and name:
            owner, _, part = name.partition(".")
            sensors[channel.number] = (robots.setdefault(owner, Robot(owner, budget)), part or owner)
    cameras = _cameras(file, channels, robots)
    inputs = {channel.number for channel in file.channels.values() if channel.topic == INPUTS}
    begins: dict[int, int] = {}
    for one in file.messages({*sensors, *cameras, *inputs}):
        # a restart moves simulated time against that of the recording; inputs before its first tick are after it
        time = one.log_time + 1 if one.channel in inputs else one.log_time
        moved = one.log_time - one.publish_time
        known = next((at for at in begins if abs(at - moved) < _SAME), moved)
        begins[known] = min(time, begins.get(known, time))
        if one.channel in inputs:
            entry = readable_entry(one.data)
            owner, _, part = str(entry.get("name")).partition(".")
            if owner in robots and entry.get("kind") == "command":
                robots[owner].commands.add(part or owner, time, entry["content"])
            continue
        if one.channel in cameras:
            cameras[one.channel].times.append(one.log_time)
            continue
        robot, part = sensors[one.channel]
        block = block_of(one, file.path)
        for index in range(len(block)):
            row = block.row(index)
            robot.sensors.add(part, row.time, row.values)
    return robots, sorted(begins.values())


def _cameras(file: McapFile, channels: Sequence[Channel], robots: dict[str, Robot]) -> dict[int, _View]:
    views = {}
    for channel in channels:
        owner, _, part = channel.topic.strip("/").rpartition("/")[0].partition("/")
        if channel.type != IMAGE or channel.encoding != "cdr" or owner not in robots:
            continue
        first = next(file.messages([channel.number]), None)
        if first is None:
            continue
        image = decoded(IMAGE, first)
        if image["encoding"] not in COLORS:
            robots[owner].others.append(channel.topic)
            continue
        camera = Camera(channel, str(image["encoding"]), (float(image["width"]), float(image["height"])), "")
        view = _View(f"observation.images.{part.replace('/', '.')}", camera, [])
        views[channel.number] = view
        robots[owner].views.append(view)
        robots[owner].sensors.elsewhere.add(f"{part.replace('/', '.')}.image")
    return views


class _Episode(NamedTuple):
    """When an episode is, and its frames.

    Attributes:
        first, last: times of the first and of the last frame, ns.
        begin, end: of what belongs to it, ns.
    """

    first: float
    last: float
    begin: float
    end: float


def _episode(robot: Robot, begin: float, end: float) -> _Episode | str:
    """The frames of an episode: from the first moment at which all is known; or why there is none."""
    firsts = {
        **{signal.name: signal.first(begin, end) for signal in robot.sensors.found.values()},
        **{signal.name: signal.first(begin, end) for signal in robot.commands.found.values()},
    }
    lasts = [signal.times[bisect.bisect_left(signal.times, end) - 1] for signal in robot.sensors.found.values()]
    for view in robot.views:
        place = bisect.bisect_left(view.times, begin)
        firsts[view.name] = view.times[place] if place < len(view.times) and view.times[place] < end else math.inf
        lasts.append(view.times[bisect.bisect_left(view.times, end) - 1])
    missing = [name for name, first in firsts.items() if first == math.inf]
    if missing:
        return f"it has no {', '.join(missing[:3])}"
    return _Episode(max(firsts.values()), max(lasts), begin, end)


class DataSet:
    """The files of a robot.

    Args:
        folder: is created.
        robot: its signals and pictures.
        rate: of the frames, Hz.
        task: what is done, in words.

    Raises:
        OSError: a file cannot be written. Without ``meta/info.json``, which is written last, nothing is read.
    """

    def __init__(self, folder: Path, robot: Robot, rate: float, task: str) -> None:
        self._folder, self._robot, self._rate, self._task = folder, robot, rate, task
        self._groups = robot.features()
        self.frames = 0
        self._lengths: list[int] = []
        (folder / "meta").mkdir(parents=True)

    def add(self, file: McapFile, episode: _Episode) -> None:
        """Write the frames of an episode, later than those before."""
        from pyarrow import parquet

        number, schema = len(self._lengths), self._schema()
        path = self._folder / _DATA.format(episode_chunk=number // _CHUNK, episode_index=number)
        path.parent.mkdir(parents=True, exist_ok=True)
        statistics = _Statistics()
        readers = {view.name: _Pictures(file, view) for view in self._robot.views}
        count = math.floor((episode.last - episode.first + _SAME) * 1e-9 * self._rate) + 1
        if count > _FRAMES:
            raise RecordingError(f"an episode of {count:,} frames is not written: expected at most {_FRAMES:,}")
        with path.open("xb") as target, parquet.ParquetWriter(target, schema, compression="zstd") as writer:
            for begin in range(0, count, _BATCH):
                indices = range(begin, min(begin + _BATCH, count))
                writer.write_table(self._table(schema, episode, indices, readers, statistics))
        _append(
            self._folder / "meta" / "episodes.jsonl", {"episode_index": number, "tasks": [self._task], "length": count}
        )
        _append(
            self._folder / "meta" / "episodes_stats.jsonl", {"episode_index": number, "stats": statistics.content()}
        )
        self.frames += count
        self._lengths.append(count)

    def _table(
        self, schema: Any, episode: _Episode, indices: range, readers: dict[str, _Pictures], statistics: _Statistics
    ) -> Any:
        import pyarrow

        columns: dict[str, Any] = {}
        times = [episode.first + index * 1e9 / self._rate for index in indices]
        for name, signals in self._groups.items():
            # a command answers to the frame before the next one
            late = 1e9 / self._rate - _SAME if name == "action" else _SAME
            rows = np.array(
                [self._row(signals, min(time + late, episode.end - 1), episode.begin) for time in times], np.float32
            )
            statistics.add(name, rows)
            columns[name] = rows.ravel() if rows.shape[1] == 1 else rows.tolist()
        for name, pictures in readers.items():
            cells = []
            for index, time in zip(indices, times, strict=True):
                png, moments = pictures.at(time + _SAME)
                statistics.add_picture(name, moments)
                cells.append({"bytes": png, "path": f"frame_{index:06d}.png"})
            columns[name] = cells
        frame = np.array(indices, np.int64)
        number = np.full(len(frame), len(self._lengths))
        numbers = (frame / self._rate, frame, number, frame + self.frames, np.zeros(len(frame)))
        for (name, kind), values in zip(_INDICES.items(), numbers, strict=True):
            columns[name] = values.astype(kind)
            statistics.add(name, columns[name][:, None])
        return pyarrow.table(
            {name: pyarrow.array(columns[name], schema.field(name).type) for name in schema.names}, schema
        )

    @staticmethod
    def _row(signals: list[_Signal], time: float, first: float) -> NDArray[np.float32]:
        values = [signal.at(time, first) for signal in signals]
        return np.concatenate([one for one in values if one is not None])

    def _schema(self) -> Any:
        """The columns; their kinds for `datasets` of Hugging Face are in the metadata."""
        import pyarrow

        fields, kinds = [], {}
        for name, feature in self._features().items():
            kind = {"dtype": feature["dtype"], "_type": "Value"}
            column: Any = getattr(pyarrow, "string" if feature["dtype"] == "image" else feature["dtype"])()
            if feature["dtype"] == "image":
                column = pyarrow.struct([("bytes", pyarrow.binary()), ("path", pyarrow.string())])
                kind = {"_type": "Image"}
            elif feature["shape"] != [1]:
                column = pyarrow.list_(column, feature["shape"][0])
                kind = {"feature": kind, "length": feature["shape"][0], "_type": "Sequence"}
            fields.append((name, column))
            kinds[name] = kind
        return pyarrow.schema(fields, {"huggingface": json.dumps({"info": {"features": kinds}})})

    def _features(self) -> dict[str, dict[str, Any]]:
        found: dict[str, dict[str, Any]] = {}
        for name, signals in self._groups.items():
            names = [item for signal in signals for item in signal.names]
            found[name] = {"dtype": "float32", "shape": [len(names)], "names": names}
        for view in self._robot.views:
            width, height = (int(size) for size in view.camera.view)
            found[view.name] = {"dtype": "image", "shape": [height, width, 3], "names": ["height", "width", "channels"]}
        return found | {name: {"dtype": kind, "shape": [1], "names": None} for name, kind in _INDICES.items()}

    def close(self) -> None:
        """Write what describes all episodes."""
        _append(self._folder / "meta" / "tasks.jsonl", {"task_index": 0, "task": self._task})
        episodes = len(self._lengths)
        content = {
            "codebase_version": VERSION,
            "robot_type": self._robot.name,
            "total_episodes": episodes,
            "total_frames": self.frames,
            "total_tasks": 1,
            "total_videos": 0,
            "total_chunks": -(-episodes // _CHUNK),
            "chunks_size": _CHUNK,
            "fps": int(self._rate) if self._rate == int(self._rate) else self._rate,
            "splits": {"train": f"0:{episodes}"},
            "data_path": _DATA,
            "video_path": None,
            "features": self._features(),
        }
        with (self._folder / "meta" / "info.json").open("x", encoding="utf-8") as target:
            json.dump(content, target, indent=4)


def _append(path: Path, line: dict[str, Any]) -> None:
    with path.open("a", encoding="utf-8") as target:
        target.write(json.dumps(line) + "\n")


class _Statistics:
    """Minimum, maximum, mean and standard deviation of each feature of an episode, without what is not finite."""

    def __init__(self) -> None:
        self._rows: dict[str, NDArray[np.float64]] = {}
        self._pictures: dict[str, tuple[int, NDArray[np.float64]]] = {}

    def add(self, name: str, rows: NDArray[Any]) -> None:
        """Add values, (N, D)."""
        values = rows.astype(float)
        is_known = np.isfinite(values)
        known = np.where(is_known, values, 0.0)
        part = np.stack(
            [
                np.where(is_known, values, np.inf).min(axis=0),
                np.where(is_known, values, -np.inf).max(axis=0),
                known.sum(axis=0),
                (known**2).sum(axis=0),
                is_known.sum(axis=0).astype(float),
                np.full(values.shape[1], float(len(values))),
            ]
        )
        old = self._rows.get(name)
        if old is not None:
            part = np.stack([np.minimum(old[0], part[0]), np.maximum(old[1], part[1]), *(old + part)[2:]])
        self._rows[name] = part

    def add_picture(self, name: str, moments: NDArray[np.float64]) -> None:
        """Add a picture: minima, maxima, means and mean squares of its colors, (4, 3)."""
        count, old = self._pictures.get(name, (0, moments))
        rest = (old[2:] * count + moments[2:]) / (count + 1)
        self._pictures[name] = (
            count + 1,
            np.stack([np.minimum(old[0], moments[0]), np.maximum(old[1], moments[1]), *rest]),
        )

    def content(self) -> dict[str, dict[str, Any]]:
        """As in ``meta/episodes_stats.jsonl``."""
        found: dict[str, dict[str, Any]] = {}
        for name, (low, high, total, squares, known, count) in self._rows.items():
            mean = total / np.maximum(known, 1.0)
            spread = np.sqrt(np.maximum(squares / np.maximum(known, 1.0) - mean**2, 0.0))
            values = {"min": low, "max": high, "mean": mean, "std": spread}
            found[name] = {key: np.where(known > 0.0, one, 0.0).tolist() for key, one in values.items()}
            found[name]["count"] = [int(count[0])]
        for name, (number, (low, high, mean, square)) in self._pictures.items():
            spread = np.sqrt(np.maximum(square - mean**2, 0.0))
            values = {"min": low, "max": high, "mean": mean, "std": spread}
            found[name] = {key: one.reshape(3, 1, 1).tolist() for key, one in values.items()}
            found[name]["count"] = [number]
        return found


def write_robot(
    file: McapFile, robot: Robot, begins: list[int], folder: Path, remarks: list[str]
) -> tuple[int, tuple[str, ...]]:
    """Write the data set of a robot.

    Args:
        file: a recording.
        robot, begins: of `robots_of`.
        folder: is created.
        remarks: get what is left out.

    Returns:
        The number of frames, and the fields and topics that are left out.

    Raises:
        RecordingError: there is no frame, or the recording is damaged.
        OSError: a file cannot be written.
    """
    if not robot.sensors.found and not robot.views:
        raise RecordingError("its sensors have no numbers and no colors")
    facts = file.metadata.get("morse", {})
    try:
        frequency = float(facts.get("frequency", ""))
    except ValueError:
        frequency = 60.0
    if not 0.0 < frequency < 1e6:
        raise RecordingError(f"its frequency is {frequency}, expected a number of ticks per second")
    ends: list[float] = [*begins[1:], math.inf]
    episodes = [_episode(robot, begin, end) for begin, end in zip(begins, ends, strict=True)]
    why = [f"episode {number} is left out: {one}" for number, one in enumerate(episodes) if isinstance(one, str)]
    complete = [one for one in episodes if not isinstance(one, str)]
    if not complete:
        raise RecordingError("; ".join(why[:3]))
    remarks += [f"{robot.name}: {one}" for one in why]
    if not robot.commands.found:
        remarks.append(f"{robot.name}: no actuator had a command with numbers, so there is no action")
    task = PurePath(facts.get("script", "")).stem or f"{robot.name} in {facts.get('environment', 'a simulation')}"
    data = DataSet(folder, robot, robot.rate(frequency), task)
    for episode in complete:
        data.add(file, episode)
    data.close()
    return data.frames, tuple(sorted({*robot.sensors.left_out, *robot.commands.left_out, *robot.others}))
