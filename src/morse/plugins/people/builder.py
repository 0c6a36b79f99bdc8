"""The class of crowds in scene scripts."""

from __future__ import annotations

import json
import math
from itertools import islice, pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from morse.assets.search import find_file
from morse.builder.components.robot import Robot
from morse.builder.errors import checks
from morse.builder.names.frames import source_line
from morse.builder.robots import Human
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

#: most people of a crowd
_MOST = 5000
#: m^2 that a standing person needs: 6 people on 1 m^2
_ROOM = 1.0 / 6.0
#: m between two floors, at least
_STOREY = 2.0
_MODELS = ("social-force", "orca")
_ENDS = ("leave", "stay", "repeat", "queue", "sit")
#: m; an area is at most that far from the origin
_FAR = 1e5


class Crowd(Robot):
    """People who walk.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        count: number of people, 1 to 5,000.
        model: ``social-force`` or ``orca``, see `morse.plugins.people.walking`.
        speed, deviation: mean and standard deviation of the free speeds, m/s, which follow from the seed of the run.
            They are cut at two deviations.
        radius: of a body seen from above, m.
        children, wheelchairs: shares of the people, 0 to 1.
        groups: share of the people who walk in groups of 2 to 4.
        recorded: file with trajectories, see `morse.plugins.people.recorded`; the people are those of the file, and
            walk as they have walked, whatever is in their way.
        rate: frames in a second of that file; None for what the file says, or else for rows 0.4 s apart.
        repeat: s, after which the trajectories begin again; 0 for never.
        floors: heights of the floors on which people walk, above the position of the crowd, m; the first one is 0.
            Lifts of the scene that stop on them carry people between them. Goals and areas on another floor than the
            first one have points with three coordinates.

    Raises:
        ValueError: a number is out of its range.
    """

    _classpath = "morse.plugins.people.robots.crowd.Crowd"

    def __init__(
        self,
        name: str | None = None,
        count: int = 20,
        *,
        model: str = "social-force",
        speed: float = 1.34,
        deviation: float = 0.26,
        radius: float = 0.2,
        children: float = 0.0,
        wheelchairs: float = 0.0,
        groups: float = 0.0,
        recorded: str | None = None,
        rate: float | None = None,
        repeat: float = 0.0,
        floors: Iterable[float] = (0.0,),
    ) -> None:
        # `from morse.builder import *` loads no numpy
        import numpy as np

        from morse.plugins.people.figures import person as figure

        number = checks.integer(count, "Crowd(count)", minimum=1)
        if number > _MOST:
            raise ValueError(f"Crowd(count) takes at most {_MOST} people, got {number}")
        shares = {"children": children, "wheelchairs": wheelchairs}
        kinds = {key: checks.share(value, f"Crowd({key})") for key, value in shares.items()}
        if sum(kinds.values()) > 1.0:
            raise ValueError(
                f"Crowd(children, wheelchairs) are shares of one crowd, got {sum(kinds.values()):g} together"
            )
        values = {
            "Model": checks.choice(model, _MODELS, "Crowd(model)"),
            "Speed": checks.number(speed, "Crowd(speed)", above=0.0, maximum=10.0),
            "Deviation": checks.number(deviation, "Crowd(deviation)", minimum=0.0, maximum=3.0),
            "Radius": checks.number(radius, "Crowd(radius)", minimum=0.1, maximum=1.0),
            "Groups": checks.share(groups, "Crowd(groups)"),
        }
        heights_of_floors = _floors(floors)
        super().__init__("", name)
        self._tracks: list[list[list[float]]] = []
        self._repeat = checks.number(repeat, "Crowd(repeat)", minimum=0.0, maximum=1e6)
        if recorded is not None:
            if rate is not None:
                rate = checks.number(rate, "Crowd(rate)", above=0.0, maximum=1000.0)
            self._tracks = self._read(recorded, rate)
            number = len(self._tracks)
        self.count = number
        self._flows: list[dict[str, Any]] = []
        self._attention: dict[str, float] = {}
        self._watched: list[tuple[Any, float]] = []
        self._members: list[tuple[Any, dict[str, Any]]] = []
        node = self.scene_node
        node.properties.update(values)
        node.properties["Floors"] = json.dumps(heights_of_floors)
        rides, small = round(kinds["wheelchairs"] * number), round(kinds["children"] * number)
        heights = []
        for person in range(number):
            # the same people for the same script: their places and speeds follow from the seed of the run
            shape = np.random.Generator(np.random.PCG64([person, number])).random(2).tolist()
            is_child = rides <= person < rides + small
            height = 1.0 + 0.45 * shape[0] if is_child else 1.55 + 0.35 * shape[0]
            heights.append(round(height, 3))
            look = int(shape[1] * 997)
            node.attach(figure(f"{name or 'person'} {person}", height, look, rides=person < rides))
        node.properties["Heights"] = json.dumps(heights)
        node.properties["Rides"] = rides
        self._tell()

    def _read(self, path: str, rate: float | None) -> list[list[list[float]]]:
        from morse.plugins.people.recorded import TrajectoryError, read

        where = source_line(self)
        try:
            file = find_file(str(path), *([Path(where.file).parent] if where else []))
            return read(read_regular(file), file.name, rate)
        except (OSError, TrajectoryError) as error:
            raise ValueError(f"Crowd(recorded): {error}") from None

    def start(
        self,
        area: Iterable[Sequence[float]] | None = None,
        count: int | None = None,
        *,
        places: Iterable[Sequence[float]] | None = None,
        goals: Iterable[object] | None = None,
        then: str | Iterable[object] = "stay",
        wait: float = 0.0,
        over: float = 0.0,
    ) -> None:
        """Let people begin in an area, at places that follow from the seed, without overlaps.

        Several calls let people begin in several areas, in the order of the calls.

        Args:
            area: corners (V, 2) of a polygon, m; a rectangle may be given by two opposite corners. On other floors,
                (V, 3) with the height of the floor in the world, m.
            count: number of people; None for those that no other call has.
            places: exact places (x, y) or (x, y, z) in place of an area, one for each person, on one floor.
            goals: their own goals, see `goals`.
            then: see `goals`.
            wait: see `goals`.
            over: s, in which they enter one after the other; 0 for all at the start.

        Raises:
            ValueError: the area is no polygon, or smaller than the people; or two people would stand at one place.
        """
        what = "Crowd.start"
        if self._tracks:
            raise TypeError(f"{what}: recorded people begin where their trajectories begin")
        if (area is None) == (places is None):
            raise TypeError(f"{what} takes an area or places")
        exact = [] if places is None else self._exact(places, f"{what}(places)")
        if places is not None and (count is not None or over):
            raise TypeError(f"{what}(places) has one person at each place: leave out count and over")
        polygon = exact or _polygon(area, f"{what}(area)")
        if exact:
            count = len(exact)
        taken = sum(flow["count"] for flow in self._flows if flow["count"] is not None)
        if count is not None:
            count = checks.integer(count, f"{what}(count)", minimum=1)
        most = count if count is not None else self.count - taken
        if taken + (count or 0) > self.count or most < 1:
            raise ValueError(f"{what}(count): the crowd has {self.count} people, of whom {taken} begin elsewhere")
        entry = checks.number(over, f"{what}(over)", minimum=0.0, maximum=1e6)
        size = _size(polygon)
        if not entry and not exact and most * _ROOM > size:
            raise ValueError(
                f"{what}(area): {most} people do not fit into {size:.3g} m²: at most {int(size / _ROOM)}; give a "
                "larger area, fewer people, or over=SECONDS to let them enter one after the other"
            )
        flow: dict[str, Any] = {"area": polygon, "count": count, "over": entry, "exact": bool(exact), "goals": None}
        if goals is not None:
            flow.update(_plan(goals, then, wait, what))
        self._flows.append(flow)
        self._tell()

    def _exact(self, places: Iterable[Sequence[float]], what: str) -> list[list[float]]:
        points = [_point(point, what) for point in _listed(places, what)]
        least = 2.0 * float(self.scene_node.properties["Radius"])  # type: ignore[arg-type]
        before: dict[tuple[int, int], list[list[float]]] = {}
        for x, y, *height in points:
            cell = (math.floor(x / least), math.floor(y / least))
            near = [one for i in (-1, 0, 1) for j in (-1, 0, 1) for one in before.get((cell[0] + i, cell[1] + j), ())]
            for u, v, *_ in near:
                if math.hypot(x - u, y - v) < least:
                    raise ValueError(f"{what}: ({x:g}, {y:g}) and ({u:g}, {v:g}) overlap: bodies are {least:g} m broad")
            before.setdefault(cell, []).append([x, y, *height])
        return points

    def goals(self, goals: Iterable[object], then: str | Iterable[object] = "stay", wait: float = 0.0) -> None:
        """Set the goals of all people whose `start` has none; each person goes to one after the other.

        Args:
            goals: points (x, y), areas (lists of three or more points), or names of objects of the world. Points on
                other floors than the first one are (x, y, z), with the height of the floor in the world, m.
            then: after the last one: ``stay`` there, ``leave`` the world, or ``repeat`` from the first one. ``queue``:
                the last goal is a counter, in front of which they stand in line; each takes ``wait`` seconds there,
                goes back to where people begin, and leaves. ``sit``: the goals are seats; each person sits on one, for
                ``wait`` seconds or for ever if it is 0, goes back and leaves. A list of ``(time, goals)`` or
                ``(time, goals, then)`` is a schedule: they have other goals from these times, s, on.
            wait: s, at each goal.

        Raises:
            ValueError: a goal is none of these.
        """
        self._default = _plan(goals, then, wait, "Crowd.goals")
        self._tell()

    def joins(
        self,
        human: Any,
        goals: Iterable[object] | None = None,
        then: str | Iterable[object] = "stay",
        wait: float = 0.0,
        *,
        joined: bool = True,
    ) -> None:
        """Let a `Human` walk with the crowd from where it stands: it avoids the others, and they avoid it.

        Its own actuators have no effect meanwhile. The services ``leave`` and ``join`` change that in the simulation.

        Args:
            human: a `Human`, or its name.
            goals: its own goals, see `goals`; None for those of the people who have none of their own.
            then: see `goals`.
            wait: see `goals`.
            joined: whether it walks with the crowd from the beginning.

        Raises:
            TypeError: it is no `Human`, or the people follow recorded trajectories.
        """
        what = "Crowd.joins"
        if self._tracks:
            raise TypeError(f"{what}: recorded people walk as they have walked, with nobody else")
        if not isinstance(human, str | Human):
            raise TypeError(f"{what}(human) takes a Human or its name, got {checks.shown(human)}")
        own: dict[str, Any] = {"goals": None} if goals is None else _plan(goals, then, wait, what)
        self._members.append((human, own | {"joins": checks.boolean(joined, f"{what}(joined)")}))

    def avoids(self, robot: Any, attention: float = 1.0) -> None:
        """Set which share of the people sees a robot; all see the robots that are not named.

        Args:
            robot: the robot, or its name.
            attention: 0 to 1.
        """
        if not isinstance(robot, str) and not getattr(robot, "is_robot", False):
            raise TypeError(f"Crowd.avoids(robot) takes a robot or its name, got {checks.shown(robot)}")
        self._watched.append((robot, checks.share(attention, "Crowd.avoids(attention)")))
        self._tell()

    _default: dict[str, Any] | None = None

    def _tell(self) -> None:
        """Write the plan into the properties of the scene, where the component finds it."""
        plan: dict[str, object] = {"flows": self._flows, "default": self._default}
        if self._tracks:
            plan |= {"tracks": self._tracks, "repeat": self._repeat}
        plan["members"] = [
            {"robot": one if isinstance(one, str) else str(one.name), **own} for one, own in self._members
        ]
        self.scene_node.properties["Plan"] = json.dumps(plan)

    def _declaration(self, robot: Any) -> Any:
        # robots have their names only now
        names = {one if isinstance(one, str) else str(one.name): share for one, share in self._watched}
        self.scene_node.properties["Attention"] = json.dumps(names)
        if self._members:
            self._tell()
        return super()._declaration(robot)


def _listed(values: Any, what: str) -> list[Any]:
    if not hasattr(values, "__iter__") or isinstance(values, str):
        raise TypeError(f"{what} takes a list of points, got {checks.shown(values)}")
    items = list(values)
    if not items:
        raise ValueError(f"{what} takes at least one point")
    return items


def _plan(goals: Iterable[object], then: str | Iterable[object], wait: float, what: str) -> dict[str, Any]:
    if isinstance(goals, str) or not hasattr(goals, "__iter__"):
        raise TypeError(f"{what}(goals) takes a list of points, areas or names, got {checks.shown(goals)}")
    found = [_goal(one, f"{what}(goals)") for one in goals]
    if not found:
        raise ValueError(f"{what}(goals) takes at least one goal")
    pause = checks.number(wait, f"{what}(wait)", minimum=0.0, maximum=1e6)
    if isinstance(then, str):
        return {"goals": found, "then": checks.choice(then, _ENDS, f"{what}(then)"), "wait": pause}
    if not hasattr(then, "__iter__"):
        raise TypeError(f"{what}(then) takes {', '.join(_ENDS)} or a list of (time, goals), got {checks.shown(then)}")
    later = _schedule(then, what, lambda places, end: _plan(places, end, wait, what))
    return {"goals": found, "then": "stay", "wait": pause, "later": later}


def _goal(goal: object, what: str) -> object:
    if isinstance(goal, str):
        return checks.text(goal, what)
    name = getattr(goal, "name", None)
    if isinstance(name, str):
        return name
    try:
        items = list(goal)  # type: ignore[call-overload]
    except TypeError:
        raise TypeError(f"{what} takes points (x, y), areas or names, got {checks.shown(goal)}") from None
    if len(items) in (2, 3) and not hasattr(items[0], "__iter__"):
        return _point(items, what)
    return _polygon(items, what)


def _point(point: Any, what: str) -> list[float]:
    values = list(islice(point, 4)) if hasattr(point, "__iter__") and not isinstance(point, str) else []
    if len(values) not in (2, 3):
        raise ValueError(f"{what} takes points (x, y), or (x, y, z) on other floors, got {checks.shown(point)}")
    place = [checks.number(value, what) for value in values]
    if max(abs(one) for one in place) > _FAR:
        raise ValueError(f"{what} takes points up to {_FAR:g} m from the origin, got {checks.shown(point)}")
    return place


def _polygon(area: Any, what: str) -> list[list[float]]:
    if not hasattr(area, "__iter__") or isinstance(area, str):
        raise TypeError(f"{what} takes the corners of a polygon, got {checks.shown(area)}")
    points = [_point(point, what) for point in area]
    if len(points) == 2 and len(points[0]) == len(points[1]):
        (a, b, *height), (c, d, *_) = points
        points = [[a, b, *height], [c, b, *height], [c, d, *height], [a, d, *height]]
    if len({tuple(one[2:]) for one in points}) != 1:
        raise ValueError(f"{what} is on one floor: all its points have the same height, got {checks.shown(area)}")
    if len(points) < 3 or len(points) > 1000:
        raise ValueError(f"{what} takes 2 opposite or at least 3 corners, got {len(points)}")
    if not _size(points) > 1e-3:
        raise ValueError(f"{what}: the polygon has no area: {checks.shown(area)}")
    return points


def _size(points: Sequence[Sequence[float]]) -> float:
    total = 0.0
    for (x, y, *_), (u, v, *_) in zip(points, [*points[1:], points[0]], strict=True):
        total += x * v - u * y
    return math.fabs(total) / 2.0


def _floors(heights: Iterable[float]) -> list[float]:
    # `from morse.builder import *` loads no numpy
    from morse.plugins.people.floors import MOST_FLOORS

    what = "Crowd(floors)"
    if not hasattr(heights, "__iter__") or isinstance(heights, str):
        raise TypeError(f"{what} takes heights such as (0.0, 3.5), got {checks.shown(heights)}")
    found = [checks.number(one, what, minimum=-_FAR, maximum=_FAR) for one in islice(heights, MOST_FLOORS + 1)]
    if not 1 <= len(found) <= MOST_FLOORS or found[0] != 0.0:
        raise ValueError(f"{what} takes 1 to {MOST_FLOORS} heights of which the first is 0, got {found[:5]}")
    if any(upper - lower < _STOREY for lower, upper in pairwise(sorted(found))):
        raise ValueError(f"{what}: floors are at least {_STOREY:g} m above each other, got {found}")
    return found


def _schedule(entries: Iterable[object], what: str, plan: Callable[[Any, str], dict[str, Any]]) -> list[Any]:
    """Return the entries of a schedule: (time, goals) or (time, goals, then), with times that increase.

    Raises:
        ValueError: an entry is none of these.
    """
    found: list[dict[str, Any]] = []
    for entry in entries:
        items = list(entry) if isinstance(entry, tuple | list) else []
        if len(items) not in (2, 3) or (len(items) == 3 and not isinstance(items[2], str)):
            raise ValueError(
                f"{what}(then) takes entries (time, goals) or (time, goals, then), got {checks.shown(entry)}"
            )
        at = checks.number(items[0], f"{what}(then)", minimum=0.0, maximum=1e6)
        if found and at <= found[-1]["at"]:
            raise ValueError(f"{what}(then): the times of a schedule increase, got {at:g} after {found[-1]['at']:g}")
        found.append({"at": at, **plan(items[1], items[2] if len(items) == 3 else "stay")})
    if not found:
        raise ValueError(f"{what}(then) takes at least one entry (time, goals)")
    return found
