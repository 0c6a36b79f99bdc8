"""The class of traffic in scene scripts."""

from __future__ import annotations

import json
import math
from itertools import islice
from typing import TYPE_CHECKING, Any

from morse.builder.components.robot import Robot
from morse.builder.errors import checks

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from morse.builder.abstractcomponent import AbstractComponent
    from morse.builder.components.component import Component
    from morse.scene import ComponentDeclaration

_MOST_CARS, _MOST_ROADS, _MOST_POINTS, _MOST_ZEBRAS = 2000, 100, 1000, 200
_CAR, _TRUCK, _GAP = 4.6, 12.0, 2.0
#: rad, of a part of an arc
_ARC = 0.08


class Traffic(Robot):
    """Cars on lanes that follow each other, change lanes, and brake for robots, people and red lights.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        headway: time gap to the car ahead, s.
        acceleration, deceleration: of comfort, m/s².
        gap: between bumpers at rest, m.
        politeness: weight of what a change of lanes costs others, 0 to 1.
        bias: preference for the right lane, m/s².
        deviation: standard deviation of the desired speeds, as a share of the limit.
        trucks: share of the cars that are trucks, 12 m long.

    Raises:
        ValueError: a number is out of its range.
    """

    _classpath = "morse.plugins.traffic.robots.traffic.Traffic"

    def __init__(
        self,
        name: str | None = None,
        *,
        headway: float = 1.6,
        acceleration: float = 0.73,
        deceleration: float = 1.67,
        gap: float = _GAP,
        politeness: float = 0.3,
        bias: float = 0.0,
        deviation: float = 0.0,
        trucks: float = 0.0,
    ) -> None:
        values = {
            "Headway": checks.number(headway, "Traffic(headway)", minimum=0.1, maximum=20.0),
            "Acceleration": checks.number(acceleration, "Traffic(acceleration)", minimum=0.05, maximum=8.0),
            "Deceleration": checks.number(deceleration, "Traffic(deceleration)", minimum=0.05, maximum=8.0),
            "Gap": checks.number(gap, "Traffic(gap)", minimum=0.1, maximum=50.0),
            "Politeness": checks.share(politeness, "Traffic(politeness)"),
            "Bias": checks.number(bias, "Traffic(bias)", minimum=-5.0, maximum=5.0),
            "Deviation": checks.number(deviation, "Traffic(deviation)", minimum=0.0, maximum=0.3),
        }
        self._trucks = checks.share(trucks, "Traffic(trucks)")
        super().__init__("", name)
        self.scene_node.properties.update(values)
        self._least_gap = values["Gap"]
        self._roads: dict[str, dict[str, Any]] = {}
        self._stops: list[tuple[str, float, Component | str]] = []
        self._rules: list[tuple[list[str], list[str]]] = []
        self._zebras: list[tuple[str, float, float]] = []
        self._lengths: list[float] = []
        self._ends: dict[str, float] = {}

    def road(
        self,
        name: str,
        points: Iterable[Sequence[float]],
        count: int = 10,
        *,
        lanes: int = 1,
        width: float = 3.5,
        speed: float = 13.9,
        closed: bool = False,
        over: float = 0.0,
        radius: float = 0.0,
    ) -> None:
        """Add a road with cars. Those that reach the end of an open road enter it again at its beginning.

        Args:
            name: for `stop` and for services.
            points: (P, 2) of the middle of the road, m in the world, in the direction of driving.
            count: number of cars.
            lanes: number of lanes; drivers change between them.
            width: of a lane, m.
            speed: speed that drivers desire on the free road, m/s.
            closed: whether the road leads from the last point back to the first one.
            over: s, in which the cars enter one after the other; 0 for all on the road at the start.
            radius: of the middle of the road in its corners, m; 0 for the corners of the points. A truck of 12 m stays
                on a lane of 3.5 m whose radius is 13 m.

        Raises:
            ValueError: the road is too short for its cars or its corners, or a number is out of its range.
        """
        what = "Traffic.road"
        if checks.text(name, f"{what}(name)") in self._roads:
            raise ValueError(f"{what}(name): there is a road '{name}' already")
        if len(self._roads) >= _MOST_ROADS:
            raise ValueError(f"{what}: at most {_MOST_ROADS} roads")
        places = _points(points, f"{what}(points)")
        is_closed = checks.boolean(closed, f"{what}(closed)")
        if is_closed and len(places) < 3:
            raise ValueError(f"{what}(points): a closed road takes at least three points, got {len(places)}")
        number = checks.integer(count, f"{what}(count)", minimum=0)
        tracks = checks.integer(lanes, f"{what}(lanes)", minimum=1)
        if tracks > 8:
            raise ValueError(f"{what}(lanes) takes 1 to 8 lanes, got {tracks}")
        if len(self._lengths) + number > _MOST_CARS:
            raise ValueError(f"{what}(count): at most {_MOST_CARS} cars in all, got {len(self._lengths) + number}")
        wide = checks.number(width, f"{what}(width)", minimum=2.0, maximum=20.0)
        limit = checks.number(speed, f"{what}(speed)", minimum=0.5, maximum=80.0)
        seconds = checks.number(over, f"{what}(over)", minimum=0.0, maximum=1e6)
        round_ = checks.number(radius, f"{what}(radius)", minimum=0.0, maximum=1e4)
        if round_:
            places = _rounded(places, round_, f"{what}(radius)", closed=is_closed)
        ends = zip(places, [*places[1:], *(places[:1] if is_closed else ())], strict=False)
        length = sum(((x - u) ** 2 + (y - v) ** 2) ** 0.5 for (x, y), (u, v) in ends)
        trucks = round(self._trucks * number)
        # spread evenly
        own = [
            _TRUCK if (k + 1) * trucks // max(number, 1) > k * trucks // max(number, 1) else _CAR for k in range(number)
        ]
        needed = sum(one + self._least_gap for one in own)
        if not seconds and needed > length * tracks:
            raise ValueError(
                f"{what}(count): {number} cars need {needed:.0f} m, and '{name}' has {length * tracks:.0f} m of lanes: "
                "fewer cars, or let them enter with over="
            )
        self._lengths += own
        self._ends[name] = length
        self._roads[name] = {
            "points": places, "count": number, "lanes": tracks, "width": wide, "speed": limit, "closed": is_closed,
            "over": seconds,
        }  # fmt: skip

    def stop(self, road: str, place: float, light: Component | str) -> None:
        """Let the cars of a road wait at a stop line while a traffic light is red.

        Args:
            road: its name.
            place: of the line along the road, m from its first point.
            light: a `TrafficLight`, or its name; any component whose data has a ``state``.

        Raises:
            ValueError: there is no such road, or the place is not on it.
            TypeError: the light is no component.
        """
        what = "Traffic.stop"
        self._known(road, what)
        if not isinstance(light, str) and not hasattr(light, "scene_node"):
            raise TypeError(f"{what}(light) takes a traffic light or its name, got {checks.shown(light)}")
        where = self._place(road, place, what)
        self._stops.append((road, where, light))

    def right_of_way(self, *roads: str, first: Iterable[str] = ()) -> None:
        """Let the cars of roads that cross each other give way, where there are no traffic lights.

        Cars that come from the right go first. If each car waits for another one, the one that came first goes first.
        Nobody enters a crossing behind which there is no room.

        Args:
            roads: names of at least two roads.
            first: names of those among them that have priority over the others.

        Raises:
            TypeError: the names of roads with priority are no list.
            ValueError: there is no such road, or two of the roads have a rule already.
        """
        what = "Traffic.right_of_way"
        names = [self._known(one, what) for one in roads]
        leading = [self._known(one, what) for one in _names(first, what)]
        if len(set(names)) < 2 or len(set(names)) < len(names):
            raise ValueError(f"{what} takes two or more different roads that cross, got {', '.join(names) or 'none'}")
        for one in leading:
            if one not in names:
                raise ValueError(f"{what}(first): '{one}' is none of the roads of this rule: {', '.join(names)}")
        for known, _ in self._rules:
            both = [one for one in names if one in known]
            if len(both) > 1:
                raise ValueError(f"{what}: there is a rule for {' and '.join(both)} already")
        self._rules.append((names, leading))

    def zebra(self, road: str, place: float, width: float = 4.0) -> None:
        """Let the cars of a road wait for people, and robots, on a zebra crossing, or about to step on it.

        Args:
            road: its name; a street with two roads takes a call for each of them.
            place: of the middle of the crossing along the road, m from its first point.
            width: along the road, m.

        Raises:
            ValueError: there is no such road, the place is not on it, or a number is out of its range.
        """
        name = self._known(road, "Traffic.zebra")
        where = self._place(name, place, "Traffic.zebra")
        if len(self._zebras) >= _MOST_ZEBRAS:
            raise ValueError(f"Traffic.zebra: at most {_MOST_ZEBRAS} zebra crossings")
        self._zebras.append((name, where, checks.number(width, "Traffic.zebra(width)", minimum=0.5, maximum=50.0)))

    def _place(self, road: str, place: float, what: str) -> float:
        """Return a place on a road, m.

        Raises:
            ValueError: it is not on the road.
        """
        where = checks.number(place, f"{what}(place)", minimum=0.0)
        if where > self._ends[road]:
            raise ValueError(f"{what}(place): '{road}' is {self._ends[road]:g} m long, got {where:g}")
        return where

    def _known(self, road: str, what: str) -> str:
        """Return the name of a road.

        Raises:
            ValueError: there is no such road.
        """
        if checks.text(road, f"{what}(road)") not in self._roads:
            raise ValueError(f"{what}(road): there is no road '{road}'; there are {', '.join(self._roads) or 'none'}")
        return road

    def _declaration(self, robot: AbstractComponent) -> ComponentDeclaration:
        # components have their names only now
        stops = [(road, place, one if isinstance(one, str) else str(one.name)) for road, place, one in self._stops]
        node = self.scene_node
        node.properties["Roads"], node.properties["Stops"] = json.dumps(self._roads), json.dumps(stops)
        node.properties["Rules"], node.properties["Zebras"] = json.dumps(self._rules), json.dumps(self._zebras)
        node.properties["Lengths"] = json.dumps(self._lengths)
        from morse.builder import workspace
        from morse.plugins.traffic.roads import car

        scene = workspace.current()
        for number in range(len(node.children), len(self._lengths)):
            body = car(f"{self.name} car {number}", self._lengths[number], number * 7 % 13)
            scene.add(body)
            scene.attach(node, body)
        return super()._declaration(robot)


def _names(names: Iterable[str], what: str) -> list[str]:
    if isinstance(names, str) or not hasattr(names, "__iter__"):
        raise TypeError(f"{what}(first) takes a list of names, got {checks.shown(names)}")
    return list(islice(names, _MOST_ROADS + 1))


def _points(points: Iterable[Sequence[float]], what: str) -> list[list[float]]:
    if isinstance(points, str) or not hasattr(points, "__iter__"):
        raise TypeError(f"{what} takes points such as (0.0, 50.0), got {checks.shown(points)}")
    found: list[list[float]] = []
    for one in islice(points, _MOST_POINTS + 1):
        pair = list(islice(one, 3)) if hasattr(one, "__iter__") and not isinstance(one, str) else []
        if len(pair) != 2:
            raise ValueError(f"{what} takes points (x, y), got {checks.shown(one)}")
        place = [checks.number(value, what, minimum=-1e5, maximum=1e5) for value in pair]
        if found and max(abs(a - b) for a, b in zip(place, found[-1], strict=True)) < 0.01:
            raise ValueError(f"{what}: ({place[0]:g}, {place[1]:g}) is twice in a row")
        found.append(place)
    if not 2 <= len(found) <= _MOST_POINTS:
        raise ValueError(f"{what} takes 2 to {_MOST_POINTS} points, got {len(found)} or more")
    return found


def _rounded(points: list[list[float]], radius: float, what: str, *, closed: bool) -> list[list[float]]:
    """Return points (P, 2) of a line with arcs in place of its corners, m.

    Raises:
        ValueError: there is no room for an arc.
    """
    count = len(points)
    inner = range(count) if closed else range(1, count - 1)
    arcs: dict[int, tuple[float, list[list[float]]]] = {number: (0.0, [points[number]]) for number in range(count)}
    for number in inner:
        before, corner, after = (points[(number + step) % count] for step in (-1, 0, 1))
        begin = math.atan2(corner[1] - before[1], corner[0] - before[0])
        turn = math.remainder(math.atan2(after[1] - corner[1], after[0] - corner[0]) - begin, math.tau)
        if abs(turn) < 1e-6:
            continue
        if abs(turn) > 3.1:
            raise ValueError(
                f"{what}: the road turns back at ({corner[0]:g}, {corner[1]:g}): give it two corners there"
            )
        left = math.copysign(1.0, turn)
        cut = radius * math.tan(0.5 * abs(turn))
        # the middle of the arc
        x = corner[0] - cut * math.cos(begin) - left * radius * math.sin(begin)
        y = corner[1] - cut * math.sin(begin) + left * radius * math.cos(begin)
        parts = max(1, math.ceil(abs(turn) / _ARC))
        angles = [begin + turn * part / parts for part in range(parts + 1)]
        arc = [[x + left * radius * math.sin(one), y - left * radius * math.cos(one)] for one in angles]
        arcs[number] = cut, arc
    for number in range(count if closed else count - 1):
        (one, _), (two, _) = arcs[number], arcs[(number + 1) % count]
        apart = math.dist(points[number], points[(number + 1) % count])
        if one + two > apart - 0.01:
            x, y = points[number]
            raise ValueError(
                f"{what}: arcs of {radius:g} m need {one + two:.1f} m between the corner at ({x:g}, {y:g}) and the "
                f"next one, and there are {apart:.1f} m: a smaller radius, or longer parts"
            )
    return [place for number in range(count) for place in arcs[number][1]]
