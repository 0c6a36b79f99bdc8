"""Trajectories of joints: points in time, and interpolation between them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from morse.core.reports.quoting import nearest, shown
from morse.core.validation.spec import Spec

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.values import Fields


_TOLERATED = ("position", "velocity")
_WIDEST = 1e9


class Bound(NamedTuple):
    """The tolerance of a joint; `math.inf` for any error.

    Attributes:
        position: rad or m.
        velocity: rad/s or m/s.
    """

    position: float = math.inf
    velocity: float = math.inf


class Tolerances(NamedTuple):
    """The tolerances of a trajectory, by joint; joints without an entry have none.

    Attributes:
        path: while the joints follow the path.
        goal: at the end of the path.
        late: time after the end within which the joints have to be at the goal, s.
    """

    path: dict[str, Bound]
    goal: dict[str, Bound]
    late: float = math.inf


def bounds_of(entry: object, names: Sequence[str], key: str) -> dict[str, Bound]:
    """Parse tolerances: a number for the positions of all joints, or names to numbers or ``{"position": rad or m,
    "velocity": rad/s or m/s}``.

    Raises:
        ValueError: they are invalid; the message contains the expected format.
    """
    if entry is None:
        return {}
    if isinstance(entry, (int, float)) and not isinstance(entry, bool):
        return dict.fromkeys(names, Bound(_tolerance(entry, f"'{key}'")))
    if not isinstance(entry, dict):
        raise ValueError(f"'{key}' is {shown(entry)}, expected a number, or an object: name of a joint to a number")
    bounds = {}
    for name, value in entry.items():
        if name not in names:
            raise ValueError(f"'{key}' has no joint {shown(name)}{nearest(str(name), names)}")
        where = f"'{key}' of '{name}'"
        if not isinstance(value, dict):
            bounds[name] = Bound(_tolerance(value, where))
            continue
        for quantity in value:
            if quantity not in _TOLERATED:
                raise ValueError(f"{where} has {shown(quantity)}, expected {' and '.join(_TOLERATED)}")
        bounds[name] = Bound(**{quantity: _tolerance(one, where) for quantity, one in value.items()})
    return bounds


def _tolerance(value: object, where: str) -> float:
    try:
        return float(Spec("number", low=0.0, high=_WIDEST).check()(value))
    except ValueError as error:
        raise ValueError(f"{where} is {shown(value)}, expected {error}") from None


def beyond(
    bounds: dict[str, Bound], errors: dict[str, float], speeds: dict[str, float] | None
) -> tuple[str, str, float, float] | None:
    """Return the first joint outside of its bound: name, quantity, error and tolerance; None if there is none.

    Args:
        bounds: joints to tolerances.
        errors: errors of positions, rad or m.
        speeds: errors of velocities, rad/s or m/s; None if they are not known.
    """
    for name, bound in bounds.items():
        if abs(errors[name]) > bound.position:
            return name, "position", abs(errors[name]), bound.position
        if speeds is not None and abs(speeds[name]) > bound.velocity:
            return name, "velocity", abs(speeds[name]), bound.velocity
    return None


_MOST_POINTS = 100_000
_FARTHEST, _LONGEST = 1e6, 1e9
_QUANTITIES = ("velocities", "accelerations")
_KEYS = ("starttime", "joints", "points", "path_tolerance", "goal_tolerance", "goal_time_tolerance")


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


class Plan(NamedTuple):
    """A trajectory that a client wants.

    Attributes:
        joints: names of the joints, in the order of the numbers of the points.
        points: in the order of their times; at least one.
        start: simulated time, s; None for now.
        tolerances: largest distances from the path and from its end.
    """

    joints: tuple[str, ...]
    points: list[Point]
    start: float | None
    tolerances: Tolerances


def plan_of(trajectory: Fields, names: Sequence[str]) -> Plan:
    """Parse a trajectory of a client.

    Args:
        trajectory: ``{"starttime": s, "joints": [...], "points": [{"positions": [...], "velocities": [...],
            "accelerations": [...], "time_from_start": s}, ...], "path_tolerance": {...}, "goal_tolerance": {...},
            "goal_time_tolerance": s}``; only ``points`` with their positions and times are required.
        names: names of the joints, in the order of the numbers unless the trajectory has ``joints``.

    Raises:
        ValueError: the trajectory is invalid; the message contains the expected format.
    """
    for key in trajectory:
        if key not in _KEYS:
            raise ValueError(f"a trajectory has {', '.join(_KEYS)}, not {shown(str(key))}{nearest(str(key), _KEYS)}")
    start = trajectory.get("starttime")
    if start is not None:
        start = _number(start, "'starttime'", -_LONGEST)
    joints = _joints(trajectory.get("joints"), names)
    entries = trajectory.get("points")
    if not isinstance(entries, (list, tuple)) or not 0 < len(entries) <= _MOST_POINTS:
        raise ValueError(f"'points' is {shown(entries)}, expected a list of 1 to {_MOST_POINTS} points")
    points: list[Point] = []
    for index, point in enumerate(entries):
        points.append(_point(point, joints, f"points[{index}]"))
        if index and points[-1].time <= points[-2].time:
            raise ValueError(
                f"'time_from_start' of points[{index}] is {points[-1].time:g}, expected a larger value than that of "
                f"the previous point, {points[-2].time:g}"
            )
    path, goal = (bounds_of(trajectory.get(key), joints, key) for key in ("path_tolerance", "goal_tolerance"))
    patience = trajectory.get("goal_time_tolerance")
    late = math.inf if patience is None else _number(patience, "'goal_time_tolerance'", 0.0)
    return Plan(joints, points, start, Tolerances(path, goal, late))


def _joints(joints: object, names: Sequence[str]) -> tuple[str, ...]:
    if joints is None:
        return tuple(names)
    if not isinstance(joints, (list, tuple)) or not joints:
        raise ValueError(f"'joints' is {shown(joints)}, expected a list of names of joints: {', '.join(names)}")
    for index, name in enumerate(joints):
        if name not in names:
            raise ValueError(f"there is no joint {shown(name)}{nearest(str(name), names)}")
        if name in joints[:index]:
            raise ValueError(f"the joint {shown(name)} is named twice")
    return tuple(joints)


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
        plan: the joints and the points; points in the past are left out.
        now: the present simulated time, s.
        positions: the present positions of the joints.

    Attributes:
        joints: the names of the joints.
        start: simulated time of the first point, s.
        tolerances: largest distances from the path and from its end.
    """

    def __init__(self, plan: Plan, now: float, positions: Sequence[float]) -> None:
        rest = (0.0,) * len(positions)
        start = now if plan.start is None else plan.start
        late = max(now - start, 0.0)
        points = [point._replace(time=point.time - late) for point in plan.points if point.time > late]
        points = points or [plan.points[-1]._replace(time=0.0)]
        self.joints, self.tolerances = plan.joints, plan.tolerances
        self.start = max(now, start)
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
        return between(*self._ends(elapsed), max(elapsed, 0.0))[0]

    def velocities(self, time: float) -> tuple[float, ...]:
        """The velocities of the targets at a simulated time; 0 before the start and after the end."""
        elapsed = time - self.start
        if not 0.0 <= elapsed < self.points[-1].time:
            return (0.0,) * len(self.points[-1].positions)
        return between(*self._ends(elapsed), elapsed)[1]

    def _ends(self, elapsed: float) -> tuple[Point, Point]:
        """The points before and after a time."""
        # time only decreases when a state is restored, and a state contains the position in the list
        while self.points[self._reached + 1].time <= elapsed:
            self._reached += 1
        return self.points[self._reached], self.points[self._reached + 1]


def between(before: Point, after: Point, time: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Positions and velocities between two points; see `Trajectory`."""
    whole = after.time - before.time
    s = (time - before.time) / whole
    positions, velocities = [], []
    for i, (p, q) in enumerate(zip(before.positions, after.positions, strict=True)):
        a = b = c3 = c4 = c5 = 0.0
        if before.velocities is None or after.velocities is None:
            v = q - p
        elif before.accelerations is None or after.accelerations is None:
            v, w = before.velocities[i] * whole, after.velocities[i] * whole
            a, c3 = 2.0 * (3.0 * (q - p) - 2.0 * v - w), 2.0 * (p - q) + v + w
        else:
            v, w = before.velocities[i] * whole, after.velocities[i] * whole
            a, b = before.accelerations[i] * whole * whole, after.accelerations[i] * whole * whole
            c3 = 10.0 * (q - p) - 6.0 * v - 4.0 * w - 1.5 * a + 0.5 * b
            c4 = 15.0 * (p - q) + 8.0 * v + 7.0 * w + 1.5 * a - b
            c5 = 6.0 * (q - p) - 3.0 * v - 3.0 * w - 0.5 * a + 0.5 * b
        positions.append(p + s * (v + s * (0.5 * a + s * (c3 + s * (c4 + s * c5)))))
        velocities.append((v + s * (a + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)))) / whole)
    return tuple(positions), tuple(velocities)
