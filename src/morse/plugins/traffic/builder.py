"""The class of traffic in scene scripts."""

from __future__ import annotations

import json
from itertools import islice
from typing import TYPE_CHECKING, Any

from morse.builder.components.robot import Robot
from morse.builder.errors import checks

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from morse.builder.abstractcomponent import AbstractComponent
    from morse.builder.components.component import Component
    from morse.scene import ComponentDeclaration

_MOST_CARS, _MOST_ROADS, _MOST_POINTS = 2000, 100, 1000
_CAR, _TRUCK, _GAP = 4.6, 12.0, 2.0


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
        self._lengths: list[float] = []

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

        Raises:
            ValueError: the road is too short for its cars, or a number is out of its range.
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
        if checks.text(road, f"{what}(road)") not in self._roads:
            raise ValueError(f"{what}(road): there is no road '{road}'; there are {', '.join(self._roads) or 'none'}")
        if not isinstance(light, str) and not hasattr(light, "scene_node"):
            raise TypeError(f"{what}(light) takes a traffic light or its name, got {checks.shown(light)}")
        where = checks.number(place, f"{what}(place)", minimum=0.0, maximum=1e5)
        self._stops.append((road, where, light))

    def _declaration(self, robot: AbstractComponent) -> ComponentDeclaration:
        # components have their names only now
        stops = [(road, place, one if isinstance(one, str) else str(one.name)) for road, place, one in self._stops]
        node = self.scene_node
        node.properties["Roads"], node.properties["Stops"] = json.dumps(self._roads), json.dumps(stops)
        node.properties["Lengths"] = json.dumps(self._lengths)
        from morse.builder import workspace
        from morse.plugins.traffic.roads import car

        scene = workspace.current()
        for number in range(len(node.children), len(self._lengths)):
            body = car(f"{self.name} car {number}", self._lengths[number], number * 7 % 13)
            scene.add(body)
            scene.attach(node, body)
        return super()._declaration(robot)


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
