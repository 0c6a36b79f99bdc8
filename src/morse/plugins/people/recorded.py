"""Recorded trajectories: people who walk as others have walked, from the files in which data sets are published.

Files:

* ``obsmat.txt`` of ETH (S. Pellegrini et al., You'll never walk alone, ICCV 2009): rows of eight numbers, frame, number
  of the person, x, z, y, and their velocities;
* the rows of four numbers into which ETH and UCY (A. Lerner et al., Crowds by example, 2007) are usually converted:
  frame, number of the person, x, y, in m;
* those of PeTrack and JuPedSim: number of the person, frame, x, y and perhaps z, in m, after lines of comments with
  ``framerate: 25`` and ``id frame x y z``;
* TrajNet++ (P. Kothari et al., 2021): a JSON object in each line, ``{"track": {"f": 10, "p": 3, "x": 1.5, "y": 2.0}}``
  and ``{"scene": {..., "fps": 2.5}}``;
* CSV with a first line of names: ``id``, ``x``, ``y``, and ``time`` (s) or ``frame``.
"""

from __future__ import annotations

import csv
import json
import math
import re
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

#: most bytes, points and people of a file
_MOST_BYTES, _MOST_POINTS, _MOST_PEOPLE = 50_000_000, 500_000, 5000
#: s between two frames with annotations, of ETH, UCY and TrajNet
_STEP = 0.4
#: s, the least time between two points of a person, and the latest time
_SHORTEST, _LATEST = 1e-6, 1e9
#: least and most frames in a second
_LEAST_RATE, _MOST_RATE = 1e-3, 1e6
#: m; m/s: no trajectory is that far from the origin, and nobody walks that fast
_FAR, FASTEST = 1e4, 15.0


class TrajectoryError(ValueError):
    """A file with no trajectories of people."""


def read(data: bytes, name: str, rate: float | None = None) -> list[list[list[float]]]:
    """Return the trajectory of each person: its points (time, x, y), s and m, from 0 s for the first one.

    Args:
        data: of the file.
        name: of the file, for messages.
        rate: frames in a second; None for what the file says, or else for rows 0.4 s apart.

    Raises:
        TrajectoryError: the file is too large, or is none of these.
    """
    if len(data) > _MOST_BYTES:
        raise TrajectoryError(f"{name} has {len(data)} bytes: at most {_MOST_BYTES}")
    try:
        lines = [line.strip() for line in data.decode("utf-8-sig").splitlines()]
    except UnicodeDecodeError as error:
        raise TrajectoryError(f"{name} is no text: {error}") from None
    numbered = [(number, line) for number, line in enumerate(lines, 1) if line and not line.startswith("#")]
    if not numbered:
        raise TrajectoryError(f"{name} has no trajectories")
    if numbered[0][1].startswith("{"):
        rows, given, in_seconds = _ndjson(numbered, name)
    elif any(letter.isalpha() for letter in numbered[0][1].replace("e", "").replace("E", "")):
        rows, given, in_seconds = _csv(numbered, name)
    else:
        comments = " ".join(line for line in lines if line.startswith("#")).lower()
        said = re.search(r"framerate:?\s*([0-9.]{1,12})", comments)
        given = None if said is None or not said[1].replace(".", "", 1).isdigit() else float(said[1]) or None
        names = re.search(r"\b(id|frame)\b.*?\b(id|frame)\b", comments)
        rows, in_seconds = _matrix(numbered, name, first_is_id=names is not None and names[1] == "id"), False
    return _trajectories(rows, name, 1.0 if in_seconds else rate or given)


_Rows = list[tuple[int, float, int, float, float]]


def _ndjson(lines: Iterable[tuple[int, str]], name: str) -> tuple[_Rows, float | None, bool]:
    rows: _Rows = []
    per_second = rate = None
    for number, line in lines:
        try:
            entry = json.loads(line)
            track, scene = entry.get("track"), entry.get("scene")
            if track is not None:
                rows.append((number, float(track["f"]), int(track["p"]), float(track["x"]), float(track["y"])))
            elif scene is not None and "fps" in scene:
                # the rate of the rows, not that of the frames
                per_second = float(scene["fps"])
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError, ZeroDivisionError, OverflowError):
            raise TrajectoryError(
                f'{name}:{number}: expected {{"track": {{"f": 10, "p": 3, "x": 1.5, "y": 2.0}}}}, got {line[:80]!r}'
            ) from None
    if per_second is not None and (pace := _pace(rows)):
        rate = pace * per_second
    return rows, rate, False


def _csv(lines: list[tuple[int, str]], name: str) -> tuple[_Rows, float | None, bool]:
    head = [word.strip().lower() for word in _words(lines[0], name)]
    times = [word for word in ("time", "t", "frame") if word in head]
    if not times or not {"id", "x", "y"} <= set(head):
        raise TrajectoryError(
            f"{name}:{lines[0][0]}: expected the columns id, x, y, and time or frame, got {head!r:.80}"
        )
    places = [head.index(word) for word in (times[0], "id", "x", "y")]
    rows: _Rows = []
    for number, line in lines[1:]:
        words = _words((number, line), name)
        try:
            time, person, x, y = (float(words[place]) for place in places)
            rows.append((number, time, int(person), x, y))
        except (ValueError, IndexError, OverflowError):
            raise TrajectoryError(f"{name}:{number}: expected {', '.join(head)[:80]}, got {line[:80]!r}") from None
    return rows, None, times[0] != "frame"


def _words(line: tuple[int, str], name: str) -> list[str]:
    try:
        return next(csv.reader([line[1]]))
    except csv.Error as error:
        raise TrajectoryError(f"{name}:{line[0]}: {error}") from None


def _matrix(lines: Iterable[tuple[int, str]], name: str, *, first_is_id: bool) -> _Rows:
    rows: _Rows = []
    for number, line in lines:
        try:
            values = [float(word) for word in line.replace(",", " ").replace(";", " ").split()]
            if len(values) not in (4, 5, 8):
                raise ValueError
            x, y = (values[2], values[4]) if len(values) == 8 else values[2:4]
            person, frame = values[:2] if first_is_id else values[1::-1]
            rows.append((number, frame, int(person), x, y))
        except (ValueError, OverflowError):
            raise TrajectoryError(
                f"{name}:{number}: expected 'frame id x y', or the eight numbers of an obsmat.txt, got {line[:80]!r}"
            ) from None
    return rows


def _pace(rows: _Rows) -> float | None:
    """The number of frames between two rows of a person."""
    frames = np.unique(np.array([row[1] for row in rows]))
    steps = np.diff(frames)
    return float(steps.min()) if len(steps) else None


def _trajectories(rows: _Rows, name: str, rate: float | None) -> list[list[list[float]]]:
    if len(rows) > _MOST_POINTS:
        raise TrajectoryError(f"{name} has {len(rows)} points: at most {_MOST_POINTS}")
    people: dict[int, dict[float, tuple[float, float, int]]] = {}
    for number, time, person, x, y in rows:
        if not all(map(math.isfinite, (time, x, y))) or max(abs(x), abs(y)) > _FAR or abs(time) > 1e9:
            raise TrajectoryError(f"{name}:{number}: ({x}, {y}) at {time} is no place of a person")
        people.setdefault(person, {})[time] = (x, y, number)
    if len(people) > _MOST_PEOPLE:
        raise TrajectoryError(f"{name} has {len(people)} people: at most {_MOST_PEOPLE}")
    if rate is None:
        rate = (_pace(rows) or 1.0) / _STEP
    if not _LEAST_RATE <= rate <= _MOST_RATE:
        raise TrajectoryError(f"{name}: {rate:g} frames in a second: expected {_LEAST_RATE:g} to {_MOST_RATE:g}")
    begin = min((row[1] for row in rows), default=0.0)
    found = []
    for points in people.values():
        track = [[(time - begin) / rate, *points[time][:2]] for time in sorted(points)]
        for (s, x, y), (t, u, v), time in zip(track, track[1:], sorted(points)[1:], strict=False):
            if t - s < _SHORTEST or t >= _LATEST:
                raise TrajectoryError(
                    f"{name}:{points[time][2]}: a point at {t:g} s, {t - s:g} s after the one before: is the rate "
                    f"{rate:g} frames in a second?"
                )
            if math.hypot(u - x, v - y) > FASTEST * (t - s) + 1e-9:
                speed = math.hypot(u - x, v - y) / (t - s)
                raise TrajectoryError(
                    f"{name}:{points[time][2]}: somebody walks at {speed:.4g} m/s: are the places in m, and is the "
                    f"rate {rate:g} frames in a second?"
                )
        if len(track) > 1:
            found.append(track)
    if not found:
        raise TrajectoryError(f"{name} has nobody with two points")
    return found


class Moment(NamedTuple):
    """Recorded people at one time: who is present (N,), position (N, 2), m."""

    present: NDArray[np.bool_]
    position: Floats


class Tracks:
    """Trajectories through all their points, with continuous velocities (cubic Hermite splines).

    Args:
        tracks: for each person, the points (time, x, y), with times that increase.
        repeat: s, after which they begin again; 0 for never.
    """

    def __init__(self, tracks: list[list[list[float]]], repeat: float = 0.0) -> None:
        sizes = [len(track) for track in tracks]
        self._first = np.concatenate([[0], np.cumsum(sizes)[:-1]]).astype(np.intp)
        self._last = self._first + np.array(sizes, dtype=np.intp) - 1
        every = np.concatenate([np.array(track, dtype=np.float64).reshape(-1, 3) for track in tracks])
        self._time, self._place = every[:, 0], every[:, 1:]
        self._slope = np.concatenate([_slopes(np.array(track, dtype=np.float64)) for track in tracks])
        self._repeat = repeat
        #: corners of what the trajectories cover, m
        self.low, self.high = self._place.min(axis=0), self._place.max(axis=0)

    def at(self, time: float) -> Moment:
        """Return where everybody is at a time, s; those who are absent are at the nearest end of their trajectory."""
        if self._repeat > 0.0:
            time = math.fmod(time, self._repeat)
        begin, end = self._time[self._first], self._time[self._last]
        row = self._first.copy()
        # the row before this time, by bisection of all trajectories at once
        low, high = self._first.copy(), self._last.copy()
        while (high - low > 1).any():
            middle = (low + high) // 2
            later, more = self._time[middle] <= time, high - low > 1
            low, high = np.where(more & later, middle, low), np.where(more & ~later, middle, high)
        row = low
        span = self._time[high] - self._time[row]
        s = np.clip((time - self._time[row]) / span, 0.0, 1.0)[:, None]
        h = span[:, None]
        a, b, u, v = self._place[row], self._place[high], self._slope[row], self._slope[high]
        position = (2.0 * s - 3.0) * s * s * (a - b) + a + ((s - 2.0) * s + 1.0) * s * h * u + (s - 1.0) * s * s * h * v
        return Moment((begin <= time) & (time <= end), position)


def _slopes(track: Floats) -> Floats:
    """Return the velocities (P, 2) at the points of a trajectory: through the points before and after."""
    step = np.diff(track[:, 1:], axis=0) / np.diff(track[:, 0])[:, None]
    return np.concatenate([step[:1], 0.5 * (step[1:] + step[:-1]), step[-1:]])


def checked(plan: Mapping[str, object]) -> Tracks | None:
    """Return the trajectories of a plan that a script has written; None if it has none.

    Raises:
        ValueError: they are not those of `read`.
    """
    tracks = plan.get("tracks")
    if not tracks:
        return None
    try:
        arrays = [np.array(track, dtype=np.float64) for track in tracks]  # type: ignore[attr-defined]
        repeat = float(plan.get("repeat") or 0.0)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise ValueError("the trajectories are no lists of (time, x, y)") from None
    for track in arrays:
        if track.ndim != 2 or track.shape[1] != 3 or len(track) < 2 or not (np.abs(track) < 1e9).all():
            raise ValueError("the trajectories are no lists of (time, x, y)")
        if not (np.diff(track[:, 0]) > 0.0).all():
            raise ValueError("the times of a trajectory increase")
    return Tracks([track.tolist() for track in arrays], repeat if repeat > 0.0 else 0.0)
