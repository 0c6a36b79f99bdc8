"""Which topic of a log is which component of a scene: by type and name, and by a table that users correct."""

from __future__ import annotations

import math
import re
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.exceptions import MorseError
from morse.core.reports.quoting import nearest, quoted, short
from morse.plugins.twin.log import COMMANDS
from morse.plugins.twin.parameters import GREATEST
from morse.plugins.twin.replay import Samples
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from morse.core.declarations import DataField
    from morse.plugins.twin.log import Log, Series
    from morse.plugins.twin.replay import Probe
    from morse.scene import Scene

    Floats = NDArray[np.float64]

#: largest size of a table, bytes
_LARGEST = 1 << 20
_AXES = ("x", "y", "z", "w")
#: number of samples from which a value that never changes was not measured
_FEWEST = 8
#: functions of a quaternion at a prefix
_ANGLES = ("roll", "pitch", "yaw")
_TERM = re.compile(r"\s*(?:([-+]?[0-9.]+(?:[eE][-+]?\d+)?)\s*\*\s*|(-)\s*)?(?:(roll|pitch|yaw)\(([^()]*)\)|(\S.*?))\s*")


class MappingError(MorseError):
    """A log and a scene have nothing in common, or a table is wrong."""


def _vector(
    prefix: str, names: Sequence[str] = ("x", "y", "z"), signs: Sequence[str] = ("", "", "")
) -> tuple[str, ...]:
    return tuple(f"{sign}{prefix}{name}" for sign, name in zip(signs, names, strict=True))


def _pose(prefix: str) -> dict[str, Any]:
    place = {name: f"{prefix}position.{name}" for name in ("x", "y", "z")}
    return place | {name: f"{name}({prefix}orientation)" for name in _ANGLES}


def _twist(prefix: str) -> dict[str, Any]:
    """Of all components that are driven by, or measure, speeds; the fields of each are those that it has."""
    return {
        "v": f"{prefix}linear.x",
        "w": f"{prefix}angular.z",
        "x": f"{prefix}linear.x",
        "y": f"{prefix}linear.y",
        "vx": f"{prefix}linear.x",
        "vy": f"{prefix}linear.y",
        "vz": f"{prefix}linear.z",
        "vyaw": f"-{prefix}angular.z",
        "linear_velocity": _vector(f"{prefix}linear."),
        "angular_velocity": _vector(f"{prefix}angular."),
    }


_IMU = {
    "angular_velocity": _vector("angular_velocity."),
    "linear_acceleration": _vector("linear_acceleration."),
    "roll": "roll(orientation)",
    "pitch": "pitch(orientation)",
    "yaw": "yaw(orientation)",
}
#: X forward, Y right, Z down
_FRD = ("", "-", "-")
#: the fields of components by the type of messages: the fields of a component that are among these are used
RULES: dict[str, dict[str, Any]] = {
    "geometry_msgs/Twist": _twist(""),
    "geometry_msgs/TwistStamped": _twist("twist."),
    "geometry_msgs/PoseStamped": _pose("pose."),
    "geometry_msgs/PoseWithCovarianceStamped": _pose("pose.pose."),
    "geometry_msgs/TransformStamped": {
        **{name: f"transform.translation.{name}" for name in ("x", "y", "z")},
        **{name: f"{name}(transform.rotation)" for name in _ANGLES},
    },
    "nav_msgs/Odometry": _pose("pose.pose.") | {
        "linear_velocity": _vector("twist.twist.linear."),
        "angular_velocity": _vector("twist.twist.angular."),
    },
    "sensor_msgs/Imu": _IMU,
    "sensor_msgs/MagneticField": {"magnetic_field": _vector("magnetic_field.")},
    "sensor_msgs/LaserScan": {"range_list": "ranges"},
    "sensor_msgs/Range": {"range": "range"},
    "sensor_msgs/FluidPressure": {"pressure": "fluid_pressure"},
    "sensor_msgs/JointState": {"*": "position.*"},
    "ackermann_msgs/AckermannDrive": {"v": "speed"},
    "ackermann_msgs/AckermannDriveStamped": {"v": "drive.speed"},
    "px4/sensor_combined": {
        "angular_velocity": _vector("gyro_rad", ("[0]", "[1]", "[2]"), _FRD),
        "linear_acceleration": _vector("accelerometer_m_s2", ("[0]", "[1]", "[2]"), _FRD),
    },
    "px4/vehicle_local_position": {
        # X north, Y east, Z down: the scene has X north and Y west
        "x": "x", "y": "-y", "z": "-z", "linear_velocity": ("vx", "-vy", "-vz"),
    },
    "px4/vehicle_attitude_setpoint": {"roll": "roll_body", "pitch": "pitch_body", "thrust": "-1 * thrust_body[2]"},
    "px4/actuator_motors": {"engines": tuple(f"control[{index}]" for index in range(4))},
    "ardupilot/IMU": {
        "angular_velocity": ("GyrX", "-GyrY", "-GyrZ"),
        "linear_acceleration": ("AccX", "-AccY", "-AccZ"),
    },
    "ardupilot/XKF1": {"x": "PN", "y": "-PE", "z": "-PD"},
    "ardupilot/ATT": {
        "roll": f"{math.radians(1.0)!r} * Roll", "pitch": f"{-math.radians(1.0)!r} * Pitch",
        "yaw": f"{-math.radians(1.0)!r} * Yaw",
    },
}  # fmt: skip


@dataclass
class Link:
    """A component and its topic.

    Attributes:
        component: full name.
        topic: of the log.
        sources: field to an expression of columns, or to one for each item.
        is_command: whether the component is an actuator.
        where: the table that says so; empty if it was found by type and name.
    """

    component: str
    topic: str
    sources: dict[str, str | tuple[str, ...]]
    is_command: bool
    where: str = ""

    def __str__(self) -> str:
        return f"{short(self.topic)} → {self.component} ({', '.join(map(short, self.sources))})"


def _base(kind: str) -> str:
    """``sensor_msgs/Imu`` for ``sensor_msgs/msg/Imu``."""
    return kind.replace("/msg/", "/")


def links_of(log: Log, scene: Scene, probe: Probe, robots: Sequence[str]) -> tuple[list[Link], list[str]]:
    """Find the topics of the components of a scene, by type and name.

    Returns:
        The links, and the topics that no component has.
    """
    candidates: list[tuple[float, str, str, Link]] = []
    for one in log.series.values():
        for component in scene.components:
            if component.kind not in ("sensor", "actuator"):
                continue
            fields = probe.fields.get(component.name, {})
            sources = _sources(one, component.name, component.kind == "actuator", fields)
            if sources:
                score = _likeness(one.topic, component.name, robots) + 0.1 * len(sources) / (1 + len(fields))
                link = Link(component.name, one.topic, sources, component.kind == "actuator")
                candidates.append((score, component.name, one.topic, link))
    candidates.sort(key=lambda one: (-one[0], one[1], one[2]))
    links: dict[str, Link] = {}
    taken: set[str] = set()
    for _, name, topic, link in candidates:
        # a CSV file is a topic with columns for several components
        if name not in links and (topic not in taken or log.series[topic].type == "csv"):
            links[name] = link
            taken.add(topic)
    order = [one.name for one in scene.components if one.name in links]
    return [links[name] for name in order], [topic for topic in log.series if topic not in taken]


def _sources(
    one: Series, component: str, is_command: bool, fields: Mapping[str, DataField]
) -> dict[str, str | tuple[str, ...]]:
    if one.is_exact:
        name = one.topic.removeprefix(COMMANDS)
        if name != component or one.topic.startswith(COMMANDS) != is_command:
            return {}
        return {field: field for field in fields if field in one.columns and field != "timestamp"}
    if one.type == "csv":
        return _by_name(one, component, fields)
    rule = RULES.get(_base(one.type), {})
    found: dict[str, str | tuple[str, ...]] = {}
    for field in fields:
        source = rule.get(field)
        if source is None and "*" in rule:
            source = rule["*"].replace("*", field)
        if source is not None and _exists(source, one):
            found[field] = source
    # what moves by x and y is no pose
    is_twist = "Twist" in one.type
    if is_twist and not is_command and "linear_velocity" not in fields and "angular_velocity" not in fields:
        return {}
    if not is_command and ("Twist" in one.type or "Ackermann" in one.type) and {"x", "y"} & set(found):
        return {}
    if is_command and "Twist" not in one.type and {"angular_velocity", "range_list"} & set(found):
        return {}
    if is_command and ("Pose" in one.type or "Odometry" in one.type or "Transform" in one.type or "Imu" in one.type):
        return {}
    return found


def _by_name(one: Series, component: str, fields: Mapping[str, DataField]) -> dict[str, str | tuple[str, ...]]:
    """The columns of a CSV file that are called after fields: ``robot.imu.angular_velocity.x``, ``imu.yaw``."""
    found: dict[str, str | tuple[str, ...]] = {}
    prefixes = [component]
    while "." in prefixes[-1]:
        prefixes.append(prefixes[-1].partition(".")[2])
    for field in fields:
        if field == "timestamp":
            continue
        for prefix in prefixes:
            name = f"{prefix}.{field}"
            size = _shape(fields[field]) or len(_AXES)
            parts = tuple(f"{name}.{axis}" if f"{name}.{axis}" in one.columns else "" for axis in _AXES[:size])
            if name in one.columns:
                found[field] = name
            elif any(parts):
                # a list of unknown length ends with the last item of the log
                found[field] = parts if _shape(fields[field]) else tuple(filter(None, parts))
            if field in found:
                break
    return found


def _exists(source: str | tuple[str, ...], one: Series) -> bool:
    try:
        for text in (source,) if isinstance(source, str) else source:
            _evaluated(text, one)
    except MappingError:
        return False
    return True


def _likeness(topic: str, component: str, robots: Sequence[str]) -> float:
    """How alike the names of a topic and a component are."""
    words = set(re.split(r"[/._\d]+", topic.lower())) - {""}
    own = [word for word in re.split(r"[._\d]+", component.lower()) if word]
    score = sum(1.0 for word in own if word in words)
    score += 0.5 * sum(any(word in other or other in word for other in words) for word in own if word not in words)
    is_other = any(robot.lower() in words for robot in robots if not component.startswith(f"{robot}."))
    return score - 2.0 * is_other


# -- expressions -----------------------------------------------------------------------------


def _evaluated(text: str, one: Series) -> Floats:
    """The values of an expression: ``-1 * a.b``, ``-a``, ``yaw(pose.orientation)``.

    Raises:
        MappingError: it is none, or there is no such column.
    """
    match = _TERM.fullmatch(text)
    if match is None:
        raise MappingError(f"{quoted(text)} is no column: expected NAME, -NAME, FACTOR * NAME or yaw(PREFIX)")
    factor, minus, angle, prefix, name = match.groups()
    try:
        scale = float(factor) if factor else (-1.0 if minus else 1.0)
    except ValueError:
        raise MappingError(f"{quoted(text)}: {quoted(factor)} is no number") from None
    return scale * (_angle(angle, prefix.strip(), one) if angle else _columns(name, one))


def _columns(name: str, one: Series) -> Floats:
    if name in one.columns:
        return one.columns[name]
    head, bracket, index = name.partition("[")
    if bracket and head in one.columns and index[:-1].isdecimal() and one.columns[head].ndim == 2:
        place = int(index[:-1])
        if place < one.columns[head].shape[1]:
            return one.columns[head][:, place]
    raise MappingError(
        f"{short(one.topic)} has no column {quoted(name)}{nearest(name, list(one.columns), say='it has')}"
    )


def _angle(angle: str, prefix: str, one: Series) -> Floats:
    x, y, z, w = (_columns(f"{prefix}.{axis}", one) for axis in _AXES)
    size = np.sqrt(x * x + y * y + z * z + w * w)
    with np.errstate(all="ignore"):
        x, y, z, w = x / size, y / size, z / size, w / size
    if angle == "roll":
        return np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    if angle == "pitch":
        return np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0))
    return np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def samples_of(link: Link, log: Log, fields: Mapping[str, DataField]) -> Samples:
    """What a component has measured, or was commanded; samples that are no numbers are left out.

    Items of vectors that were not measured are NaN. So is what never changes in a log of others, such as the height in
    planar odometry: without noise, it would count more than all that was measured.

    Raises:
        MappingError: a column does not exist, or does not fit its field.
    """
    one = log.series[link.topic]
    columns: dict[str, Floats] = {}
    for field, source in link.sources.items():
        texts = (source,) if isinstance(source, str) else source
        try:
            parts = [_evaluated(text, one) if text else np.full(len(one.times), math.nan) for text in texts]
            if link.is_command and not all(texts):
                raise MappingError(
                    f"a command has all of its items, the log has {', '.join(filter(None, texts))} alone"
                )
        except MappingError as error:
            raise MappingError(f"{_place(link)}{link.component}.{field}: {error}") from None
        if not isinstance(source, str) and any(part.ndim != 1 for part in parts):
            raise MappingError(f"{_place(link)}{link.component}.{field}: a list has columns of numbers, not of lists")
        columns[field] = parts[0] if isinstance(source, str) else np.stack(parts, axis=1)
        shape = _shape(fields[field])
        is_number = shape is None and isinstance(fields[field].default, (int, float))
        if columns[field].ndim == 2 and (is_number or (shape is not None and columns[field].shape[1] != shape)):
            raise MappingError(
                f"{_place(link)}{link.component}.{field} has {'one number' if is_number else f'{shape} numbers'}, "
                f"{short(link.topic)} has a list of {columns[field].shape[1]}"
            )
    is_finite = np.ones(len(one.times), bool)
    for field, values in columns.items():
        source = link.sources[field]
        numbers = values if values.ndim == 1 or isinstance(source, str) else values[:, [bool(text) for text in source]]
        is_small = np.abs(numbers) <= GREATEST
        is_finite &= is_small if numbers.ndim == 1 else is_small.all(axis=1)
    if not is_finite.any():
        # beams without an echo: those that have one are compared
        raise MappingError(
            f"{_place(link)}{short(link.topic)} has no sample of {link.component} whose values are all numbers"
        )
    places = np.flatnonzero(is_finite)
    # of several samples at one time, the last one
    places = places[np.append(np.diff(one.times[places]) > 0.0, True)]
    chosen = {name: values[places] for name, values in columns.items()}
    return Samples(one.times[places], chosen if link.is_command or one.is_exact else _changing(link, log, chosen))


def _changing(link: Link, log: Log, columns: dict[str, Floats]) -> dict[str, Floats]:
    """What changes in the log of a sensor; all of it if nothing does, because the robot rests."""
    ranges = {name: np.atleast_1d(np.ptp(values, axis=0)) for name, values in columns.items()}
    if not any((one > 0.0).any() for one in ranges.values()) or len(next(iter(columns.values()))) < _FEWEST:
        return columns
    # NaN: not measured at all
    changes = {name: one != 0.0 for name, one in ranges.items()}
    found: dict[str, Floats] = {}
    for name, values in columns.items():
        if changes[name].all():
            found[name] = values
            continue
        count = int(np.sum(~changes[name]))
        which = "" if values.ndim == 1 else f": {count} of {values.shape[1]} numbers"
        log.remarks.append(
            f"{link.component}.{name}{which} never change{'' if which else 's'} in the log, and "
            f"{'are' if which else 'is'} not compared"
        )
        if changes[name].any():
            found[name] = np.where(changes[name], values, math.nan)
    return found


def _place(link: Link) -> str:
    return f"{link.where}: " if link.where else ""


def _shape(field: DataField) -> int | None:
    if isinstance(field.shape, int):
        return field.shape
    default = field.default
    return len(default) if isinstance(default, (list, tuple)) and default else None


# -- tables ----------------------------------------------------------------------------------


def table_text(links: Sequence[Link], unmapped: Sequence[str], log: Log) -> str:
    """The table as TOML, to be corrected."""
    lines = ["# component, its topic, and its fields as columns of the topic", ""]
    for link in links:
        lines += [f"[{_key(link.component)}]", f"topic = {_text(link.topic)}"]
        for field, source in link.sources.items():
            text = _text(source) if isinstance(source, str) else f"[{', '.join(map(_text, source))}]"
            lines.append(f"{_key(field)} = {text}")
        lines.append("")
    for topic in unmapped:
        columns = ", ".join(map(short, list(log.series[topic].columns)[:12]))
        lines.append(f"# {short(topic)} has no component; its columns: {columns}")
    return "\n".join(lines).rstrip() + "\n"


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _text(name)


def _text(text: str) -> str:
    """A basic string of TOML."""
    return (
        '"'
        + "".join(f"\\{one}" if one in '"\\' else one if one.isprintable() else f"\\U{ord(one):08x}" for one in text)
        + '"'
    )


def read_table(path: str | os.PathLike[str], log: Log, scene: Scene, probe: Probe) -> list[Link]:
    """The links of a table.

    Raises:
        MappingError: there is no such file, component, topic, field or column; the message contains the nearest name.
    """
    file = Path(path)
    try:
        content = tomllib.loads(read_regular(file, _LARGEST).decode("utf-8"))
    except OSError as error:
        raise MappingError(f"the table {file} cannot be read: {error.strerror or error}") from None
    except (ValueError, RecursionError) as error:
        raise MappingError(f"{file} is no table in TOML: {str(error)[:200]}") from None
    kinds = {one.name: one.kind for one in scene.components}
    return [_link(file, name, entry, log, kinds, probe) for name, entry in _entries(content)]


def _entries(content: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Tables with a topic; names with dots may be written without quotation marks."""
    for name, entry in content.items():
        full = f"{prefix}{name}"
        if isinstance(entry, dict) and "topic" not in entry and any(isinstance(one, dict) for one in entry.values()):
            yield from _entries(entry, f"{full}.")
        else:
            yield full, entry


def _link(file: Path, name: str, entry: Any, log: Log, kinds: Mapping[str, str], probe: Probe) -> Link:
    if kinds.get(name) not in ("sensor", "actuator"):
        known = [one for one, kind in kinds.items() if kind in ("sensor", "actuator")]
        raise MappingError(f"{file}: there is no component {quoted(name)} in the scene{nearest(name, known)}")
    topic = entry.get("topic") if isinstance(entry, dict) else None
    if not isinstance(topic, str) or topic not in log.series:
        raise MappingError(
            f"{file}: [{name}] has the topic {quoted(topic)}, which the log has not{nearest(topic, list(log.series))}"
        )
    sources: dict[str, str | tuple[str, ...]] = {}
    for field, source in entry.items():
        if field == "topic":
            continue
        if field not in probe.fields[name]:
            raise MappingError(f"{file}: {name} has no field {quoted(field)}{nearest(field, list(probe.fields[name]))}")
        texts = [source] if isinstance(source, str) else source
        if not isinstance(texts, list) or not texts or not all(isinstance(one, str) for one in texts):
            raise MappingError(f"{file}: {name}.{field} is {quoted(source)}, expected a column, or a list of columns")
        for text in filter(None, texts) if any(texts) and len(texts) > 1 else texts:
            try:
                _evaluated(text, log.series[topic])
            except MappingError as error:
                raise MappingError(f"{file}: {name}.{field}: {error}") from None
        sources[field] = source if isinstance(source, str) else tuple(source)
    if not sources:
        raise MappingError(
            f'{file}: [{name}] has no field: write NAME = "COLUMN"; its fields are {", ".join(probe.fields[name])}'
        )
    return Link(name, topic, sources, kinds[name] == "actuator", str(file))
