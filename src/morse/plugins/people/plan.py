"""The plan of a crowd: flows of people with their starts and goals, the ground between them, and the ways on it."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.exceptions import MorseError, MorseRPCInvokationError
from morse.core.reports.quoting import nearest as nearest_name
from morse.plugins.people.errands import Queue, line_back, phases
from morse.plugins.people.members import flows_of_members, nodes_of_members
from morse.plugins.people.recorded import checked
from morse.plugins.people.wayfinding import CELL, Ground, Way, walls
from morse.scene import PhysicsType

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.plugins.people.floors import Floors
    from morse.scene import Node

    Floats = NDArray[np.float64]
    Indices = NDArray[np.intp]

#: m: the ground reaches at least so far around starts and goals
_AROUND = 12.0
#: m: it also reaches so far beyond the outer walls of the scene, as long as it has at most that number of cells
_BEYOND, _MOST_CELLS = 2.0, 500_000
#: m: in such steps it grows
_GROWS = 2.0
#: m: how far from a solid object people stop who go to it
_BESIDE = 3.0
#: m: nobody begins in something of at least that height
_FLAT = 0.05
#: m² for each person, m, m: a start area without a script, its least half, and the depth of the goals at its sides
_OWN_ROOM, _OWN_HALF, _OWN_GOAL = 3.0, 3.0, 1.0
#: most ways that people were sent to, which are kept
_MOST_WAYS = 64


class Plan:
    """Where the people of a crowd begin and where they go.

    Args:
        context: of the simulation.
        name: of the crowd, for messages.
        floors: on which people walk.
        plan: as the script has written it: ``flows``, ``default``, ``tracks``.
        count: N, number of people.
        middle: (x, y) m, place of the crowd, around which people begin who have no start.
        radius: m, of the slimmest person.

    Attributes:
        flows: each with its ``area``, ``floor``, ``goals``, ``places``, ``ways`` and ``then``.
        members: nodes of the robots that are members, and whether they walk with the crowd from the beginning.
        tracks: recorded trajectories; None for people who walk by themselves.
        ground: with the walls of the scene.
        loose: outlines (V, 2) of what can move, at its places in the scene, m, on the plane.
        ways: the ways that were searched, by the bytes of their goals.

    Raises:
        MorseError: the plan does not fit the scene.
    """

    def __init__(
        self,
        context: Context,
        name: str,
        floors: Floors,
        plan: dict[str, Any],
        count: int,
        middle: tuple[float, float],
        radius: float,
    ) -> None:
        self._context, self._name, self._floors, self._count, self._middle = context, name, floors, count, middle
        self.ways: dict[bytes, Way] = {}
        self.members: dict[str, tuple[Node, bool]] = {}
        self.flows = self._read(plan)
        self.ground = self._survey(radius)

    def _read(self, plan: dict[str, Any]) -> list[dict[str, Any]]:
        flows = [dict(flow) for flow in plan.get("flows", ())]
        try:
            self.tracks = checked(plan)
        except ValueError as error:
            raise MorseError(f"{self._name}: {error}") from None
        if self.tracks is not None:
            return []
        if not flows:
            flows = self._own_flows(with_goals=not plan.get("default"))
        default = plan.get("default") or {"goals": [], "then": "stay", "wait": 0.0}
        free = self._count - sum(flow["count"] or 0 for flow in flows)
        open_flows = [flow for flow in flows if flow["count"] is None]
        for number, flow in enumerate(open_flows):
            flow["count"] = free // len(open_flows) + (number < free % len(open_flows))
        members = plan.get("members") or []
        self.members = nodes_of_members(self._name, members, self._context)
        flows += flows_of_members(members, self.members, self._count)
        for flow in flows:
            if flow["goals"] is None:
                flow.update(default)
        return phases(flows)

    def _own_flows(self, *, with_goals: bool) -> list[dict[str, Any]]:
        """Return the flows of a crowd without a start: in a square around its place, half along and half across it."""
        x, y = self._middle
        half = max(_OWN_HALF, 0.5 * math.sqrt(_OWN_ROOM * self._count))
        inner = half - _OWN_GOAL

        def area(low: float, high: float, left: float, right: float) -> list[list[float]]:
            return [[x + u, y + v] for u, v in ((low, left), (high, left), (high, right), (low, right))]

        ways: list[tuple[int | None, list[Any]]] = [
            (self._count // 2, [area(inner, half, -half, half), area(-half, -inner, -half, half)]),
            (None, [area(-half, half, inner, half), area(-half, half, -half, -inner)]),
        ]
        begin = {"area": area(-half, half, -half, half), "over": 0.0, "exact": False, "is_own": True}
        if not with_goals:
            return [{**begin, "count": None, "goals": None}]
        return [{**begin, "count": count, "goals": goals, "then": "repeat", "wait": 0.0} for count, goals in ways]

    def _survey(self, radius: float) -> Ground:
        """Return the ground around the starts and goals, and between the walls of the scene."""
        points: list[Floats] = [np.array(flow["area"])[:, :2] for flow in self.flows]
        points += [np.atleast_2d(goal)[:, :2] for flow in self.flows for goal in self._places(flow)]
        points += [shaft.world(shaft.slots) for shaft in self._floors.shafts]
        points += [wall for flight in self._floors.flights for wall in flight.own_walls()]
        every = np.concatenate(points) if self.tracks is None else np.stack([self.tracks.low, self.tracks.high])
        low, high = every.min(axis=0) - _AROUND, every.max(axis=0) + _AROUND
        if float((high - low).max()) > 2000.0:
            raise MorseError(f"{self._name}: starts and goals are {(high - low).max():.0f} m apart: at most 2000 m")
        stairs = {flight.node for flight in self._floors.flights}
        robots = {declaration.node for declaration in self._context.scene.components if declaration.kind != "sensor"}
        fixed: list[Node] = []
        loose: list[Node] = []
        stack = [(root, False) for root in self._context.scene.roots]
        while stack:
            node, moves = stack.pop()
            if node in stairs:
                continue  # the floors know where nobody walks there
            moves |= node in robots or node.body.moves or node.body.type is PhysicsType.KINEMATIC
            if node.body.collides:
                (loose if moves else fixed).append(node)
            stack += [(child, moves) for child in node.children]
        heights = self._floors.heights[: self._floors.count].tolist()
        around = [[*walls(fixed, one), *self._floors.walls(floor)] for floor, one in enumerate(heights)]
        low, high = _extent(low, high, [polygon for own in around for polygon in own], self._floors.grounds)
        grounds = [Ground(own, low, high, radius, self._floors.grounds) for own in around]
        self._floors.spread(grounds[0].breadth, low, high)
        self.loose = [
            outline + shift
            for one, shift in zip(heights, self._floors.shift, strict=False)
            for outline in walls(loose, one, _FLAT)
            if len(heights) == 1 or self._floors.within(outline).any()
        ]
        ground = Ground.beside([*grounds, *self._floors.more_grounds(low, high, radius)])
        self._floors.connect(ground)
        for flow in self.flows:
            if "begin" in flow:  # the robot of a member stands on the floor below it
                x, y, z = flow["area"][0]
                flow["area"] = [[x, y] if self._floors.count == 1 else [x, y, self._floor_below(z)]]
            flow["area"], flow["floor"] = self._on_plane(flow["area"])
            flow["places"] = [self._on_plane(place)[0] for place in self._places(flow)]
        return ground

    def _on_plane(self, goal: Any) -> tuple[Any, int]:
        try:
            return self._floors.on_plane(goal)
        except ValueError as error:
            raise MorseError(f"{self._name}: {error}") from None

    def _places(self, flow: dict[str, Any]) -> list[Any]:
        """Return the goals of a flow as points and areas in the world."""
        found = []
        for goal in flow["goals"]:
            if isinstance(goal, str):
                objects = self._context.world.objects_by_name
                if goal not in objects:
                    raise MorseError(
                        f"{self._name}: there is no object '{goal:.80}' to go to{nearest_name(goal, sorted(objects))}"
                    )
                x, y, z = objects[goal].world_pose()[0]
                found.append([x, y] if self._floors.count == 1 else [x, y, self._floor_below(z)])
            else:
                found.append(goal)
        return found

    def _floor_below(self, height: float) -> float:
        return float(self._floors.heights[self._floors.floor_of(height)])

    def way_to(self, goal: Any) -> Way | None:
        """Return the way to a point or an area; None if nobody can stand there."""
        key = np.array(goal, dtype=np.float64)
        way = self.ways.get(key.tobytes())
        if way is not None:
            return way
        cells = self.ground.cells_beside(key, _BESIDE) if key.ndim == 1 else self.ground.cells_in(key)
        if not cells.any():
            return None
        if len(self.ways) >= _MOST_WAYS + sum(len(flow["goals"]) for flow in self.flows):
            self.ways.pop(next(reversed(self.ways)))
        way = self.ways[key.tobytes()] = self.ground.way_to(cells)
        return way

    def demand_way(self, x: float, y: float, floor: int) -> tuple[Way, list[float]]:
        """Return the way to a place of a floor, and the place on the plane.

        Args:
            x, y: m, in the world, as a client has given them.
            floor: number of the floor.

        Raises:
            MorseRPCInvokationError: nobody can go there.
        """
        if not np.isfinite([x, y]).all():
            raise MorseRPCInvokationError(f"the place ({x}, {y}) is not finite")
        if not 0 <= floor < self._floors.count:
            raise MorseRPCInvokationError(f"{self._name} has the floors 0 to {self._floors.count - 1}, not {floor}")
        shape = self.ground.shape
        low = self.ground.origin
        high = low + self.ground.cell * (np.array([shape[1] // self.ground.parts, shape[0]]) - 1)
        if not (low[0] <= x <= high[0] and low[1] <= y <= high[1]):
            raise MorseRPCInvokationError(
                f"({x:g}, {y:g}) is outside the ground of {self._name}: x {low[0]:g} to {high[0]:g} m, "
                f"y {low[1]:g} to {high[1]:g} m"
            )
        place = (np.array([float(x), float(y)]) + self._floors.shift[floor]).tolist()
        way = self.way_to(place)
        if way is None:
            raise MorseRPCInvokationError(f"nobody can stand at ({x:g}, {y:g}), or within {_BESIDE:g} m of it")
        return way, place

    @cached_property
    def routes(self) -> tuple[list[Way], Indices, Indices]:
        """The ways of all flows, each one once; the numbers of those to goals; the numbers of those without stairs.

        The numbers (F + 1, G) are -1 where there is no goal, as in the last row, of people who belong to no flow; those
        (W + 1,) without stairs have the -1 of these people at the end. It takes flows that have their ways.
        """
        most = max((len(flow["ways"]) for flow in self.flows), default=0)
        numbers = np.full((len(self.flows) + 1, max(most, 1)), -1, dtype=np.intp)
        ways: list[Way] = []
        known: dict[int, int] = {}

        def number_of(way: Way) -> int:
            if id(way) not in known:
                known[id(way)] = len(ways)
                ways.append(way)
            return known[id(way)]

        for number, flow in enumerate(self.flows):
            for stage, way in enumerate(flow["ways"]):
                numbers[number, stage] = number_of(way)
        level = [number_of(way.level or way) for way in list(ways)]
        # those without stairs lead to themselves
        return ways, numbers, np.array([*level, *range(len(level), len(ways)), -1], dtype=np.intp)

    def ways_of(self, flow: dict[str, Any]) -> list[Way]:
        """Return the ways to the goals of a flow, and find its line and its seats.

        Raises:
            MorseError: nobody can stand at a goal.
        """
        if flow.get("is_own"):
            # where there are walls, they go to what remains
            open_ones = [self.way_to(place) is not None for place in flow["places"]]
            flow["goals"] = [goal for goal, is_open in zip(flow["goals"], open_ones, strict=True) if is_open]
            flow["places"] = [place for place, is_open in zip(flow["places"], open_ones, strict=True) if is_open]
            flow["then"] = flow["then"] if flow["goals"] else "stay"
        ways = []
        for goal, place in zip(flow["goals"], flow["places"], strict=True):
            way = self.way_to(place)
            if way is None:
                raise MorseError(f"{self._name}: nobody can stand at the goal {goal!r:.80}: it is within a wall")
            ways.append(way)
        if flow["then"] == "queue":
            counter = np.array(flow["places"][-1]).reshape(-1, 2).mean(axis=0)
            spots = line_back(self.ground, ways[-1], np.array(flow["area"]).mean(axis=0), counter, self._count)
            flow["queue"] = Queue(spots, float(flow["wait"]))
        flow["seats"] = [np.array(place).reshape(-1, 2).mean(axis=0) for place in flow["places"]]
        if flow["then"] in ("queue", "sit"):
            area = np.array(flow["area"])
            home = self.way_to(area.mean(axis=0).tolist() if flow["exact"] else flow["area"])
            if home is None:
                raise MorseError(f"{self._name}: nobody can stand in {flow['area']!r:.80}: there are walls")
            ways.append(home)
        return ways


def _extent(low: Floats, high: Floats, polygons: list[Floats], floors: int) -> tuple[Floats, Floats]:
    """Return the corners (2,), (2,) of a ground that reaches as far to the outer walls as its number of cells permits.

    Args:
        low, high: (2,) corners that it has at least, m.
        polygons: (V, 2) walls, m.
        floors: number of floors, each with a ground of that size.
    """
    if not polygons:
        return low, high
    points = np.concatenate(polygons)
    first, last = points.min(axis=0) - _BEYOND, points.max(axis=0) + _BEYOND
    begin, end = low, high
    for step in range(1, int(math.sqrt(_MOST_CELLS) * CELL / _GROWS) + 1):
        wider = np.minimum(low, np.maximum(low - step * _GROWS, first))
        farther = np.maximum(high, np.minimum(high + step * _GROWS, last))
        if float(np.prod(farther - wider)) * floors > _MOST_CELLS * CELL * CELL:
            break
        begin, end = wider, farther
    return begin, end
