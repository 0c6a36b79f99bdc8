"""Floors of a crowd: surfaces at several heights on which people walk, and the lifts between them.

All floors are side by side on one plane, on which people walk: the model of walking, walls and ways know only that
plane. Who rides in a lift is on a part of the plane of its own, because nobody else is near.
"""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.plugins.people.stairs import SLOW, Stairs, flights, layers
from morse.plugins.people.wayfinding import Ground, Link
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.scene import Node, Scene

    Floats = NDArray[np.float64]
    Indices = NDArray[np.intp]

#: most floors of a crowd
MOST_FLOORS = 20
#: m: a floor and a level of a lift that are so near to each other are the same
_SAME = 0.3
#: m: thickness of the walls of a cabin, and the room between a body and them
_WALL, _ROOM = 0.05, 0.02
#: m: from the doors of a cabin to the middles of those who stand nearest to them, so that the doors can close
_FROM_DOORS = 0.65
#: m, between the places of people in a cabin
_PITCH = 0.5
#: m, radius of somebody who stands in a place
_BODY = 0.2
#: s and m/s: opening, closing and waiting for a lift, and the speed of a person, which make a ride as long as a way
_STOP, _SPEED = 12.0, 1.34


class Shaft(NamedTuple):
    """A lift, as people see it.

    Attributes:
        node: of the lift, by which its component is found.
        place: (3,) m, of the middle of its cabin on the lowest floor.
        turn: (2, 2) from its axes to those of the world.
        depth, width: of its cabin, m; its doors are on the +X side.
        levels: (L,) m, heights of its floors in the world.
        stops: (F,) the level of each floor of the crowd; -1 for a floor where it does not stop.
        slots: (K, 2) m, where people stand in the cabin, in its axes, the places farthest from the doors first.
        capacity: number of people.
    """

    node: Node
    place: Floats
    turn: Floats
    depth: float
    width: float
    levels: Floats
    stops: Indices
    slots: Floats
    capacity: int

    def local(self, points: Floats) -> Floats:
        """Return points (N, 2) of the world in the axes of the lift, m."""
        apart = points - self.place[:2]
        return np.stack([(apart * self.turn[:, axis]).sum(axis=1) for axis in (0, 1)], axis=1)

    def world(self, points: Floats) -> Floats:
        """Return points (N, 2) in the axes of the lift in those of the world, m."""
        return self.place[:2] + self.turned(points)

    def turned(self, vectors: Floats) -> Floats:
        """Return vectors (N, 2) in the axes of the lift in those of the world."""
        return np.stack([(vectors * self.turn[axis]).sum(axis=1) for axis in (0, 1)], axis=1)

    def walls(self, floor: int) -> list[Floats]:
        """Return the polygons (4, 2) through which nobody walks on a floor of the crowd, m: all sides but the doors."""
        x, y = 0.5 * self.depth, 0.5 * self.width
        boxes = [(-x, -y, -x + _WALL, y), (-x, -y, x, -y + _WALL), (-x, y - _WALL, x, y)]
        if self.stops[floor] < 0:
            boxes = [(-x, -y, x, y)]
        return [self.world(np.array([(a, b), (c, b), (c, d), (a, d)])) for a, b, c, d in boxes]


def _slots(depth: float, width: float) -> Floats:
    """Return the places (K, 2) in a cabin, m."""
    aside, back = 0.5 * width - _WALL - _ROOM - _BODY, -0.5 * depth + _WALL + _ROOM + _BODY
    rows, columns = (
        np.linspace(low, high, max(int((high - low) / _PITCH) + 1, 1)) if high > low else np.array([0.5 * (low + high)])
        for low, high in ((back, max(0.5 * depth - _FROM_DOORS, back)), (-aside, aside))
    )
    places = [(float(x), float(y)) for x in rows for y in sorted(columns.tolist(), key=lambda one: -abs(one))]
    return np.array(places)


def _shaft(node: Node, heights: Floats) -> Shaft | None:
    """Return a lift that stops on two of the floors at least; None if a node is none."""
    try:
        levels = np.array(json.loads(str(node.properties["Levels"])), dtype=np.float64)
        depth, width = (float(one) for one in json.loads(str(node.properties["Size"]))[:2])
        capacity = int(node.properties.get("Capacity", 0))  # type: ignore[call-overload]
    except (KeyError, ValueError, TypeError, RecursionError, OverflowError):
        return None  # no lift, or one that says so itself
    if levels.ndim != 1 or not 0.0 < depth < 100.0 or not 0.0 < width < 100.0:
        return None
    frame = rigid_frame(node)
    place = np.array([float(v) for v in frame.position])
    turn = np.array([[float(v) for v in row] for row in frame.rotation])[:2, :2]
    levels = levels + place[2]
    apart = np.abs(levels[None, :] - heights[:, None])
    stops = np.where(apart.min(axis=1) < _SAME, apart.argmin(axis=1), -1).astype(np.intp)
    if (stops >= 0).sum() < 2:
        return None
    slots = _slots(depth, width)
    return Shaft(node, place, turn, depth, width, levels, stops, slots, min(capacity or len(slots), len(slots)))


class Floors:
    """The floors of a crowd, and the lifts that connect them.

    Args:
        heights: (F,) m in the world, the first one is that of the crowd itself.
        scene: in which lifts are found: components with the properties ``Levels`` and ``Size``.

    Attributes:
        count: F, number of floors.
        shafts: lifts between them.
        flights: stairs between them.
        stairs: the people on these.
        heights: (A,) m, of floors, of cabins, which change, and of the lower ends of stairs.
        shift: (A, 2) m, from the world to the part of the plane of each floor, each cabin and each flight of stairs.
    """

    def __init__(self, heights: Sequence[float], scene: Scene) -> None:
        floors = np.array(heights, dtype=np.float64)
        self.count = len(floors)
        found = [_shaft(one.node, floors) for one in scene.components] if self.count > 1 else []
        self.shafts = [one for one in found if one is not None]
        self.flights = flights(scene, floors) if self.count > 1 else []
        self._layers = layers(self.flights)
        #: number of the parts of the plane that have a ground: floors, and stairs
        self.grounds = self.count + max(self._layers, default=-1) + 1
        places = [float(one.place[2]) for one in self.shafts] + [float(one.place[2]) for one in self.flights]
        self.heights = np.concatenate([floors, places])
        self.shift = np.zeros((len(self.heights), 2))
        self.stairs = Stairs(self.flights, self.count + len(self.shafts), self.shift)
        self._low, self._high = np.full(2, -np.inf), np.full(2, np.inf)

    def spread(self, breadth: float, low: Floats, high: Floats) -> None:
        """Set how far the floors are from each other on the plane, and the corners (2,) of each of them, m."""
        cabins = self.grounds + np.arange(len(self.shafts))
        self.shift[:, 0] = breadth * np.concatenate(
            [np.arange(self.count), cabins, self.count + np.array(self._layers, dtype=np.intp)]
        )
        if self.count > 1:
            self._low, self._high = low, high

    def floor_of(self, height: float) -> int:
        """Return the number of the floor on which something of a height stands, m: the next one below it."""
        below = np.flatnonzero(self.heights[: self.count] <= height + _SAME)
        return int(below[self.heights[below].argmax()]) if len(below) else 0

    def on_plane(self, goal: Sequence[float] | Sequence[Sequence[float]]) -> tuple[Any, int]:
        """Return a point or an area of the world on the plane, m, and its floor.

        Args:
            goal: (2,) or (V, 2) on the floor of the crowd, (3,) or (V, 3) with heights.

        Raises:
            ValueError: there is no floor at that height, or an area is on several floors.
        """
        points = np.atleast_2d(np.array(goal, dtype=np.float64))
        floor = 0
        if points.shape[1] == 3:
            floor = self.floor_of(float(points[0, 2]))
            if np.abs(points[:, 2] - self.heights[floor]).max() > _SAME:
                floors = ", ".join(f"{one:g}" for one in self.heights[: self.count])
                raise ValueError(f"{goal!r:.80} is on none of its floors, which are at {floors} m")
        flat = points[:, :2] + self.shift[floor]
        return (flat if np.ndim(goal[0]) else flat[0]).tolist(), floor

    def within(self, points: Floats) -> NDArray[np.bool_]:
        """Whether points (N, 2) of the world are on the ground of the floors: each point of a single floor is."""
        return np.asarray(((points >= self._low) & (points <= self._high)).all(axis=1))

    def walls(self, floor: int) -> list[Floats]:
        """Return the walls (V, 2) of lifts and stairs on a floor, m in the world."""
        height = self.heights[floor]
        high = [one for one in self.shafts if one.levels[0] - _SAME < height < one.levels[-1] + 2.0]
        stairs = [wall for one in self.flights for wall in one.walls(floor, self.heights[: self.count])]
        return [wall for one in high for wall in one.walls(floor)] + stairs

    def more_grounds(self, low: Floats, high: Floats, radius: float) -> list[Ground]:
        """Return the grounds of stairs, beside those of the floors: see `Ground`."""
        found = []
        for layer in range(self.grounds - self.count):
            here = [one for one, own in zip(self.flights, self._layers, strict=True) if own == layer]
            walls = [wall for one in here for wall in one.own_walls()]
            found.append(Ground(walls, low, high, radius, self.grounds, SLOW))
        return found

    def heights_of(self, position: Floats, area: Indices) -> Floats:
        """Return the heights (N,) in the world of people at places (N, 2) of parts (N,) of the plane, m."""
        return np.asarray(self.heights[area] + self.stairs.heights(position, area))

    def connect(self, ground: Ground) -> None:
        """Let the ways of a ground, which has all floors, lead through lifts and over stairs."""
        for shaft in self.shafts:
            cells = [
                ground.cell_at(shaft.place[:2] + self.shift[floor]) if stop >= 0 else -1
                for floor, stop in enumerate(shaft.stops.tolist())
            ]
            floors = [floor for floor, cell in enumerate(cells) if cell >= 0]
            rises = np.abs(self.heights[floors][:, None] - self.heights[floors][None, :])
            costs = _SPEED * (_STOP + rises)
            np.fill_diagonal(costs, 0.0)
            ground.links.append(Link(np.array([cells[floor] for floor in floors], dtype=np.intp), costs))
        self.stairs.connect(ground)


def spots(shaft: Shaft, ground: Ground, shift: Floats) -> Floats:
    """Return the places (K, 2) on the plane where people wait for a lift, the nearest first, m.

    They are on both sides of the way out of the cabin.
    """
    door = 0.5 * shaft.depth
    begin = shaft.world(np.array([[door + 0.9, 0.0]])) + shift
    found: list[tuple[float, Floats]] = []
    for row in range(4):
        for column in range(5):
            for side in (-1.0, 1.0):
                own = np.array([[door + 0.75 + 0.6 * row, side * (max(0.5 * shaft.width, 0.6) + 0.1 + 0.6 * column)]])
                there = shaft.world(own) + shift
                line = begin + np.linspace(0.0, 1.0, 12)[:, None] * (there - begin)
                if (ground.clearance(line)[0] > ground.radius + 0.05).all():
                    found.append((math.hypot(float(own[0, 0]) - door, float(own[0, 1])), there[0]))
    if not found:
        line = np.stack([door + 1.0 + 0.6 * np.arange(12), np.zeros(12)], axis=1)
        return shaft.world(line) + shift
    found.sort(key=lambda one: one[0])
    return np.array([place for _, place in found])
