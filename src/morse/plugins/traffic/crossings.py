"""Right of way: who waits where roads cross, and at zebra crossings.

The rules are those of the Convention on Road Traffic, Vienna 1968: drivers give way to those on a road with priority,
else to those who come from the right (article 18, 4a), do not enter a crossing on which they would have to stop
(article 18, 5), and stop for people on a zebra crossing, or about to step on it (article 21, 2b). Where each of several
drivers waits for another one, who came first drives first, as at all-way stops.

Cars of roads that cross are never in a crossing at the same time. Rules decide on the order only.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from morse.plugins.traffic.driving import Driver
    from morse.plugins.traffic.roads import Road
    from morse.plugins.traffic.robots.traffic import Bodies

    Floats = NDArray[np.float64]
    Indices = NDArray[np.int64]

#: m: distance of samples along a road, in front of a crossing where cars wait, between two crossings that are one
_SAMPLE, _BEFORE, _ONE = 0.5, 1.0, 10.0
#: roads cross whose directions differ by at least that angle, its sine
_ACROSS = 0.3
#: s: between the end of one's own passage and the arrival of somebody with priority
_SPARE = 1.0
#: m, m/s: a car that waits at its line; m/s: nobody stops behind a crossing who drives so fast
_AT_LINE, _STANDS, _FLOWS = 3.0, 0.3, 3.0
#: m/s²: who would have to brake harder drives on; m: added to the way in which a driver looks at a crossing
_BRAKES, _LOOKS = 5.0, 10.0
#: m, m/s: people so near to a road who walk towards it that fast are about to step on it
_STEPS_ON, _WALKS = 4.0, 0.2


class Line(NamedTuple):
    """Where the cars of a road wait.

    Attributes:
        road: its number.
        place: of the line along the road, m.
        end: where the crossing ends, m.
        rivals: (number, whether they go first) of the lines of roads that cross this one.
    """

    road: int
    place: float
    end: float
    rivals: tuple[tuple[int, bool], ...]


class Zebra(NamedTuple):
    """A zebra crossing: the number of the road, its middle along the road and its width along the road, m."""

    road: int
    place: float
    width: float


def lines(roads: Sequence[Road], rules: Iterable[tuple[list[int], list[int]]]) -> list[Line]:
    """Return where cars wait for each other.

    Args:
        roads: all.
        rules: numbers of the roads that cross each other, and of those among them that have priority.
    """
    found: list[Line] = []
    for members, first in rules:
        begin = len(found)
        meetings = _meetings(roads, members)
        spans = [(road, *span) for road in members for span in _spans(meetings, road)]
        # a span meets few others: it is compared with those of the roads that cross it there
        of_road: dict[int, list[int]] = {road: [] for road in members}
        for number, (road, _, _) in enumerate(spans):
            of_road[road].append(number)
        for road, low, high in spans:
            rivals = []
            for other in members:
                meeting = meetings.get((road, other))
                if meeting is None:
                    continue
                inside = (low <= meeting.along) & (meeting.along < high)
                place, turn = meeting.place[inside], meeting.turn[inside]
                for number in of_road[other] if len(place) else ():
                    own = turn[(spans[number][1] <= place) & (place <= spans[number][2])]
                    if len(own):
                        comes_from_right = own[len(own) // 2] > 0.0
                        goes_first = (other in first) if (other in first) != (road in first) else bool(comes_from_right)
                        rivals.append((begin + number, goes_first))
            found.append(Line(road, low - _BEFORE, high, tuple(sorted(rivals))))
        found[begin:] = _mutual(found[begin:], begin)
    return found


def _mutual(own: list[Line], begin: int) -> list[Line]:
    """Return the lines of a rule, numbered from ``begin``, of which two wait for each other, and one goes first.

    Samples of two roads that hardly meet, or bend where they do, do not always agree on both.
    """
    first: dict[tuple[int, int], bool] = {}
    for number, line in enumerate(own, begin):
        for rival, goes_first in line.rivals:
            if (rival, number) not in first:
                first[number, rival], first[rival, number] = goes_first, not goes_first
    rivals: list[list[tuple[int, bool]]] = [[] for _ in own]
    for (number, rival), goes_first in sorted(first.items()):
        rivals[number - begin].append((rival, goes_first))
    return [line._replace(rivals=tuple(some)) for line, some in zip(own, rivals, strict=True)]


class _Meeting(NamedTuple):
    """Where a road is crossed by another one.

    Attributes:
        along: (K,) places along the road, m; the first one may be a sample before its beginning.
        place: (K,) places along the other one, m.
        turn: (K,) sine of the angle to the other one, positive if that comes from the right.
    """

    along: Floats
    place: Floats
    turn: Floats


def _meetings(roads: Sequence[Road], members: list[int]) -> dict[tuple[int, int], _Meeting]:
    """Return where roads (first) are crossed by others (second), for those that cross."""
    found = {}
    for road in members:
        along = np.arange(-_SAMPLE, roads[road].length, _SAMPLE)
        points, ways = roads[road].places(along)
        for other in members:
            if other == road:
                continue
            # samples are near the other road only if they are near the box around it
            reach = 0.5 * roads[other].lanes * roads[other].width + _SAMPLE
            low, high = roads[other].points.min(axis=0) - reach, roads[other].points.max(axis=0) + reach
            near = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
            if not len(near):
                continue
            place, left, way = roads[other].project(points[near])
            turn = ways[near, 0] * way[:, 1] - ways[near, 1] * way[:, 0]
            shared = (np.abs(left) < reach) & (np.abs(turn) > _ACROSS)
            if shared.any():
                found[road, other] = _Meeting(along[near[shared]], place[shared], turn[shared])
    return found


def _spans(meetings: dict[tuple[int, int], _Meeting], road: int) -> list[tuple[float, float]]:
    """Return the parts of a road, m, in which it is crossed by other ones."""
    own = [meeting.along for (one, _), meeting in meetings.items() if one == road]
    places = np.unique(np.concatenate([np.zeros(0), *own]))
    places = places[places >= 0.0]
    if not len(places):
        return []
    breaks = np.flatnonzero(np.diff(places) > _ONE) + 1
    return [(float(part[0]) - _SAMPLE, float(part[-1]) + _SAMPLE) for part in np.split(places, breaks)]


@dataclass(slots=True)
class Cars:
    """What drivers see and do; one row for each car.

    Attributes:
        road: (N,) number of its road.
        there: (N,) whether it is on a road.
        front: (N,) place of the front bumper along the road, m.
        length: (N,) m.
        speed, desired: (N,) m/s.
        lane: (N,) number of the lane.
        gap, ahead: (N,) to what is ahead on the lane, m, and its speed, m/s.
    """

    road: Indices
    there: NDArray[np.bool_]
    front: Floats
    length: Floats
    speed: Floats
    desired: Floats
    lane: Indices
    gap: Floats
    ahead: Floats


@dataclass(slots=True)
class Crossings:
    """The crossings of all roads.

    Attributes:
        roads: all.
        lines: where cars wait for others.
        zebras: where they wait for people.
        passes: (N, L) whether a car passes the crossing behind a line, or is going to.
        since: (N,) s, since when it waits at a line; infinite for the others.
    """

    roads: Sequence[Road]
    lines: list[Line]
    zebras: list[Zebra]
    passes: NDArray[np.bool_]
    since: Floats

    def room(self, cars: Cars, driver: Driver, people: Bodies, now: float) -> Floats:
        """Decide who passes, and return the distances (N,) to the lines where the others wait, m, else infinite.

        Args:
            cars: on the roads.
            driver: parameters of all drivers.
            people: robots and people near the roads.
            now: s.
        """
        room = np.full(len(cars.road), np.inf)
        reach = cars.speed * cars.speed / (2.0 * driver.deceleration) + cars.speed * driver.headway + _LOOKS
        for zebra in self.zebras:
            if self._is_walked_on(zebra, people):
                left = self._left(cars, zebra.road, zebra.place - 0.5 * zebra.width - _BEFORE)
                stops = (left >= 0.0) & (left < reach) & (cars.speed * cars.speed <= 2.0 * _BRAKES * left + 0.1)
                room = np.where(stops, np.minimum(room, left), room)
        if self.lines:
            room = np.minimum(room, self._wait(cars, driver, reach, now))
        return room

    def begins_inside(self, cars: Cars) -> NDArray[np.bool_]:
        """Return (N,) whether a car is in a crossing, or could not stop before it: nobody begins there."""
        found = np.zeros(len(cars.road), dtype=bool)
        for line in self.lines:
            left = self._left(cars, line.road, line.place)
            behind = left + line.end - line.place + cars.length
            found |= (behind > 0.0) & (2.0 * _BRAKES * left < cars.speed * cars.speed)
        return found

    def _left(self, cars: Cars, road: int, place: float) -> Floats:
        """Return the ways (N,) to a place on a road, m; negative behind it, infinite on other roads."""
        left = place - cars.front
        if self.roads[road].closed:
            around = self.roads[road].length
            left = left - np.floor((left + 0.5 * around) / around) * around
        return np.where(cars.there & (cars.road == road), left, np.inf)

    def _is_walked_on(self, zebra: Zebra, people: Bodies) -> bool:
        """Return whether somebody is on a zebra crossing, or about to step on it."""
        if not len(people.points):
            return False
        road = self.roads[zebra.road]
        place, left, way = road.project(people.points)
        aside = way[:, 0] * people.velocities[:, 1] - way[:, 1] * people.velocities[:, 0]
        half = 0.5 * road.lanes * road.width
        on = np.abs(left) < half
        on |= (np.abs(left) < half + _STEPS_ON) & (-np.sign(np.where(np.isfinite(left), left, 0.0)) * aside > _WALKS)
        return bool((on & (np.abs(place - zebra.place) < 0.5 * zebra.width + 0.3)).any())

    def _wait(self, cars: Cars, driver: Driver, reach: Floats, now: float) -> Floats:
        """Decide who passes the crossings of roads; return the distances (N,) to the lines of the others, m.

        Args:
            cars: on the roads.
            driver: parameters of all drivers.
            reach: (N,) m: drivers look at lines that are nearer.
            now: s.
        """
        left = [self._left(cars, line.road, line.place) for line in self.lines]
        self.passes[~cars.there] = False
        near = []
        for number, line in enumerate(self.lines):
            way, passes = left[number], self.passes[:, number]
            behind = way + line.end - line.place + cars.length
            passes[(way < 0.0) & (behind > 0.0)] = True
            passes[behind <= 0.0] = False
            # who cannot stop any more
            passes[(way >= 0.0) & (cars.speed * cars.speed > 2.0 * _BRAKES * way + 0.1)] = True
            near.append((way >= 0.0) & (way < reach) & ~passes)
        waits = np.zeros(len(cars.road), dtype=bool)
        for number, way in enumerate(left):
            waits |= near[number] & (way < _AT_LINE) & (cars.speed < _STANDS)
        self.since = np.where(waits, np.minimum(self.since, now), np.inf)
        blocked: list[tuple[int, int, list[int]]] = []
        stuck: set[int] = set()
        for number in range(len(self.lines)):
            for car in self._first(cars, left[number], near[number]):
                others = self._others(cars, driver, left, car, number)
                if others is None:
                    stuck.add(car)
                elif not others:
                    self.passes[car, number] = True
                elif waits[car]:
                    blocked.append((car, number, others))
        # of those who wait for each other, who came first passes, if nobody is in the crossing
        for car, number, others in sorted(blocked, key=lambda one: (self.since[one[0]], one[0])):
            across = [rival for rival, _ in self.lines[number].rivals]
            beside = [rival for one in across for rival, _ in self.lines[one].rivals]
            is_free = not self.passes[:, [*across, *beside]].any()
            order = (float(self.since[car]), car)
            if is_free and all(
                waits[one] and (one in stuck or order < (float(self.since[one]), one)) for one in others
            ):
                self.passes[car, number] = True
        room = np.full(len(cars.road), np.inf)
        for number, way in enumerate(left):
            room = np.where(near[number] & ~self.passes[:, number], np.minimum(room, way), room)
        return room

    @staticmethod
    def _first(cars: Cars, left: Floats, near: NDArray[np.bool_]) -> list[int]:
        """Return the first car of each lane among those that are near."""
        rows = np.flatnonzero(near)
        order = rows[np.argsort(left[rows], kind="stable")]
        _, first = np.unique(cars.lane[order], return_index=True)
        return [int(car) for car in order[np.sort(first)]]

    def _others(self, cars: Cars, driver: Driver, left: list[Floats], car: int, number: int) -> list[int] | None:
        """Return the cars with priority for which a car waits; None if it cannot pass for another reason."""
        line = self.lines[number]
        speed, length = float(cars.speed[car]), float(cars.length[car])
        beyond = float(cars.front[car] + cars.gap[car]) - line.end if not self.roads[line.road].closed else math.inf
        if beyond < length + driver.gap and float(cars.ahead[car]) < _FLOWS and float(cars.gap[car]) < 1e3:
            return None
        way = float(left[number][car]) + line.end - line.place + length
        needed = (math.sqrt(speed * speed + 2.0 * driver.acceleration * way) - speed) / driver.acceleration
        needed = max(needed, way / max(float(cars.desired[car]), 0.1))
        found: list[int] = []
        for rival, goes_first in line.rivals:
            if self.passes[:, rival].any():
                return None
            if goes_first:
                there = left[rival]
                # those behind the first one of a lane arrive after it
                arrives = there / np.maximum(cars.speed, 1.0)
                first = self._first(cars, there, (there >= 0.0) & np.isfinite(there))
                found += [one for one in first if arrives[one] < needed + _SPARE]
        return found
