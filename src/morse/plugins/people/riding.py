"""How people ride in lifts: they wait beside the doors, let others out, enter, stand, and leave on their floors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, cast

import numpy as np

from morse.plugins.people.errands import steps_to
from morse.plugins.people.floors import Floors, Shaft, spots
from morse.plugins.people.wayfinding import HEIGHT, distance_to

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.plugins.people.contacts import Surroundings
    from morse.plugins.people.walking import Walkers
    from morse.plugins.people.wayfinding import Ground, Way

    Floats = NDArray[np.float64]
    Indices = NDArray[np.intp]

#: what a person does with a lift
ON_FOOT, WAITS, BOARDS, ABOARD, LEAVES = range(5)
WORDS = ("walks", "waits for a lift", "enters a lift", "rides", "leaves a lift")
#: m, of the way to a cabin, at which people begin to wait for it
_JOINS = 3.5
#: m: from there, people who wait go straight to their places, and enter
_STRAIGHT = 3.0
#: s: people hold the doors, and enter, until they have been open for so long
_PATIENCE = 25.0
#: m: middles of bodies that are so far behind the doors are in the cabin; people have left that far in front of them
_INSIDE, _OUTSIDE = 0.5, 0.4
#: m in front of the doors: who is there takes a place in the cabin
_ENTERS = 0.2
#: m: a person stands in its place in the cabin; s, for which the doors are held for somebody who is on the way
_THERE, _HOLDS = 0.3, 1.0
#: ticks after which people who wait for a lift look whether their way still leads through it
_THINKS = 15


class Cabin(Protocol):
    """What people need of a lift."""

    local_data: Any

    def call(self, level: int) -> None:
        """Call it to a level."""

    def hold_doors(self, seconds: float) -> None:
        """Keep its doors open."""


class Riding:
    """The people of a crowd and the lifts.

    Args:
        context: of the simulation.
        floors: of the crowd.
        ground: on which they walk.
        around: what they see.
        count: N, number of people.

    Attributes:
        area: (N,) on which part of the plane people are: a floor, or a cabin.
        ride: (N,) what they do, from `ON_FOOT`.
        lift: (N,) number of the lift; -1 for those on foot.
        slot: (N,) number of the place in the cabin; -1 for none.
        turn: (N,) order of those who wait.
        opened: (S,) s, when the doors of each lift were opened.
    """

    def __init__(self, context: Context, floors: Floors, ground: Ground, around: Surroundings, count: int) -> None:
        self._context, self._floors, self._ground, self._around = context, floors, ground, around
        self.area = np.zeros(count, dtype=np.intp)
        self.ride = np.zeros(count, dtype=np.intp)
        self.lift = np.full(count, -1, dtype=np.intp)
        self.slot = np.full(count, -1, dtype=np.intp)
        self.turn = np.zeros(count, dtype=np.intp)
        self.opened = np.zeros(len(floors.shafts))
        self._spots = [[spots(one, ground, shift) for shift in floors.shift[: floors.count]] for one in floors.shafts]

    def _bounds(self) -> dict[str, tuple[int, int]]:
        """Return the least and the largest values of the arrays."""
        shafts = self._floors.shafts
        most = max((len(one.slots) for one in shafts), default=0)
        return {
            "area": (0, len(self._floors.heights) - 1),
            "ride": (0, len(WORDS) - 1),
            "lift": (-1, len(shafts) - 1),
            "slot": (-1, most - 1),
            "turn": (0, 1 << 40),
        }

    def can_be(self, people: dict[str, Any]) -> bool:
        """Whether the arrays of a state are possible: a place in a cabin is one of that cabin."""
        lift, slot, area, count = people["lift"], people["slot"], people["area"], self._floors.count
        if not all(
            ((low <= people[name]) & (people[name] <= high)).all() for name, (low, high) in self._bounds().items()
        ):
            return False
        stairs = count + len(self._floors.shafts)
        # the last one is of those without a lift, who have none
        places = np.array([*(len(one.slots) for one in self._floors.shafts), 0])
        return bool(
            ((people["ride"] == ON_FOOT) == (lift < 0)).all()
            and ((area < count) | (area >= stairs) | ((area == count + lift) & (people["ride"] == ABOARD))).all()
            and (people["ride"][area >= stairs] == ON_FOOT).all()
            and (slot < places[lift]).all()
        )

    def cabin_of(self, shaft: Shaft) -> Cabin | None:
        """Return the component of a lift; None if it is no lift that people know how to use."""
        for robot in self._context.robots.values():
            if robot.bge_object.node is shaft.node and callable(getattr(robot, "hold_doors", None)):
                return cast("Cabin", robot)
        return None

    def plan(
        self,
        walkers: Walkers,
        walks: NDArray[np.bool_],
        led: Indices,
        way_of: Callable[[int], Way | None],
        move: Callable[[Indices, int], None],
    ) -> None:
        """Decide about lifts for a tick, and set where those want to go who have to do with them.

        Args:
            walkers: people.
            walks: (N,) who is on the way to a goal, or to a leader.
            led: (N,) lift in which the leader of each of them stands, who go and stay there, too; -1 for none.
            way_of: returns the way of a person.
            move: puts people to another part of the plane.
        """
        for number, shaft in enumerate(self._floors.shafts):
            cabin = self.cabin_of(shaft)
            if cabin is None:
                continue
            data = cabin.local_data
            self._floors.heights[self._floors.count + number] = shaft.place[2] + data["height"]
            floors = np.flatnonzero(shaft.stops == data["level"]) if data["openness"] > 0.0 else np.zeros(0, np.intp)
            floor = int(floors[0]) if len(floors) else -1
            places = shaft.local(walkers.position - self._floors.shift[self.area])
            if data["openness"] == 0.0:
                self.opened[number] = self._context.clock.time
                self._shut(number, shaft, data["level"], walkers.present, places, move)
            self._ride(number, shaft, cabin, floor, walks & (led != number), way_of, move)
            self._wait(number, shaft, cabin, floor, walkers, walks & walkers.present, led == number, way_of)
            places = shaft.local(walkers.position - self._floors.shift[self.area])
            if floor >= 0:
                self._board(number, shaft, cabin, floor, walkers, places)
            self._aim(number, shaft, walkers, places)

    def _rows(self, number: int, *rides: int) -> Indices:
        return np.flatnonzero((self.lift == number) & np.isin(self.ride, rides))

    def _set(self, rows: Indices, ride: int, lift: int) -> None:
        self.ride[rows], self.lift[rows] = ride, lift
        if ride in (ON_FOOT, WAITS, LEAVES):
            self.slot[rows] = -1

    def _shut(
        self,
        number: int,
        shaft: Shaft,
        level: int,
        present: NDArray[np.bool_],
        places: Floats,
        move: Callable[[Indices, int], None],
    ) -> None:
        """Let those ride who are in the cabin when the doors are closed, and the others stay where they are."""
        on_floor = self.area < self._floors.count
        within = (np.abs(places) < 0.5 * np.array([shaft.depth, shaft.width])).all(axis=1)
        # who has walked into the cabin without a goal elsewhere, behind a leader
        strays = present & on_floor & (self.ride == ON_FOOT) & within
        strays &= shaft.stops[np.where(on_floor, self.area, 0)] == level
        self._set(np.flatnonzero(strays), ABOARD, number)
        rows = self._rows(number, BOARDS, ABOARD, LEAVES)
        rows = rows[on_floor[rows]]
        if not len(rows):
            return
        inside = places[rows, 0] < 0.5 * shaft.depth
        self._set(rows[~inside], ON_FOOT, -1)
        self._set(rows[inside], ABOARD, number)
        move(rows[inside], self._floors.count + number)

    def _ride(
        self,
        number: int,
        shaft: Shaft,
        cabin: Cabin,
        floor: int,
        walks: NDArray[np.bool_],
        way_of: Callable[[int], Way | None],
        move: Callable[[Indices, int], None],
    ) -> None:
        """Let those in the cabin press the buttons of their floors, and leave there."""
        aboard = self._rows(number, ABOARD)
        if floor >= 0 and len(aboard):
            move(aboard, floor)
        for row in aboard[walks[aboard]].tolist():
            found = way_of(row)
            target = self._exit(number, found) if found is not None else -1
            if target < 0 or target == floor:
                if cabin.local_data["openness"] == 1.0 and floor >= 0:
                    self._set(np.array([row]), LEAVES, number)
            else:
                cabin.call(int(shaft.stops[target]))

    def _stops(self, number: int) -> Indices:
        """Return the floors of the cells of the link of a lift."""
        link, width = self._ground.links[number], self._ground.shape[1]
        floors: Indices = (link.cells % width) // (width // self._ground.parts)
        return floors

    def _exit(self, number: int, way: Way) -> int:
        """Return the floor where somebody leaves a lift; -1 if none leads to the goal."""
        times = way.time.ravel()[self._ground.links[number].cells]
        best = int(times.argmin()) if len(times) else -1
        return int(self._stops(number)[best]) if best >= 0 and np.isfinite(times[best]) else -1

    def _leads_through(
        self, number: int, shaft: Shaft, row: int, way: Way, walkers: Walkers, *, is_there: bool
    ) -> bool:
        """Whether the way of a person leads through a lift that is near."""
        floor, link = int(self.area[row]), self._ground.links[number]
        target, own = self._exit(number, way), np.flatnonzero(self._stops(number) == floor)
        if target in (-1, floor) or not len(own):
            return False
        times, there = way.time.ravel()[link.cells], int(np.flatnonzero(self._stops(number) == target)[0])
        # the stairs may be nearer
        if times[own[0]] < times[there] + link.costs[own[0], there] - 1e-6:
            return False
        left = float(self._ground.time(way, walkers.position[[row]])[0]) - float(times[own[0]])
        return is_there or -0.5 <= left < _JOINS + shaft.depth

    def _wait(
        self,
        number: int,
        shaft: Shaft,
        cabin: Cabin,
        floor: int,
        walkers: Walkers,
        walks: NDArray[np.bool_],
        led: NDArray[np.bool_],
        way_of: Callable[[int], Way | None],
    ) -> None:
        """Let people come whose way leads through the lift, or whose leader is in it, and call it."""
        near = walkers.position - self._floors.shift[self.area] - shaft.place[:2]
        reach = _JOINS + shaft.depth
        mine = (self.lift == number) & (self.ride == WAITS)
        # who waits thinks about it four times a second
        stays = mine & (self._context.clock.tick % _THINKS != 0)
        rows = np.flatnonzero(
            walks & ~stays & ((self.ride == ON_FOOT) & ((near * near).sum(axis=1) < reach * reach) | mine)
        )
        self._set(np.flatnonzero(mine & ~walks), ON_FOOT, -1)
        for row in rows.tolist():
            comes = bool(led[row] and self.area[row] == floor)
            way = None if comes else way_of(row)
            if way is not None:
                comes = self._leads_through(number, shaft, row, way, walkers, is_there=bool(mine[row]))
            if comes and not mine[row]:
                self._set(np.array([row]), WAITS, number)
                self.turn[row] = self.turn.max(initial=0) + 1
            elif mine[row] and not comes:
                self._set(np.array([row]), ON_FOOT, -1)
        for own in np.unique(self.area[self._rows(number, WAITS)]).tolist():
            if own != floor:
                cabin.call(int(shaft.stops[own]))

    def _board(self, number: int, shaft: Shaft, cabin: Cabin, floor: int, walkers: Walkers, places: Floats) -> None:
        """Let people out, and then others in, while the doors are open."""
        now, door = self._context.clock.time, 0.5 * shaft.depth
        out = self._rows(number, LEAVES)
        gone = places[out, 0] > door + _OUTSIDE
        self._set(out[gone], ON_FOOT, -1)
        out, into = out[~gone], self._rows(number, BOARDS)
        late = now - self.opened[number] > _PATIENCE
        back = into[late & (places[into, 0] > door - _INSIDE)]
        things = self._around.outlines_on(floor) if len(into) else []
        for row in into[(places[into, 0] < door + _ENTERS) & (self.slot[into] < 0)].tolist():
            # nobody overtakes in the cabin: places are given to those who come through the doors
            self.slot[row] = self._free_slot(number, shaft, row, walkers, things, places)
            if self.slot[row] < 0:
                back = np.append(back, row)
        self._set(back, WAITS, number)
        into = self._rows(number, BOARDS)
        arrived = into[np.abs(places[into] - self._place(shaft, into, walkers)).max(axis=1, initial=0.0) < _THERE]
        arrived = arrived[self.slot[arrived] >= 0]
        self.ride[arrived] = ABOARD
        if (len(out) or len(into) > len(arrived)) and not late:
            cabin.hold_doors(_HOLDS)
        line = self._rows(number, WAITS)
        apart = places[line] - np.array([door, 0.0])
        line = line[(self.area[line] == floor) & ((apart * apart).sum(axis=1) < _STRAIGHT**2)]
        if late or len(out) or len(back) or cabin.local_data["openness"] < 1.0 or not len(line):
            return
        room = shaft.capacity - len(self._rows(number, BOARDS, ABOARD)) - len(self._strangers(shaft, floor))
        line = line[np.argsort(self.turn[line], kind="stable")][: max(room, 0)]
        self._set(line, BOARDS, number)

    def _strangers(self, shaft: Shaft, floor: int) -> Floats:
        """Return the places (M, 2) of people of other crowds in the cabin, in its axes, m."""
        others = [shaft.local(one - self._floors.shift[floor]) for one in self._around.people_on(floor)]
        places = np.concatenate([np.zeros((0, 2)), *others])
        return np.asarray(places[(np.abs(places) < 0.5 * np.array([shaft.depth, shaft.width])).all(axis=1)])

    def _place(self, shaft: Shaft, rows: Indices, walkers: Walkers) -> Floats:
        """Return the places (R, 2) of people in a cabin, in its axes, m: who has none stays where he is."""
        room = np.maximum(0.5 * np.array([shaft.depth, shaft.width]) - 0.07 - walkers.radius[rows][:, None], 0.0)
        own = shaft.local(walkers.position[rows] - self._floors.shift[self.area[rows]])
        return np.where((self.slot[rows] >= 0)[:, None], np.clip(shaft.slots[self.slot[rows]], -room, room), own)

    def _free_slot(
        self, number: int, shaft: Shaft, row: int, walkers: Walkers, things: list[Floats], places: Floats
    ) -> int:
        """Return the best free place in the cabin for a person: deep in it, and near; -1 if there is none."""
        floor, radius = int(self.area[row]), float(walkers.radius[row])
        inside = self._rows(number, BOARDS, ABOARD)
        inside = inside[(self.slot[inside] >= 0) | (self.ride[inside] == ABOARD)]
        room = np.maximum(0.5 * np.array([shaft.depth, shaft.width]) - 0.07 - radius, 0.0)
        slots = np.clip(shaft.slots, -room, room)
        free = ~np.isin(np.arange(len(slots)), self.slot[inside])
        taken = zip(self._place(shaft, inside, walkers), walkers.radius[inside], strict=True)
        for spot, other in [*taken, *((one, 0.2) for one in self._strangers(shaft, floor))]:
            apart = slots - spot
            free &= (apart * apart).sum(axis=1) > (radius + other - 0.02) ** 2
        for outline in things:
            free &= distance_to(outline, shaft.world(slots) + self._floors.shift[floor]) > radius
        found = np.flatnonzero(free)
        if not len(found):
            return -1
        cost = slots[found, 0] + 0.5 * np.abs(slots[found, 1] - places[row, 1])
        return int(found[cost.argmin()])

    def _aim(self, number: int, shaft: Shaft, walkers: Walkers, places: Floats) -> None:
        """Set where those want to go who wait, enter or stand in the cabin."""
        door, half = 0.5 * shaft.depth, 0.5 * shaft.width
        for own, line in enumerate(self._spots[number]):
            rows = self._rows(number, WAITS)
            rows = rows[self.area[rows] == own]
            if not len(rows):
                continue
            order = np.argsort(np.argsort(self.turn[rows], kind="stable"), kind="stable")
            targets = line[np.minimum(order, len(line) - 1)]
            apart = targets - walkers.position[rows]
            near = (apart * apart).sum(axis=1) < _STRAIGHT**2
            walkers.wanted[rows[near]] = steps_to(walkers.position[rows], targets)[near]
        rows = self._rows(number, BOARDS, ABOARD)
        if not len(rows):
            return
        aims = self._place(shaft, rows, walkers)
        comes = (self.ride[rows] == BOARDS) & (self.slot[rows] < 0)
        aims[comes] = np.stack([np.full(int(comes.sum()), door - _INSIDE), 0.6 * places[rows[comes], 1]], axis=1)
        # through the middle of the doors, not through what is beside them
        is_aside = (places[rows, 0] > door - 0.1) & (np.abs(places[rows, 1]) > half - 0.35)
        way_in = np.stack([np.full(len(rows), door + 0.5), np.clip(places[rows, 1], 0.45 - half, half - 0.45)], axis=1)
        steps = steps_to(places[rows], np.where(is_aside[:, None], way_in, aims))
        # who stands in the cabin looks at the doors
        rides = self.area[rows] >= self._floors.count
        walkers.wanted[rows] = shaft.turned(np.where(rides[:, None], np.array([1.0, 0.0]), steps))

    def forget(self, person: int) -> None:
        """Let a person have nothing to do with lifts, who is on the floor where the cabin is if it was aboard."""
        if self.is_carried()[person]:
            self.area[person] = self._floors.floor_of(float(self._floors.heights[self.area[person]]))
        self._set(np.array([person]), ON_FOOT, -1)

    def cabin_at(self, place: Sequence[float]) -> int:
        """Return the number of the lift in whose cabin a place (3,) of the world is, m; -1 if it is in none."""
        for number, shaft in enumerate(self._floors.shafts):
            (x, y), rise = shaft.local(np.array([place[:2]]))[0].tolist(), place[2] - self._cabin_height(number)
            if abs(x) < 0.5 * shaft.depth and abs(y) < 0.5 * shaft.width and -_INSIDE < rise < HEIGHT:
                return number
        return -1

    def _cabin_height(self, number: int) -> float:
        return float(self._floors.heights[self._floors.count + number])

    def carried(self) -> Indices:
        """Return who stands in a cabin whose doors are closed."""
        return np.flatnonzero(self.is_carried())

    def is_carried(self) -> NDArray[np.bool_]:
        """Return (N,) who stands in a cabin whose doors are closed."""
        count = self._floors.count
        return np.asarray((self.area >= count) & (self.area < count + len(self._floors.shafts)))

    def speeds(self) -> Floats:
        """Return the vertical speeds (N,) of people, m/s."""
        speeds = np.zeros(len(self.area))
        for number, shaft in enumerate(self._floors.shafts):
            cabin = self.cabin_of(shaft)
            if cabin is not None:
                speeds[self.area == self._floors.count + number] = cabin.local_data["speed"]
        return speeds
