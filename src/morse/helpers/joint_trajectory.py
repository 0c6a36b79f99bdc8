"""Trajectories of joints: points in time, and interpolation between them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from morse.core.reports.quoting import shown
from morse.core.validation.spec import Spec

if TYPE_CHECKING:
    from collections.abc import Sequence

_MOST_POINTS = 100_000
_FARTHEST, _LONGEST = 1e6, 1e9
_QUANTITIES = ("velocities", "accelerations")


class Point(NamedTuple):
    """The joints at a point in time.

    Attributes:
        time: seconds after the start.
        positions: rad or m, one for each joint.
        velocities: rad/s or m/s; None if not given.
        accelerations: rad/s^2 or m/s^2; None if not given.
    """

    time: float
    positions: tuple[float, ...]
    velocities: tuple[float, ...] | None = None
    accelerations: tuple[float, ...] | None = None


def points_of(trajectory: dict[str, Any], names: Sequence[str]) -> tuple[float | None, list[Point]]:
    """Parse the start time (simulated seconds, None for now) and the points of a trajectory of a client.

    Args:
        trajectory: ``{"starttime": s, "points": [{"positions": [...], "velocities": [...], "accelerations": [...],
            "time_from_start": s}, ...]}``; start time, velocities and accelerations are optional.
            names: names of the joints, in the order of the numbers.

    Raises:
        ValueError: the trajectory is invalid; the message contains the expected format.
    """
    unknown = set(trajectory) - {"starttime", "points"}
    if unknown:
        raise ValueError(f"a trajectory has 'starttime' and 'points', not {shown(sorted(map(str, unknown))[0])}")
    start = trajectory.get("starttime")
    if start is not None:
        start = _number(start, "'starttime'", -_LONGEST)
    entries = trajectory.get("points")
    if not isinstance(entries, (list, tuple)) or not 0 < len(entries) <= _MOST_POINTS:
        raise ValueError(f"'points' is {shown(entries)}, expected a list of 1 to {_MOST_POINTS} points")
    points: list[Point] = []
    for index, point in enumerate(entries):
        points.append(_point(point, names, f"points[{index}]"))
        if index and points[-1].time <= points[-2].time:
            raise ValueError(
                f"'time_from_start' of points[{index}] is {points[-1].time:g}, expected a larger value than that of "
                f"the previous point, {points[-2].time:g}"
            )
    return start, points


def _number(value: object, what: str, low: float) -> float:
    try:
        return float(Spec("number", low=low, high=_LONGEST).check()(value))
    except ValueError as error:
        raise ValueError(f"{what} is {shown(value)}, expected {error}") from None


def _point(entry: object, names: Sequence[str], where: str) -> Point:
    if not isinstance(entry, dict):
        raise ValueError(f"{where} is {shown(entry)}, expected an object with 'positions' and 'time_from_start'")
    if "time_from_start" not in entry:
        raise ValueError(f"{where} has no 'time_from_start'")
    time = _number(entry["time_from_start"], f"'time_from_start' of {where}", 0.0)
    positions = _numbers(entry.get("positions"), names, f"'positions' of {where}")
    others = [_numbers(entry[q], names, f"'{q}' of {where}") if entry.get(q) else None for q in _QUANTITIES]
    return Point(time, positions, *others)


def _numbers(values: object, names: Sequence[str], what: str) -> tuple[float, ...]:
    spec = Spec("list", (len(names),), low=-_FARTHEST, high=_FARTHEST)
    try:
        return tuple(float(value) for value in spec.check()(values))
    except ValueError:
        raise ValueError(f"{what} is {shown(values)}, expected {len(names)} numbers: {', '.join(names)}") from None


class Trajectory:
    """The path of the joints through points.

    Between two points with velocities and accelerations the path is a polynomial of degree 5, between two points with
    velocities a polynomial of degree 3, otherwise a straight line. At the beginning the joints are at rest.

    Args:
        start: start time, simulated seconds.
        points: points after the start, in the order of their times; at least one.
        positions: initial positions of the joints.
    """

    def __init__(self, start: float, points: Sequence[Point], positions: Sequence[float]) -> None:
        rest = (0.0,) * len(positions)
        self.start = start
        self.points = [Point(0.0, tuple(positions), rest, rest), *points]
        self._reached = 0

    @property
    def end(self) -> float:
        """Simulated time of the last point."""
        return self.start + self.points[-1].time

    def positions(self, time: float) -> tuple[float, ...]:
        """The target of the joints at a simulated time."""
        elapsed = time - self.start
        if elapsed >= self.points[-1].time:
            return self.points[-1].positions
        # time only decreases when a state is restored, and a state contains the position in the list
        while self.points[self._reached + 1].time <= elapsed:
            self._reached += 1
        before, after = self.points[self._reached : self._reached + 2]
        return between(before, after, max(elapsed, 0.0))


def between(before: Point, after: Point, time: float) -> tuple[float, ...]:
    """Positions between two points; see `Trajectory`."""
    whole = after.time - before.time
    s = (time - before.time) / whole
    result = []
    for i, (p, q) in enumerate(zip(before.positions, after.positions, strict=True)):
        if before.velocities is None or after.velocities is None:
            result.append(p + s * (q - p))
            continue
        v, w = before.velocities[i] * whole, after.velocities[i] * whole
        if before.accelerations is None or after.accelerations is None:
            result.append(p + s * (v + s * (3.0 * (q - p) - 2.0 * v - w + s * (2.0 * (p - q) + v + w))))
            continue
        a, b = before.accelerations[i] * whole * whole, after.accelerations[i] * whole * whole
        c3 = 10.0 * (q - p) - 6.0 * v - 4.0 * w - 1.5 * a + 0.5 * b
        c4 = 15.0 * (p - q) + 8.0 * v + 7.0 * w + 1.5 * a - b
        c5 = 6.0 * (q - p) - 3.0 * v - 3.0 * w - 0.5 * a + 0.5 * b
        result.append(p + s * (v + s * (0.5 * a + s * (c3 + s * (c4 + s * c5)))))
    return tuple(result)
