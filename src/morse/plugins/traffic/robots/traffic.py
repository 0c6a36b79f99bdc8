"""Traffic: cars on the lanes of roads."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.exceptions import MorseError, MorseRPCInvokationError
from morse.core.reports.quoting import nearest
from morse.core.robot import Robot
from morse.core.services import service
from morse.core.state import StateError
from morse.core.validation.arguments import Range
from morse.core.values import Fields
from morse.helpers.components import add_data, add_property
from morse.plugins.traffic.crossings import Cars, Crossings, Zebra, lines
from morse.plugins.traffic.driving import Driver, Things, advance, follower, leaders, sort
from morse.plugins.traffic.roads import WIDTH, Road
from morse.scene import PhysicsType
from morse.scene.extent import extent

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.interfaces import Carrier
    from morse.core.values import StateData
    from morse.core.world import Body

    Floats = NDArray[np.float64]

#: ticks between two decisions of a driver to change lanes; s that a change takes
_DECIDES, _CHANGES = 30, 3.0
#: m/s²: a driver brakes at a yellow light if that is enough
_YELLOW = 3.0
#: m: how near to a stop line nobody changes lanes, how far away others are seen, where cars wait that are not on a road
_CLOSE, _FAR, _OUTSIDE = 20.0, 120.0, -200.0
#: m: half of the room that somebody takes, and what is added to its width
_PERSON, _MARGIN, _LARGEST = 0.3, 0.2, 5.0
#: m: what is so far above or below a road is not on it
_ABOVE = 3.0
_STOPS = ("red", "red-yellow")

_Car = Annotated[int, Range(-1, 10_000)]


class Bodies(NamedTuple):
    """What is on, or beside, roads.

    Attributes:
        points: (M, 2) of their middles, m.
        half: (M, 2) half of their length and of their width, m.
        ways: (M, 2) directions of their lengths; 0 for what takes that room in all directions.
        velocities: (M, 2) m/s.
    """

    points: Floats
    half: Floats
    ways: Floats
    velocities: Floats

    def seen_along(self, way: Floats) -> Floats:
        """Return half of their extents (M, 2) along directions (M, 2), and across them, m."""
        cosine = np.abs((self.ways * way).sum(axis=1))
        sine = np.abs(self.ways[:, 0] * way[:, 1] - self.ways[:, 1] * way[:, 0])
        long, wide = self.half.T
        turned = np.stack([cosine * long + sine * wide, sine * long + cosine * wide], axis=1)
        return np.where((self.ways != 0.0).any(axis=1)[:, None], turned, self.half)


class Traffic(Robot):
    """Cars that drive on the lanes of roads, and brake for everything on their lane.

    They follow each other by the Intelligent Driver Model and change lanes by MOBIL (`morse.plugins.traffic.driving`).
    """

    _name = "Traffic"
    _short_desc = "Cars on lanes that follow each other, change lanes and stop at red lights"
    _builder = RobotDefaults(drive="free", builder="morse.plugins.traffic.builder.Traffic")

    add_data("positions", np.zeros((0, 3)), "list", "Middles of the cars, on the road", unit="m", frame="world",
             shape=(None, 3), dtype="float64")  # fmt: skip
    add_data("velocities", np.zeros((0, 3)), "list", "Velocities", unit="m/s", frame="world", shape=(None, 3),
             dtype="float64")  # fmt: skip
    add_data("present", np.zeros(0, dtype=bool), "list", "Which cars are on a road", shape=(None,), dtype="bool")
    add_data(
        "roads", np.zeros(0, dtype=np.int32), "list", "Number of the road of each car", shape=(None,), dtype="int32"
    )
    add_data("lanes", np.zeros(0, dtype=np.int32), "list", "Lane, from 0 at the right", shape=(None,), dtype="int32")
    add_data("places", np.zeros(0), "list", "Places of the front bumpers along their roads", unit="m", shape=(None,),
             dtype="float64")  # fmt: skip
    add_data("speeds", np.zeros(0), "list", "Speeds", unit="m/s", shape=(None,), dtype="float64")
    add_data("gaps", np.zeros(0), "list", "Distance to what is ahead on the lane", unit="m", shape=(None,),
             dtype="float64", allow=("inf",))  # fmt: skip

    _headway: float
    _acceleration: float
    _deceleration: float
    _gap: float
    _politeness: float
    _bias: float
    _deviation: float
    _plan: str
    _stop_lines: str
    _rules: str
    _zebras: str
    _sizes: str
    add_property("_headway", 1.6, "Headway", "float", "Time gap to the car ahead", unit="s", low=0.1, high=20.0)
    add_property("_acceleration", 0.73, "Acceleration", "float", "Acceleration", unit="m/s^2", low=0.05, high=8.0)
    add_property("_deceleration", 1.67, "Deceleration", "float", "Deceleration", unit="m/s^2", low=0.05, high=8.0)
    add_property("_gap", 2.0, "Gap", "float", "Gap between bumpers at rest", unit="m", low=0.1, high=50.0)
    add_property("_politeness", 0.3, "Politeness", "float", "Weight of the losses of others", low=0.0, high=1.0)
    add_property("_bias", 0.0, "Bias", "float", "Preference for the right lane", unit="m/s^2", low=-5.0, high=5.0)
    add_property("_deviation", 0.0, "Deviation", "float", "Deviation of desired speeds, share", low=0.0, high=0.3)
    add_property("_plan", "{}", "Roads", "string", "Roads as JSON", written_by="Traffic.road(...)")
    add_property("_stop_lines", "[]", "Stops", "string", "Stop lines as JSON", written_by="Traffic.stop(...)")
    add_property("_rules", "[]", "Rules", "string", "Roads that cross, and those with priority, as JSON",
                 written_by="Traffic.right_of_way(...)")  # fmt: skip
    add_property("_zebras", "[]", "Zebras", "string", "Zebra crossings as JSON", written_by="Traffic.zebra(...)")
    add_property("_sizes", "[]", "Lengths", "string", "Lengths of the cars, m, as JSON",
                 written_by="Traffic.road(count=...)")  # fmt: skip

    not_state: ClassVar[tuple[str, ...]] = ("local_data",)

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        # read once: clients may change properties while the simulation runs
        plan: dict[str, dict[str, Any]] = json.loads(self._plan)
        self._names = list(plan)
        self._roads = [
            Road(np.array(one["points"]), one["lanes"], one["width"], closed=one["closed"]) for one in plan.values()
        ]
        self._limits = np.array([one["speed"] for one in plan.values()] or [0.0])
        self._begin = np.add.accumulate([0, *(road.lanes for road in self._roads)])
        self._around = np.array([road.length if road.closed else 0.0 for road in self._roads] or [0.0])
        self._stops: list[tuple[int, float, str]] = [
            (self._names.index(road), place, light) for road, place, light in json.loads(self._stop_lines)
        ]
        self._crossings = [
            [other for other in range(len(self._roads)) if self._cross(number, other)]
            for number in range(len(self._roads))
        ]
        self._length = np.array(json.loads(self._sizes), dtype=np.float64)
        count = len(self._length)
        number_of = self._names.index
        rules = [([*map(number_of, one)], [*map(number_of, first)]) for one, first in json.loads(self._rules)]
        zebras = [Zebra(number_of(road), place, width) for road, place, width in json.loads(self._zebras)]
        crossed = lines(self._roads, rules)
        passes = np.zeros((count, len(crossed)), bool)
        self._right_of_way = Crossings(self._roads, crossed, zebras, passes, np.full(count, np.inf))
        nodes = [node for node in obj.node.children if node.body.type is PhysicsType.KINEMATIC]
        self._rows = self.context.world.kinematic_bodies([self.context.world.object_of(node) for node in nodes])
        self._height = float(obj.world_pose()[0][2])
        self._sides: WeakKeyDictionary[Carrier, tuple[float, float]] = WeakKeyDictionary()
        self.driver = Driver(
            self._headway, self._acceleration, self._deceleration, self._gap, self._politeness, bias=self._bias
        )
        draw = self.context.random(self.name()).normal(0.0, 1.0, count)
        self.factor = 1.0 + np.clip(draw, -2.0, 2.0) * self._deviation
        self.road = np.repeat(np.arange(len(plan)), [one["count"] for one in plan.values()]).astype(np.int64)
        self.lane, self.before = np.zeros(count, np.int64), np.zeros(count, np.int64)
        self.front, self.speed, self.left = np.zeros(count), np.zeros(count), np.zeros(count)
        self.there, self.held = np.ones(count, bool), np.zeros(count, bool)
        #: s, time from which a car that waits outside may enter
        self.enters = np.zeros(count)
        for number, one in enumerate(plan.values()):
            self._settle(number, one["over"])
        self._gaps = np.full(count, np.inf)
        self._drift = np.zeros(count)
        self.there &= ~self._right_of_way.begins_inside(self._seen(self._gaps, np.zeros(count)))
        self._show()

    def _cross(self, number: int, other: int) -> bool:
        """Whether two roads, or parts of one, come so near to each other that cars may meet."""
        one, two = self._roads[number], self._roads[other]
        along = np.arange(0.0, one.length, 1.0)
        reach = 0.5 * (one.width * one.lanes + two.width * two.lanes) - 0.5
        left = two.project(one.places(along)[0], along if one is two else None)[1]
        return bool((np.abs(left) < reach).any())

    def _settle(self, number: int, over: float) -> None:
        """Place the cars of a road evenly on its lanes, or let them wait."""
        road, rows = self._roads[number], np.flatnonzero(self.road == number)
        if over:
            self.there[rows] = False
            self.enters[rows] = np.sort(self.context.random(f"{self.name()} {number}").random(len(rows))) * over
            return
        for lane in range(road.lanes):
            own = rows[lane :: road.lanes]
            if not len(own):
                continue
            free = (road.length - self._length[own].sum()) / len(own)
            # from the end of the road backwards, so that an open road is filled too
            used = np.add.accumulate(self._length[own] + free)
            self.front[own], self.lane[own], self.before[own] = road.length + free - used, lane, lane
            self.speed[own] = min(max(free - self.driver.gap, 0.0) / self.driver.headway, self._limits[number])
        self.left[rows] = road.offset(self.lane[rows].astype(np.float64))

    # -- services --------------------------------------------------------------------------

    @service(changes=False)
    def get_local_data(self) -> Fields:
        """The present data."""
        return dict(self.local_data)

    @service
    def hold(self, car: _Car = -1) -> None:
        """Let a car brake and stand, or all cars.

        Args:
            car: its number; -1 for all.
        """
        self.held[self._chosen(car)] = True

    @service
    def go(self, car: _Car = -1) -> None:
        """Let a car, or all cars, that were held drive on.

        Args:
            car: its number; -1 for all.
        """
        self.held[self._chosen(car)] = False

    def _chosen(self, car: int) -> slice:
        if car >= len(self.held):
            raise MorseRPCInvokationError(f"{self.name()} has the cars 0 to {len(self.held) - 1}, not {car}")
        return slice(None) if car < 0 else slice(car, car + 1)

    @service
    def limit(self, road: str, speed: Annotated[float, Range(0.5, 80.0, "m/s")]) -> None:
        """Set the speed that drivers desire on a road.

        Args:
            road: its name.
            speed: m/s.
        """
        if road not in self._names:
            raise MorseRPCInvokationError(f"{self.name()} has no road '{road:.80}'{nearest(road, self._names)}")
        self._limits[self._names.index(road)] = speed

    # -- a tick ----------------------------------------------------------------------------

    def default_action(self) -> None:
        """Drive for a tick."""
        if not len(self.road):
            return
        self._enter()
        things = self._things()
        lane = self._begin[self.road] + self.lane
        around = self._around[self.road]
        cars = np.arange(len(lane))
        desired = self._limits[self.road] * self.factor
        gap, ahead = leaders(things, lane, self.front, around, cars)
        acceleration = self.driver.accelerations(self.speed, desired, gap, self.speed - ahead)
        moves = np.flatnonzero(self.there & (self.before != self.lane))
        if len(moves):
            # who changes lanes keeps clear of both
            there = self._begin[self.road[moves]] + self.before[moves]
            apart, other = leaders(things, there, self.front[moves], around[moves], moves)
            own = self.driver.accelerations(self.speed[moves], desired[moves], apart, self.speed[moves] - other)
            acceleration[moves], gap[moves] = np.minimum(acceleration[moves], own), np.minimum(gap[moves], apart)
        gap, acceleration = self._stop_at_lights(gap, acceleration, desired)
        if self._right_of_way.lines or self._right_of_way.zebras:
            room = self._right_of_way.room(self._seen(gap, ahead), self.driver, self._beside, self.clock.time)
            gap, acceleration = self._stop_before(room, room < gap, gap, acceleration, desired)
        acceleration = np.where(self.held, np.minimum(acceleration, -self.driver.deceleration), acceleration)
        self._change_lanes(things, acceleration, desired)
        front, speed = advance(self.front, self.speed, acceleration, self.clock.period)
        self.front, self.speed = np.where(self.there, front, self.front), np.where(self.there, speed, 0.0)
        self._gaps = np.where(self.there, gap, np.inf)
        self._steer()
        self._leave()
        self._show()

    def _seen(self, gap: Floats, ahead: Floats) -> Cars:
        """Return the cars, as their drivers see them, with the gaps to what is ahead, m, and its speeds, m/s."""
        desired = self._limits[self.road] * self.factor
        return Cars(*(self.road, self.there, self.front, self._length, self.speed, desired, self.lane, gap, ahead))

    def _things(self) -> Things:
        """Return all that is on the lanes."""
        there = np.flatnonzero(self.there)
        moves = there[self.before[there] != self.lane[there]]
        both = np.concatenate([there, moves])
        begin = self._begin[self.road[both]]
        lane = begin + np.concatenate([self.lane[there], self.before[moves]])
        front = self.front[both]
        parts = [(lane, front, front - self._length[both], self.speed[both], both)]
        others = self._beside = self._others()
        for number, crossings in enumerate(self._crossings):
            if len(others.points):
                parts += self._on_road(number, others)
            for other in crossings:
                cars = np.flatnonzero(self.there & (self.road == other))
                if len(cars):
                    crossing = self.bodies(cars)
                    parts += self._on_road(number, crossing, self.front[cars] if other == number else None)
        return sort(*(np.concatenate(values) for values in zip(*parts, strict=True)))

    def bodies(self, cars: NDArray[np.int64]) -> Bodies:
        """Return the room that some of the cars take."""
        data = self.local_data
        half = np.stack([0.5 * self._length[cars], np.full(len(cars), 0.5 * WIDTH)], axis=1)
        return Bodies(data["positions"][cars, :2], half, self._ways[cars], data["velocities"][cars, :2])

    def _on_road(
        self, number: int, bodies: Bodies, beside: Floats | None = None
    ) -> list[tuple[NDArray[np.int64], Floats, Floats, Floats, NDArray[np.int64]]]:
        """Return what stands or moves on the lanes of a road, besides its cars; ``beside``: see `Road.project`."""
        road = self._roads[number]
        place, left, way = road.project(bodies.points, beside)
        along = (bodies.velocities * way).sum(axis=1)
        half = bodies.seen_along(way)
        found = []
        for lane in range(road.lanes):
            middle = float(road.offset(np.array(float(lane))))
            on = np.abs(left - middle) < 0.5 * WIDTH + _MARGIN + half[:, 1]
            if on.any():
                front = place[on] + half[on, 0]
                lanes = np.full(int(on.sum()), int(self._begin[number]) + lane)
                found.append((lanes, front, front - 2.0 * half[on, 0], along[on], np.full(len(lanes), -1)))
        return found

    def _others(self) -> Bodies:
        """Return the robots and people near the height of the roads, and the cars of other components."""
        found = [Bodies(*(np.zeros((0, 2)) for _ in range(4)))]
        for robot in self.context.robots.values():
            data = robot.local_data
            if robot is self or data.get("openness") == 1.0:
                continue
            if "present" in data and "positions" in data:
                near = np.asarray(data["present"], bool)
                place = np.reshape(np.asarray(data["positions"], np.float64), (-1, 3))
                near &= np.abs(place[:, 2] - self._height) < _ABOVE
                if isinstance(robot, Traffic):
                    found.append(robot.bodies(np.flatnonzero(near)))
                    continue
                count, moves = int(near.sum()), np.reshape(np.asarray(data["velocities"], np.float64), (-1, 3))
                round_ = np.full((count, 2), _PERSON), np.zeros((count, 2))
                found.append(Bodies(place[near, :2], *round_, moves[near, :2]))
                continue
            place = np.array(robot.bge_object.world_pose()[0])
            if abs(place[2] - self._height) > _ABOVE + _LARGEST:
                continue
            half, velocity = np.array([self._size(robot)]), np.array([robot.bge_object.velocity()[0][:2]])
            found.append(Bodies(place[None, :2], half, np.zeros((1, 2)), velocity))
        return Bodies(*(np.concatenate(values) for values in zip(*found, strict=True)))

    def _size(self, robot: Carrier) -> tuple[float, float]:
        """Half of the room that a robot takes, whatever its direction, m."""
        if robot not in self._sides:
            node = robot.bge_object.node
            corners = extent(node.walk(), node)
            reach = 0.3
            if corners is not None:
                low, high = np.array(corners)
                reach = min(max(float(np.maximum(np.abs(low), np.abs(high))[:2].max()), 0.1), _LARGEST)
            self._sides[robot] = reach, reach
        return self._sides[robot]

    def check_scene(self) -> None:
        """Check that all traffic lights exist."""
        for _, _, name in self._stops:
            if self.context.component(name) is None:
                names = [*self.context.robots, *self.context.components]
                raise MorseError(f"{self.name()}: there is no traffic light '{name:.80}'{nearest(name, names)}")

    def _stop_at_lights(self, gap: Floats, acceleration: Floats, desired: Floats) -> tuple[Floats, Floats]:
        for number, place, name in self._stops:
            light = self.context.component(name)
            if light is None:
                # it has left the scene
                continue
            state = light.local_data.get("state")
            if state not in (*_STOPS, "yellow"):
                continue
            apart = place - self.front
            if self._around[number]:
                apart = apart - np.floor(apart / self._around[number]) * self._around[number]
            waits = (self.road == number) & (apart >= 0.0) & (apart < gap)
            if state == "yellow":
                waits &= self.speed * self.speed <= 2.0 * _YELLOW * np.maximum(apart, 0.01)
            gap, acceleration = self._stop_before(apart, waits, gap, acceleration, desired)
        return gap, acceleration

    def _stop_before(
        self, apart: Floats, waits: NDArray[np.bool_], gap: Floats, acceleration: Floats, desired: Floats
    ) -> tuple[Floats, Floats]:
        """Return gaps and accelerations of cars, of which some stop at a line that is so far ahead, m."""
        # the driver stops with the bumper near the line, not with the gap to a car
        line = np.where(waits, apart, 1.0)
        own = self.driver._replace(gap=0.5).accelerations(self.speed, desired, line, self.speed)
        return np.where(waits, apart, gap), np.where(waits, np.minimum(acceleration, own), acceleration)

    def _change_lanes(self, things: Things, acceleration: Floats, desired: Floats) -> None:
        """Let drivers whose turn it is decide, one after the other."""
        tick = round(self.clock.time / self.clock.period)
        asks = self.there & (self.before == self.lane) & ((tick + np.arange(len(self.lane))) % _DECIDES == 0)
        asks &= np.array([road.lanes > 1 for road in self._roads] or [False])[self.road] & ~self.held
        for number, place, _ in self._stops:
            asks &= ~((self.road == number) & (np.abs(place - self.front) < _CLOSE))
        for car in np.flatnonzero(asks).tolist():
            road = self._roads[self.road[car]]
            for side in (1, -1):
                lane = int(self.lane[car]) + side
                if 0 <= lane < road.lanes and self._is_worth_it(things, car, lane, side, acceleration, desired):
                    self.lane[car] = lane
                    things = self._things()
                    break

    def _is_worth_it(
        self, things: Things, car: int, lane: int, side: int, acceleration: Floats, desired: Floats
    ) -> bool:
        road = int(self.road[car])
        begin, around = int(self._begin[road]), float(self._around[road])
        front, rear = float(self.front[car]), float(self.front[car] - self._length[car])
        one = np.array([car])

        def ahead_of(row: int, number: int, place: float) -> tuple[float, float]:
            gap, speed = leaders(things, np.array([number]), np.array([place]), np.array([around]), np.array([row]))
            return float(gap[0]), float(speed[0])

        def accelerated(row: int, gap: float, speed: float) -> float:
            own = float(self.speed[row])
            return float(self.driver.accelerations(own, float(desired[row]), gap, own - speed))

        def behind(number: int) -> tuple[int, float]:
            """The follower of the car on a lane, and the gap between them, m."""
            row = follower(things, number, front, around, car)
            if row < 0:
                return row, np.inf
            gap = rear - float(self.front[row])
            return row, gap + around if around and self.front[row] > front else gap

        new_row, new_gap = behind(begin + lane)
        gap, speed = ahead_of(car, begin + lane, front)
        if min(gap, new_gap) < self.driver.gap:
            return False
        own = float(acceleration[one][0]), accelerated(car, gap, speed)
        new = old = (0.0, 0.0)
        if new_row >= 0:
            new = float(acceleration[new_row]), accelerated(new_row, new_gap, float(self.speed[car]))
        old_row, old_gap = behind(begin + int(self.lane[car]))
        if old_row >= 0:
            apart, speed = ahead_of(car, begin + int(self.lane[car]), front)
            old = float(acceleration[old_row]), accelerated(old_row, old_gap + self._length[car] + apart, speed)
        return self.driver.wants_change(own, new, old, side)

    def _steer(self) -> None:
        """Move towards the middle of the lane."""
        width = np.array([road.width for road in self._roads] or [1.0])[self.road]
        lanes = np.array([road.lanes for road in self._roads] or [1])[self.road]
        apart = (self.lane - 0.5 * (lanes - 1)) * width - self.left
        rate = np.minimum(width / _CHANGES, 0.3 * self.speed)
        step = np.clip(apart, -rate * self.clock.period, rate * self.clock.period)
        self.left = self.left + step
        self._drift = np.where(self.speed > 0.5, step / np.maximum(self.speed * self.clock.period, 1e-6), 0.0)
        self.before = np.where(np.abs(apart) < 0.25 * width, self.lane, self.before)

    def _leave(self) -> None:
        """Let cars at the end of an open road wait to enter it again; on closed roads, count from the beginning."""
        around = self._around[self.road]
        self.front = np.where((around > 0.0) & (self.front >= around), self.front - around, self.front)
        length = np.array([road.length for road in self._roads] or [0.0])[self.road]
        gone = self.there & (around == 0.0) & (self.front - self._length > length)
        self.there &= ~gone
        self.enters = np.where(gone, self.clock.time, self.enters)
        self.before = np.where(gone, self.lane, self.before)

    def _enter(self) -> None:
        """Let one car of each road enter, on the lane with most room."""
        waiting = ~self.there & (self.enters <= self.clock.time)
        if not waiting.any():
            return
        things = self._things()
        for number in np.unique(self.road[waiting]).tolist():
            rows = np.flatnonzero(waiting & (self.road == number))
            row = int(rows[np.argmin(self.enters[rows])])
            road = self._roads[number]
            lanes = np.arange(road.lanes)
            zeros = np.zeros(road.lanes)
            gap, ahead = leaders(things, self._begin[number] + lanes, zeros, zeros, np.full(road.lanes, row))
            best = int(gap.argmax())
            desired = float(self._limits[number] * self.factor[row])
            speed = min(desired, float(ahead[best])) if np.isfinite(gap[best]) else desired
            if gap[best] < self.driver.gap + speed * self.driver.headway:
                continue
            self.there[row], self.front[row], self.speed[row] = True, 0.0, speed
            self.lane[row] = self.before[row] = best
            self.left[row] = float(road.offset(np.array(float(best))))

    def _show(self) -> None:
        count = len(self.road)
        positions, velocities = np.zeros((count, 3)), np.zeros((count, 3))
        ways = np.tile((1.0, 0.0), (count, 1))
        positions[:] = self._height
        positions[~self.there, 2] = _OUTSIDE
        for number, road in enumerate(self._roads):
            rows = np.flatnonzero(self.there & (self.road == number))
            if len(rows):
                middle, way = road.poses(self.front[rows], self.left[rows], self._drift[rows], self._length[rows])
                positions[rows, :2], ways[rows] = middle, way
                velocities[rows, :2] = way * self.speed[rows, None]
        if count:
            # half of the angle of the direction
            w = np.sqrt(np.maximum(0.5 * (1.0 + ways[:, 0]), 0.0))
            z = np.copysign(np.sqrt(np.maximum(0.5 * (1.0 - ways[:, 0]), 0.0)), ways[:, 1])
            zeros = np.zeros(count)
            shown = positions.copy()
            # those that wait stand side by side
            shown[~self.there, 0] = 20.0 * np.flatnonzero(~self.there)
            self._rows.place(shown, np.stack([w, zeros, zeros, z], axis=1), velocities)
        data = self.local_data
        self._ways = ways
        data["positions"], data["velocities"], data["present"] = positions, velocities, self.there.copy()
        data["roads"], data["lanes"] = self.road.astype(np.int32), self.lane.astype(np.int32)
        data["places"], data["speeds"], data["gaps"] = self.front.copy(), self.speed.copy(), self._gaps.copy()

    # -- states ----------------------------------------------------------------------------

    def _arrays(self) -> dict[str, NDArray[Any]]:
        names = ("lane", "before", "front", "speed", "left", "there", "held", "enters", "factor", "_limits", "_drift")
        found: dict[str, NDArray[Any]] = {name: getattr(self, name) for name in (*names, "_gaps")}
        return found | {"passes": self._right_of_way.passes, "since": self._right_of_way.since}

    def get_state(self) -> StateData:
        """See `Object.get_state`."""
        state = super().get_state()
        state["cars"] = {name: values.copy() for name, values in self._arrays().items()}
        return state

    def set_state(self, state: StateData) -> None:
        """See `Object.set_state`.

        Raises:
            StateError: the cars of the state are not those of the scene.
        """
        state = dict(state)
        cars = state.pop("cars", None)
        arrays = self._arrays()
        if not isinstance(cars, dict) or cars.keys() != arrays.keys():
            raise StateError(f"the cars of {self.name()} are missing")
        for name, present in arrays.items():
            given = cars[name]
            fits = isinstance(given, np.ndarray) and given.dtype == present.dtype and given.shape == present.shape
            # nothing may be ahead, and who does not wait has no time of that
            known = given[~np.isinf(given)] if fits and name in ("_gaps", "since") else given
            if not fits or not np.isfinite(known).all() or (np.abs(known.astype(np.float64)) > 1e6).any():
                raise StateError(f"the cars of {self.name()} have another '{name}'")
        lanes = np.array([road.lanes for road in self._roads] or [1])[self.road]
        if any(((cars[name] < 0) | (cars[name] >= lanes)).any() for name in ("lane", "before")):
            raise StateError(f"the cars of {self.name()} are on lanes that do not exist")
        if any((cars[name] < 0.0).any() for name in ("speed", "front", "_limits", "factor")):
            raise StateError(f"the cars of {self.name()} are where, or as fast as, no car can be")
        super().set_state(state)
        for name in arrays:
            owner = self._right_of_way if name in ("passes", "since") else self
            setattr(owner, name, cars[name].copy())
        self._show()
