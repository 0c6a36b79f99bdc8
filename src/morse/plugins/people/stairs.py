"""Stairs between the floors of a crowd: a part of the plane for each flight, and how people walk on it.

A flight is on a part of the plane of its own, which overlaps both floors by `_OVERLAP` at its ends: people change over
in the middle of the overlaps, and see those on the other side of it. Speeds along the ground are those of U. Weidmann,
Transporttechnik der Fussgänger, IVT 90 (1993), section 2.4: 0.610 m/s up and 0.694 m/s down, where people walk at
1.34 m/s on the level.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.plugins.people.walking import Others
from morse.plugins.people.wayfinding import Ground, Link
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from morse.plugins.people.walking import Walkers
    from morse.scene import Node, Scene

    Floats = NDArray[np.float64]
    Indices = NDArray[np.intp]

#: shares of the free speed, up and down
UP, DOWN = 0.610 / 1.34, 0.694 / 1.34
#: how much longer a way on stairs takes: the mean of both
SLOW = 0.5 * (1.0 / UP + 1.0 / DOWN)
#: m: the end of a flight belongs to a floor whose height differs by less
_SAME = 0.3
#: m: extent of the overlaps; distances from the edge of a floor to where people change over, and to links of ways
_OVERLAP, _CHANGES, _LINKS = 0.6, 0.15, 0.3
#: m: thickness of rails; distance from them to the outermost cells of links
_RAIL, _BESIDE = 0.05, 0.3
#: m: people see others that far on the other side of the edge of a floor
_SEES = 2.5
#: share of the height of a body by which hips are lower on stairs, because knees are bent
_BENT = 0.02
#: m: before a flight, people bend their knees over this way
_BENDING = 0.5


class Flight(NamedTuple):
    """A straight flight of stairs; its X axis is the way up, and its origin the middle of the edge of the first step.

    Attributes:
        node: of the stairs.
        place: (3,) m, of its origin.
        turn: (2, 2) from its axes to those of the world.
        low, high: numbers of the floors that it connects.
        rise, run, width: m.
        tread, riser: m, of a step.
    """

    node: Node
    place: Floats
    turn: Floats
    low: int
    high: int
    rise: float
    run: float
    width: float
    tread: float
    riser: float

    def local(self, points: Floats) -> Floats:
        """Return points (N, 2) of the world in the axes of the flight, m."""
        apart = points - self.place[:2]
        return np.stack([(apart * self.turn[:, axis]).sum(axis=1) for axis in (0, 1)], axis=1)

    def world(self, points: Floats) -> Floats:
        """Return points (N, 2) in the axes of the flight in those of the world, m."""
        turned = np.stack([(points * self.turn[axis]).sum(axis=1) for axis in (0, 1)], axis=1)
        return np.asarray(self.place[:2] + turned)

    def slope(self, along: Floats) -> Floats:
        """Return the heights (N,) of the line through the middles of the steps, m above the lower floor."""
        return np.clip(self.riser * (along / self.tread + 0.5), 0.0, self.rise)

    def step(self, along: Floats) -> Floats:
        """Return the heights (N,) of the steps, m above the lower floor."""
        steps = np.clip(np.floor(along / self.tread) + 1.0, 0.0, None) * self.riser
        return np.where(along >= self.run, self.rise, np.minimum(steps, self.rise))

    def _boxes(self, boxes: list[tuple[float, float, float, float]]) -> list[Floats]:
        return [self.world(np.array([(a, b), (c, b), (c, d), (a, d)])) for a, b, c, d in boxes]

    def _rails(self, begin: float, end: float) -> list[tuple[float, float, float, float]]:
        y = 0.5 * self.width
        return [(begin, -y - _RAIL, end, -y), (begin, y, end, y + _RAIL)]

    def walls(self, floor: int, heights: Floats) -> list[Floats]:
        """Return the polygons (4, 2) through which nobody walks on a floor, m in the world."""
        y = 0.5 * self.width + _RAIL
        if floor == self.low:
            return self._boxes([(_OVERLAP, -y, self.run, y), *self._rails(0.0, self.run)])
        if floor == self.high:
            return self._boxes([(0.0, -y, self.run - _OVERLAP, y), *self._rails(0.0, self.run)])
        passes = heights[self.low] < heights[floor] < heights[self.high]
        return self._boxes([(0.0, -y, self.run, y)]) if passes else []

    def own_walls(self) -> list[Floats]:
        """Return the polygons (4, 2) around its own part of the plane, m in the world."""
        begin, end, y = -_OVERLAP, self.run + _OVERLAP, 0.5 * self.width + _RAIL
        ends = [(begin - _RAIL, -y, begin, y), (end, -y, end + _RAIL, y)]
        return self._boxes([*self._rails(begin, end), *ends])

    def seams(self) -> list[tuple[int, Floats, bool]]:
        """Return the floor, the places (K, 2), m, of the links of ways, and whether they lead onto the stairs.

        People go beyond the place where they change over, so that they do not arrive before it.
        """
        most = max(0.5 * self.width - _BESIDE, 0.0)
        across = np.arange(-most, most + 1e-9, 0.1)
        found = []
        for floor, edge, way in ((self.low, 0.0, 1.0), (self.high, self.run, -1.0)):
            for onto, side in ((True, way * _LINKS), (False, -way * _LINKS)):
                found.append((floor, np.stack([np.full(len(across), edge + side), across], axis=1), onto))
        return found


def flights(scene: Scene, heights: Floats) -> list[Flight]:
    """Return the stairs of a scene that connect two floors of a crowd.

    Args:
        scene: in which stairs are found: components with the properties ``Rise``, ``Steps`` and ``Tread``.
        heights: (F,) m, of the floors in the world.
    """
    found = []
    for node in (one.node for one in scene.components):
        try:
            rise, tread, width = (float(node.properties[key]) for key in ("Rise", "Tread", "Width"))  # type: ignore[arg-type]
            steps = int(node.properties["Steps"])  # type: ignore[call-overload]
        except (KeyError, ValueError, TypeError, OverflowError):
            continue  # no stairs, or some that say so themselves
        if not (0.1 <= rise <= 30.0 and 0.15 <= tread <= 1.0 and 0.6 <= width <= 50.0 and 1 <= steps <= 200):
            continue
        frame = rigid_frame(node)
        place = np.array([float(v) for v in frame.position])
        turn = np.array([[float(v) for v in row] for row in frame.rotation])[:2, :2]
        ends = [np.abs(heights - height) for height in (place[2], place[2] + rise)]
        if max(one.min() for one in ends) < _SAME:
            low, high = (int(one.argmin()) for one in ends)
            run = tread * (steps - 1)
            found.append(Flight(node, place, turn, low, high, rise, run, width, tread, rise / steps))
    return found


def layers(found: Sequence[Flight]) -> list[int]:
    """Return for each flight the number of a part of the plane on which none of the others there overlaps it."""
    boxes: list[tuple[Floats, Floats]] = []
    chosen: list[int] = []
    for one in found:
        points = np.concatenate(one.own_walls())
        low, high = points.min(axis=0) - 1.0, points.max(axis=0) + 1.0
        taken = {layer for layer, (a, b) in zip(chosen, boxes, strict=True) if ((low < b) & (high > a)).all()}
        chosen.append(next(layer for layer in range(len(found)) if layer not in taken))
        boxes.append((low, high))
    return chosen


class Stairs:
    """The people of a crowd on stairs.

    Args:
        found: the flights.
        first: number of the part of the plane of the first one, among floors and cabins.
        shift: (A, 2) m, from the world to the parts of the plane.
    """

    def __init__(self, found: Sequence[Flight], first: int, shift: Floats) -> None:
        self.flights, self._first, self._shift = list(found), first, shift

    def connect(self, ground: Ground) -> None:
        """Let the ways of a ground lead over stairs."""
        for number, flight in enumerate(self.flights):
            own = self._shift[self._first + number]
            for floor, places, onto in flight.seams():
                points = flight.world(places)
                pairs = {(ground.cell_at(one + self._shift[floor]), ground.cell_at(one + own)) for one in points}
                costs = np.array([[0.0, 1e-3 if onto else np.inf], [np.inf if onto else 1e-3, 0.0]])
                for pair in sorted(one for one in pairs if min(one) >= 0):
                    ground.links.append(Link(np.array(pair, dtype=np.intp), costs, is_level=False))

    def _people_on(self, number: int, area: Indices) -> Indices:
        return np.flatnonzero(area == self._first + number)

    def change(self, walkers: Walkers, area: Indices, move: Callable[[Indices, int], None]) -> None:
        """Let people change over between floors and stairs.

        Args:
            walkers: people.
            area: (N,) on which part of the plane they are.
            move: puts people to another part of the plane.
        """
        for number, flight in enumerate(self.flights):
            own = self._first + number
            for floor, edge, way in ((flight.low, 0.0, 1.0), (flight.high, flight.run, -1.0)):
                rows = np.flatnonzero(walkers.present & (area == floor) & ~walkers.level)
                places = flight.local(walkers.position[rows] - self._shift[floor])
                into = (places[:, 0] - edge) * way
                enters = (into > _CHANGES) & (into < _OVERLAP) & (np.abs(places[:, 1]) < 0.5 * flight.width)
                if enters.any():
                    move(rows[enters], own)
                rows = self._people_on(number, area)
                places = flight.local(walkers.position[rows] - self._shift[own])
                leaves = (places[:, 0] - edge) * way < -_CHANGES
                if leaves.any():
                    move(rows[leaves], floor)

    def where(self, position: Floats, area: Indices) -> tuple[Indices, Floats]:
        """Return on which flight people are, -1 for none, and how high its lower floor is above theirs, (N,) m.

        On a floor, they are on stairs as soon as they are in the overlap.
        """
        which, base = np.full(len(area), -1, dtype=np.intp), np.zeros(len(area))
        for number, flight in enumerate(self.flights):
            which[area == self._first + number] = number
            for floor, edge, height in ((flight.low, 0.0, 0.0), (flight.high, flight.run, -flight.rise)):
                rows = np.flatnonzero(area == floor)
                local = flight.local(position[rows] - self._shift[floor])
                near = (np.abs(local[:, 0] - edge) < _OVERLAP) & (np.abs(local[:, 1]) < 0.5 * flight.width)
                which[rows[near]], base[rows[near]] = number, height
        return which, base

    def heights(self, position: Floats, area: Indices) -> Floats:
        """Return the heights (N,) of people on stairs above their floors, or above the lower ones of stairs, m."""
        found = np.zeros(len(area))
        if self.flights:
            which, base = self.where(position, area)
            for number, flight in enumerate(self.flights):
                rows = np.flatnonzero(which == number)
                along = flight.local(position[rows] - self._shift[area[rows]])[:, 0]
                found[rows] = base[rows] + flight.slope(along)
        return found

    def climbs(self, velocity: Floats, position: Floats, area: Indices) -> Floats:
        """Return the vertical speeds (N,) of people, m/s."""
        return (self.heights(position + 1e-3 * velocity, area) - self.heights(position, area)) / 1e-3

    def paces(self, walkers: Walkers, area: Indices) -> Floats:
        """Return the shares (N,) of the free speeds at which people walk where they are."""
        shares = np.ones(len(area))
        which, _ = self.where(walkers.position, area)
        for number, flight in enumerate(self.flights):
            rows = np.flatnonzero(which == number)
            along = flight.local(walkers.position[rows] - self._shift[area[rows]])[:, 0]
            upward = (walkers.wanted[rows] * flight.turn[:, 0]).sum(axis=1) > 0.0
            on_steps = (along > -0.5 * flight.tread) & (along < flight.run + 0.5 * flight.tread)
            shares[rows] = np.where(on_steps, np.where(upward, UP, DOWN), 1.0)
        return shares

    def others(self, walkers: Walkers, area: Indices) -> Others:
        """Return those whom people see on the other side of the edges of floors, at their places on this side."""
        places, rows = [np.zeros((0, 2))], [np.zeros(0, dtype=np.intp)]
        for number, flight in enumerate(self.flights):
            own = self._first + number
            for floor, edge, way in ((flight.low, 0.0, 1.0), (flight.high, flight.run, -1.0)):
                for here, there in ((floor, own), (own, floor)):
                    near = np.flatnonzero(walkers.present & (area == here))
                    local = flight.local(walkers.position[near] - self._shift[here])
                    into = (local[:, 0] - edge) * way * (1.0 if here == own else -1.0)
                    near = near[(into > -_OVERLAP) & (into < _SEES) & (np.abs(local[:, 1]) < 0.5 * flight.width + 0.5)]
                    rows.append(near)
                    places.append(walkers.position[near] - self._shift[here] + self._shift[there])
        every = np.concatenate(rows)
        seen = np.ones((len(area), len(every)), dtype=bool)
        return Others(np.concatenate(places), walkers.velocity[every], walkers.radius[every], seen)

    def steps(self, position: Floats, area: Indices, tall: Floats) -> Steps | None:
        """Return how the feet of people stand on steps; None if nobody is on stairs.

        Args:
            position: (N, 2) m.
            area: (N,) on which part of the plane they are.
            tall: (N,) m, heights of bodies.
        """
        which, base = self.where(position, area)
        if not (which >= 0).any():
            return None
        count = len(area)
        steps = Steps(self, position, area, which, base, np.full(count, np.nan), *np.zeros((3, count)))
        for number, flight in enumerate(self.flights):
            rows = np.flatnonzero(which == number)
            along = flight.local(position[rows] - self._shift[area[rows]])[:, 0]
            inside = np.minimum(along, flight.run - along)
            steps.share[rows] = np.clip((inside + _BENDING) / _BENDING, 0.0, 1.0)
            steps.bend[rows], steps.half[rows] = 0.5 * flight.riser + _BENT * tall[rows], 0.5 * flight.tread
            steps.tread[rows[inside > -0.5 * flight.tread]] = flight.tread
        return steps

    def feet(self, steps: Steps, rows: Indices, points: Floats, *, snap: bool) -> tuple[Floats, Floats]:
        """Return where feet stand that are put down at points (R, 2), m, and the heights (R,) of the steps there, m.

        Args:
            steps: below the people.
            rows: (R,) whose feet.
            points: (R, 2) m.
            snap: whether feet are put onto the middles of steps.
        """
        points, heights = points.copy(), np.zeros(len(rows))
        for number, flight in enumerate(self.flights):
            mine = np.flatnonzero(steps.flight[rows] == number)
            shift = self._shift[steps.area[rows[mine]]]
            local = flight.local(points[mine] - shift)
            if snap:
                on_steps = (local[:, 0] > 0.0) & (local[:, 0] < flight.run)
                middle = (np.floor(local[:, 0] / flight.tread) + 0.5) * flight.tread
                local[:, 0] = np.where(on_steps, middle, local[:, 0])
                points[mine] = flight.world(local) + shift
            heights[mine] = steps.base[rows[mine]] + flight.step(local[:, 0])
        return points, heights


class Steps(NamedTuple):
    """The steps below people in a tick.

    Attributes:
        stairs: on which they are.
        position: (N, 2) m, of people.
        area: (N,) on which part of the plane they are.
        flight: (N,) on which flight they are; -1 for none.
        base: (N,) m, height of the lower end of the flight above their part of the plane.
        tread: (N,) m, length of a step; NaN for those who are on the level.
        share: (N,) how much people walk as on stairs: from 0 on the level to 1.
        half: (N,) m, half the depth of a step.
        bend: (N,) m, by which hips are lower on stairs than such a step needs.
    """

    stairs: Stairs
    position: Floats
    area: Indices
    flight: Indices
    base: Floats
    tread: Floats
    share: Floats
    half: Floats
    bend: Floats

    def landing(self, rows: Indices, points: Floats) -> Floats:
        """Return where feet (R, 2) are put down that would be put down at points, m."""
        return self.stairs.feet(self, rows, points, snap=True)[0]

    def ground(self, rows: Indices, points: Floats) -> Floats:
        """Return the heights (R,) of the steps below points (R, 2), above the parts of the plane, m."""
        return self.stairs.feet(self, rows, points, snap=False)[1]

    def slope(self) -> Floats:
        """Return the heights (N,) of the places of people, above the parts of the plane, m."""
        return self.stairs.heights(self.position, self.area)
