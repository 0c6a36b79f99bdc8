"""A crowd of people."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.exceptions import MorseError, MorseRPCInvokationError
from morse.core.limits import Position
from morse.core.reports.quoting import nearest as nearest_name
from morse.core.robot import Robot
from morse.core.services import service
from morse.core.state import StateError
from morse.core.validation.arguments import Range
from morse.helpers.components import add_data, add_property, add_state
from morse.plugins.people.contacts import Places, Surroundings, can_touch
from morse.plugins.people.errands import HERE, NEVER, STANDS_UP, Queue, line_back, phases, sit_down, steps_to
from morse.plugins.people.floors import MOST_FLOORS, Floors
from morse.plugins.people.following import MOST_LEADERS, Trails, aims, can_be, note
from morse.plugins.people.gait import Gait
from morse.plugins.people.recorded import FASTEST, Tracks, checked
from morse.plugins.people.riding import ON_FOOT, Riding
from morse.plugins.people.riding import WORDS as RIDES
from morse.plugins.people.walking import Orca, SocialForce, Walkers, length
from morse.plugins.people.wayfinding import Ground, Way, inside, walls
from morse.scene import PhysicsType

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.values import StateData
    from morse.core.world import Body
    from morse.scene import Node

    Floats = NDArray[np.float64]

#: what a person does
WALKS, STOPPED, SENT, WAITS, ARRIVED, GONE, OUTSIDE, LEFT_OUT, RECORDED, QUEUES, SITS, FOLLOWS = range(12)
_WORDS = (
    "walks",
    "stopped",
    "sent",
    "waits",
    "arrived",
    "gone",
    "outside",
    "left out",
    "recorded",
    "queues",
    "sits",
    "follows",
)
_ABSENT = (GONE, OUTSIDE, LEFT_OUT)
#: m, around starts and goals, in which ways are searched
_AROUND = 12.0
#: m: a person has arrived; m: how far from a solid object people stop who go to it
_ARRIVES, _BESIDE = 0.4, 3.0
#: m: people who are that near to a goal come there at the same time
_CROWDED = 1.5
#: m: nobody begins in something of at least that height
_FLAT = 0.05
#: m² for each person, m, m: a start area without a script, its least half, and the depth of the goals at its sides
_OWN_ROOM, _OWN_HALF, _OWN_GOAL = 3.0, 3.0, 1.0
#: tries for each person to find a free place; places to enter at, one after the other
_TRIES, _DOORS = 400, 12
#: s: a contact that lasts longer is a pressure, not an impact (ISO/TS 15066, 5.5.4)
_IMPACT = 0.5
#: kg of a man of 1.75 m; the mass goes with the square of the height
_MASS = 76.0
#: most ways that people were sent to, which are kept
_MOST_WAYS = 64

#: arrays of states: of the crowd itself; places and velocities, which are bounded
_OWN = ("flow", "stage", "mode", "until", "target", "came", "rank", "alert")
_PLACES = ("position", "feet", "target", "came", "planned")

_Person = Annotated[int, Range(0, 5000)]


def _json(crowd: Crowd, name: str, text: str, kind: type) -> Any:
    """Return the value of a property that the script has written; raise `MorseError` if it is of another kind."""
    try:
        value = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise MorseError(f"{crowd.name()}: the property {name} is not JSON: {error}") from None
    if not isinstance(value, kind):
        raise MorseError(f"{crowd.name()}: the property {name} is no {kind.__name__}")
    return value


class Crowd(Robot):
    """People who walk to their goals, give way to each other and to robots, and are seen by sensors.

    Their places and free speeds follow from the seed of the run. They walk by a model of the literature, which
    `morse.plugins.people.walking` describes with its sources, around all that stands in the world. Lidars hit their
    legs and trunks, cameras and the live view show them. Contacts with robots push both, with the forces of
    ISO/TS 15066.
    """

    _name = "Crowd"
    _short_desc = "People who walk to their goals and give way to each other and to robots"
    _builder = RobotDefaults(drive="free", builder="morse.plugins.people.builder.Crowd")

    add_data(
        "positions",
        np.zeros((0, 3)),
        "list",
        "Where people stand, also those who are absent",
        unit="m",
        frame="world",
        shape=(None, 3),
        dtype="float64",
    )
    add_data(
        "velocities",
        np.zeros((0, 3)),
        "list",
        "Velocities",
        unit="m/s",
        frame="world",
        shape=(None, 3),
        dtype="float64",
    )
    add_data("present", np.zeros(0, dtype=bool), "list", "Who is in the world", shape=(None,), dtype="bool")
    add_data(
        "groups",
        np.zeros(0, dtype=np.int32),
        "list",
        "Number of the group; -1 for those who walk alone",
        shape=(None,),
        dtype="int32",
    )
    add_data(
        "contacts", [], "list", "Contacts with robots in this tick: person, robot, force (N), region, limit (N), point"
    )
    add_data("exceeded", 0, "int", "Contacts so far whose force was above the limit of ISO/TS 15066", low=0)

    _model: str
    _free_speed: float
    _deviation: float
    _radius: float
    _groups: float
    _heights: str
    _rides: int
    _plan: str
    _attention: str
    _levels: str
    add_property("_model", "social-force", "Model", "string", "How people walk", choices=("social-force", "orca"))
    add_property("_free_speed", 1.34, "Speed", "float", "Mean of the free speeds", unit="m/s", low=0.0, high=10.0)
    add_property(
        "_deviation", 0.26, "Deviation", "float", "Standard deviation of the free speeds", unit="m/s", low=0.0, high=3.0
    )
    add_property("_radius", 0.2, "Radius", "float", "Radius of a body seen from above", unit="m", low=0.1, high=1.0)
    add_property("_groups", 0.0, "Groups", "float", "Share of the people who walk in groups", low=0.0, high=1.0)
    add_property("_heights", "[]", "Heights", "string", "Heights of the people, m, as JSON",
                 written_by="Crowd(count=...)")  # fmt: skip
    add_property("_rides", 0, "Rides", "int", "Number of the first people, who sit in wheelchairs", low=0,
                 written_by="Crowd(wheelchairs=...)")  # fmt: skip
    add_property("_plan", "{}", "Plan", "string", "Starts and goals as JSON",
                 written_by="Crowd.start(...) and Crowd.goals(...)")  # fmt: skip
    add_property("_attention", "{}", "Attention", "string", "Share of the people who see a robot, by its name, as JSON",
                 written_by="Crowd.avoids(robot, attention)")  # fmt: skip
    add_property("_levels", "[0.0]", "Floors", "string", "Heights of the floors above the crowd, m, as JSON",
                 written_by="Crowd(floors=...)")  # fmt: skip

    add_state("_touching", dict, "Contacts of people and robots: begin (s), overlap without force, overlap (m)")
    add_state("_trails", dict, "Where those have been whom people follow, m, by their names")
    add_state("_reported", dict, "Contacts that were above the limit")

    not_state: ClassVar[tuple[str, ...]] = ("local_data",)

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        # read once: clients may change properties while the simulation runs
        heights = np.array(_json(self, "Heights", self._heights, list), dtype=np.float64)
        self._shares = {
            str(name): float(share) for name, share in _json(self, "Attention", self._attention, dict).items()
        }
        self._count = count = len(heights)
        trunks = [node for node in obj.node.children if node.body.type is PhysicsType.KINEMATIC]
        if len(trunks) != count:
            raise MorseError(f"{self.name()} has {len(trunks)} bodies and {count} heights: scripts write both")
        self._seconds = 1.0 / self.clock.frequency
        levels = _json(self, "Floors", self._levels, list)
        if not 1 <= len(levels) <= MOST_FLOORS or not all(isinstance(one, float | int) for one in levels):
            raise MorseError(
                f"{self.name()}: the property Floors has 1 to {MOST_FLOORS} heights: leave it as Crowd() writes it"
            )
        height = float(obj.world_pose()[0][2])
        self.floors = Floors([height + float(one) for one in levels], self.context.scene)
        self._law = Orca() if self._model == "orca" else SocialForce()
        self._touching: dict[str, tuple[float, float, float]] = {}
        self._reported: dict[str, bool] = {}
        self._trails: Trails = {}
        self._random = self.context.random(self.name())
        self._flows = self._read_plan()
        self._around = Surroundings(self.context, self.name(), self.floors, self._shares, lambda: self.alert)
        self.flow = np.full(count, -1, dtype=np.intp)
        self.stage = np.zeros(count, dtype=np.intp)
        self.mode = np.full(count, WALKS, dtype=np.intp)
        self.until = np.zeros(count)
        self.target = np.zeros((count, 2))
        self.came = np.zeros((count, 2))
        self.rank = np.zeros(count, dtype=np.intp)
        self.leader = np.full(count, -1, dtype=np.intp)
        self._ways: dict[bytes, Way] = {}
        rides = np.arange(count) < int(self._rides)
        radius = np.where(rides, np.maximum(0.38, self._radius), self._radius * np.minimum(heights / 1.7, 1.0) ** 0.5)
        self.ground = self._survey(float(radius.min(initial=1.0)))
        self.walkers = Walkers.at(self.ground, np.zeros((count, 2)), 0.0, radius)
        self.riding = Riding(self.context, self.floors, self.ground, self._around, count)
        self.walkers.mass = _MASS * (heights / 1.75) ** 2 + np.where(rides, 20.0, 0.0)
        self._settle(heights)
        heading = self.walkers.wanted.copy()
        heading[(heading == 0.0).all(axis=1)] = (1.0, 0.0)
        draw = self._random.random(count)
        self.gait = Gait.at(self.walkers.position, heading, heights, rides, np.floor(8.0 * draw))
        legs = [[node.children[side] for node in trunks if node.children] for side in (0, 1)]
        self._bodies = [self.context.world.object_of(node) for node in (*trunks, *legs[0], *legs[1])]
        self._rows = self.context.world.kinematic_bodies(self._bodies)
        self._shown = np.ones(count, dtype=bool)
        self._show()

    # -- the plan --------------------------------------------------------------------------

    def _read_plan(self) -> list[dict[str, Any]]:
        plan = _json(self, "Plan", self._plan, dict)
        flows = [dict(flow) for flow in plan.get("flows", ())]
        try:
            self._tracks = checked(plan)
        except ValueError as error:
            raise MorseError(f"{self.name()}: {error}") from None
        if self._tracks is not None:
            return []
        if not flows:
            flows = self._own_flows(with_goals=not plan.get("default"))
        default = plan.get("default") or {"goals": [], "then": "stay", "wait": 0.0}
        free = self._count - sum(flow["count"] or 0 for flow in flows)
        open_flows = [flow for flow in flows if flow["count"] is None]
        for number, flow in enumerate(open_flows):
            flow["count"] = free // len(open_flows) + (number < free % len(open_flows))
        for flow in flows:
            if flow["goals"] is None:
                flow.update(default)
        return phases(flows)

    def _own_flows(self, *, with_goals: bool) -> list[dict[str, Any]]:
        """Return the flows of a crowd without a start: in a square around its place, half along and half across it."""
        x, y = (float(one) for one in self.bge_object.world_pose()[0][:2])
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
        """Return the ground around the starts and goals, with the walls of the scene."""
        points: list[Floats] = [np.array(flow["area"])[:, :2] for flow in self._flows]
        points += [np.atleast_2d(goal)[:, :2] for flow in self._flows for goal in self._places(flow)]
        points += [shaft.world(shaft.slots) for shaft in self.floors.shafts]
        every = np.concatenate(points) if self._tracks is None else np.stack([self._tracks.low, self._tracks.high])
        low, high = every.min(axis=0) - _AROUND, every.max(axis=0) + _AROUND
        if float((high - low).max()) > 2000.0:
            raise MorseError(f"{self.name()}: starts and goals are {(high - low).max():.0f} m apart: at most 2000 m")
        robots = {declaration.node for declaration in self.context.scene.components if declaration.kind != "sensor"}
        fixed: list[Node] = []
        loose: list[Node] = []
        stack = [(root, False) for root in self.context.scene.roots]
        while stack:
            node, moves = stack.pop()
            moves |= node in robots or node.body.moves or node.body.type is PhysicsType.KINEMATIC
            if node.body.collides:
                (loose if moves else fixed).append(node)
            stack += [(child, moves) for child in node.children]
        heights = self.floors.heights[: self.floors.count].tolist()
        grounds = [
            Ground([*walls(fixed, one), *self.floors.walls(floor)], low, high, radius, len(heights))
            for floor, one in enumerate(heights)
        ]
        self.floors.spread(grounds[0].breadth, low, high)
        self._loose = [
            outline + shift
            for one, shift in zip(heights, self.floors.shift, strict=False)
            for outline in walls(loose, one, _FLAT)
            if len(heights) == 1 or self.floors.within(outline).any()
        ]
        ground = Ground.beside(grounds)
        self.floors.connect(ground)
        for flow in self._flows:
            flow["area"], flow["floor"] = self._on_plane(flow["area"])
            flow["places"] = [self._on_plane(place)[0] for place in self._places(flow)]
        return ground

    def _on_plane(self, goal: Any) -> tuple[Any, int]:
        try:
            return self.floors.on_plane(goal)
        except ValueError as error:
            raise MorseError(f"{self.name()}: {error}") from None

    def _places(self, flow: dict[str, Any]) -> list[Any]:
        """Return the goals of a flow as points and areas in the world."""
        found = []
        for goal in flow["goals"]:
            if isinstance(goal, str):
                objects = self.context.world.objects_by_name
                if goal not in objects:
                    raise MorseError(
                        f"{self.name()}: there is no object '{goal:.80}' to go to{nearest_name(goal, sorted(objects))}"
                    )
                x, y, z = objects[goal].world_pose()[0]
                found.append([x, y] if self.floors.count == 1 else [x, y, self._floor_below(z)])
            else:
                found.append(goal)
        return found

    def _floor_below(self, height: float) -> float:
        return float(self.floors.heights[self.floors.floor_of(height)])

    def _way_to(self, goal: Any) -> Way | None:
        """Return the way to a point or an area; None if nobody can stand there."""
        key = np.array(goal, dtype=np.float64)
        way = self._ways.get(key.tobytes())
        if way is not None:
            return way
        cells = self.ground.cells_beside(key, _BESIDE) if key.ndim == 1 else self.ground.cells_in(key)
        if not cells.any():
            return None
        if len(self._ways) >= _MOST_WAYS + sum(len(flow["goals"]) for flow in self._flows):
            self._ways.pop(next(reversed(self._ways)))
        way = self._ways[key.tobytes()] = self.ground.way_to(cells)
        return way

    def _settle(self, heights: Floats) -> None:
        """Give everybody a place, a speed and a group."""
        random, count = self._random, self._count
        speeds = np.clip(random.normal(0.0, 1.0, count), -2.0, 2.0) * self._deviation + self._free_speed
        small = heights < 1.5
        # children of 1.0 to 1.45 m: 80 to 95 % of the speed; wheelchairs: 1.08 m/s (Weidmann 1993; Boyce et al. 1999)
        speeds = np.where(small & (np.arange(count) >= int(self._rides)), speeds * (0.45 + 0.35 * heights), speeds)
        speeds = np.where(np.arange(count) < int(self._rides), speeds * 0.8, speeds)
        self.walkers.free_speed = np.maximum(speeds, 0.2)
        self.alert = random.random(count)
        self.walkers.position[:] = self.ground.origin
        begin = left_out = 0
        self._doors = np.zeros((count, _DOORS, 2))
        places = Places(self.ground, self._loose, self._around.crowds())
        for number, flow in enumerate(self._flows):
            rows = np.arange(begin, begin + flow["count"])
            begin += len(rows)
            self.flow[rows] = number
            self.riding.area[rows] = flow["floor"]
            flow["ways"] = self._ways_of(flow)
            if flow["then"] == "sit":
                self.stage[rows] = np.arange(len(rows)) % len(flow["goals"])
            self._make_groups(rows)
            area = np.array(flow["area"])
            if flow["over"]:
                self.mode[rows] = OUTSIDE
                self.until[rows] = np.sort(random.random(len(rows))) * flow["over"]
                for row in rows:
                    points = self._candidates(places, area, _DOORS, float(self.walkers.radius[row]))
                    self._doors[row] = points[np.arange(_DOORS) % len(points)] if len(points) else np.nan
                    left_out += not len(points)
                self.mode[rows[np.isnan(self._doors[rows, 0, 0])]] = LEFT_OUT
                continue
            for number_of_place, row in enumerate(rows):
                exact = area[number_of_place : number_of_place + 1] if flow["exact"] else None
                place = self._free_place(places, area, row, exact)
                if place is None:
                    self.mode[row] = LEFT_OUT
                    left_out += 1
                    continue
                self.walkers.position[row] = place
                places.take(place, float(self.walkers.radius[row]))
        self.mode[self.flow < 0] = LEFT_OUT
        if self._tracks is not None:
            self._follow(self._tracks, begins=True)
        if left_out:
            text = f"{self.name()}: {left_out} of {count} people are left out: the rest of their area is occupied"
            self.context.complaints.warn(text, text)
        self.walkers.present = ~np.isin(self.mode, _ABSENT)
        self._find_lost()
        self._look_ahead()

    def _ways_of(self, flow: dict[str, Any]) -> list[Way]:
        if flow.get("is_own"):
            # where there are walls, they go to what remains
            open_ones = [self._way_to(place) is not None for place in flow["places"]]
            flow["goals"] = [goal for goal, is_open in zip(flow["goals"], open_ones, strict=True) if is_open]
            flow["places"] = [place for place, is_open in zip(flow["places"], open_ones, strict=True) if is_open]
            flow["then"] = flow["then"] if flow["goals"] else "stay"
        ways = []
        for goal, place in zip(flow["goals"], flow["places"], strict=True):
            way = self._way_to(place)
            if way is None:
                raise MorseError(f"{self.name()}: nobody can stand at the goal {goal!r:.80}: it is within a wall")
            ways.append(way)
        if flow["then"] == "queue":
            counter = np.array(flow["places"][-1]).reshape(-1, 2).mean(axis=0)
            spots = line_back(self.ground, ways[-1], np.array(flow["area"]).mean(axis=0), counter, self._count)
            flow["queue"] = Queue(spots, float(flow["wait"]))
        flow["seats"] = [np.array(place).reshape(-1, 2).mean(axis=0) for place in flow["places"]]
        if flow["then"] in ("queue", "sit"):
            area = np.array(flow["area"])
            home = self._way_to(area.mean(axis=0).tolist() if flow["exact"] else flow["area"])
            if home is None:
                raise MorseError(f"{self.name()}: nobody can stand in {flow['area']!r:.80}: there are walls")
            ways.append(home)
        return ways

    def _make_groups(self, rows: NDArray[np.intp]) -> None:
        """Let a share of people walk in groups of 2 to 4, with one speed (Moussaid et al. 2010, figure 1)."""
        row, last = 0, round(self._groups * len(rows))
        while row + 2 <= last:
            size = int(min(self._random.choice([2, 3, 4], p=[0.7, 0.2, 0.1]), last - row))
            members = rows[row : row + size]
            self.walkers.group[members] = members[0]
            self.walkers.free_speed[members] = self.walkers.free_speed[members].mean()
            row += size

    def _candidates(self, places: Places, area: Floats, count: int, radius: float) -> Floats:
        """Return up to ``count`` random points (P, 2) of an area where a body has room."""
        low, high = area.min(axis=0), area.max(axis=0)
        found = np.zeros((0, 2))
        for _ in range(20):
            points = low + self._random.random((max(4 * count, 64), 2)) * (high - low)
            points = points[inside(area, points)]
            found = np.concatenate([found, points[places.are_open(points, radius)]])
            if len(found) >= count:
                break
        return found[:count]

    def _free_place(self, places: Places, area: Floats, row: int, exact: Floats | None) -> Floats | None:
        """Return a place for a person, the exact one (1, 2) if it is given; None if there is no room."""
        radius = float(self.walkers.radius[row])
        if exact is not None:
            # who begins at an exact place may touch a wall
            is_good = places.are_open(exact, self.ground.radius) & places.are_free(exact, radius)
            return np.array(exact[0]) if is_good[0] else None
        points = self._candidates(places, area, _TRIES, radius)
        # a group begins together
        leader = int(self.walkers.group[row])
        if leader >= 0 and leader != row and self.mode[leader] == WALKS:
            apart = points - self.walkers.position[leader]
            points = points[np.argsort((apart * apart).sum(axis=1), kind="stable")]
        # most points are free: look at a few first
        for part in (points[:8], points[8:]):
            free = np.flatnonzero(places.are_free(part, radius, 0.02))
            if len(free):
                return np.array(part[free[0]])
        return None

    def _find_lost(self) -> None:
        """Tell who cannot reach a goal; they stay where they are."""
        lost = np.zeros(self._count, dtype=bool)
        for number, flow in enumerate(self._flows):
            rows = np.flatnonzero((self.flow == number) & self.walkers.present)
            for way in flow["ways"]:
                lost[rows] |= np.isinf(self.ground.time(way, self.walkers.position[rows]))
            if len(rows) and lost[rows].all() and not flow.get("is_own"):
                raise MorseError(
                    f"{self.name()}: nobody can reach {flow['goals']!r:.120} from {flow['area']!r:.120}: walls are "
                    f"between, with no passage of {2 * self.ground.radius:.2g} m"
                )
        if lost.any():
            self.mode[lost] = STOPPED
            text = f"{self.name()}: {int(lost.sum())} people cannot reach a goal, and stay where they are"
            self.context.complaints.warn(text, text)

    # -- the tick --------------------------------------------------------------------------

    def _follow(self, tracks: Tracks, *, begins: bool = False) -> None:
        """Set the people of trajectories where they are: at the end of this tick, or at the beginning of the run."""
        walkers, time = self.walkers, self.clock.time
        before, here = tracks.at(time), tracks.at(time + (0.0 if begins else self._seconds))
        was_there = np.isin(self.mode, (RECORDED, GONE)) & (not begins)
        came = here.present & ~(self.mode == RECORDED)
        self.mode[:] = np.where(here.present, RECORDED, np.where(was_there, GONE, OUTSIDE))
        velocity = (here.position - before.position) / self._seconds
        # nobody walks from the end of a trajectory to its beginning
        jumps = length(velocity) > FASTEST
        velocity[jumps | ~here.present] = 0.0
        walkers.position, walkers.velocity, walkers.present = here.position, velocity, here.present.copy()
        walkers.push[:] = walkers.leave[:] = 0.0
        if not begins and (came | jumps).any():
            self.gait.stand(np.flatnonzero(came | jumps), walkers.position)

    def default_action(self) -> None:
        """Walk for a tick."""
        walkers = self.walkers
        if self._tracks is not None:
            self._touch()
            self._follow(self._tracks)
        else:
            self._enter()
            self._advance()
            self._look_ahead()
            if self.floors.shafts:
                self.riding.plan(walkers, np.isin(self.mode, (WALKS, SENT)), self._way_of, self._move)
            self._around.open_doors(walkers, self.riding.area)
            others = self._around.seen(self._count)
            self._touch()
            before = walkers.position
            walkers.step(self._seconds, self._law, others)
            carried = self.riding.carried()
            walkers.position[carried], walkers.velocity[carried] = before[carried], 0.0
            sits = np.flatnonzero(self.mode == SITS)
            walkers.position[sits] = sit_down(before[sits], self.target[sits], self._seconds)
            walkers.velocity[sits] = 0.0
        self.gait.step(self._seconds, walkers.position, walkers.velocity, walkers.wanted)
        self._show()

    def _way_of(self, person: int) -> Way | None:
        """Return the way on which a person is; None if there is none."""
        if self.mode[person] == SENT:
            return self._way_to(self.target[person].tolist())
        ways = self._flows[self.flow[person]]["ways"]
        return ways[self.stage[person]] if ways else None

    def _move(self, people: NDArray[np.intp], area: int) -> None:
        """Put people who enter or leave a cabin to another part of the plane."""
        shift = self.floors.shift[area] - self.floors.shift[self.riding.area[people]]
        self.walkers.position[people] += shift
        self.gait.feet[people] += shift[:, None, :]
        self.riding.area[people] = area

    def _enter(self) -> None:
        """Let those enter whose time has come and for whom there is room."""
        due = np.flatnonzero((self.mode == OUTSIDE) & (self.until <= self.clock.time))
        if not len(due):
            return
        places = Places(self.ground, self._around.outlines(), self._around.crowds(), self.walkers)
        for row in due.tolist():
            doors, radius = self._doors[row], float(self.walkers.radius[row])
            free = np.flatnonzero(places.are_open(doors, radius) & places.are_free(doors, radius, 0.1))
            if len(free):
                self.mode[row] = WALKS
                self.walkers.position[row] = doors[free[0]]
                self.walkers.present[row] = True
                places.take(doors[free[0]], radius)
                self.gait.stand(np.array([row]), self.walkers.position)

    def _advance(self) -> None:
        """Let those who have arrived wait, stand in line, sit, go on, or leave."""
        now, walkers = self.clock.time, self.walkers
        for number, flow in enumerate(self._flows):
            mine = self.flow == number
            if flow.get("next") and now >= flow["next"][0] and mine.any():
                self._change(np.flatnonzero(mine), flow["next"][1])
                continue
            count = len(flow["ways"])
            for stage, way in enumerate(flow["ways"]):
                rows = np.flatnonzero(mine & (self.mode == WALKS) & (self.stage == stage))
                is_counter = flow["then"] == "queue" and stage == count - 2
                if is_counter:
                    self._queue(flow["queue"], rows, self.ground.time(way, walkers.position[rows]), mine)
                is_seat = flow["then"] == "sit" and stage < count - 1
                if is_counter or not (len(rows) or is_seat):
                    continue
                there = mine & (self.stage == stage) & np.isin(self.mode, (WAITS, ARRIVED, SITS))
                left = self.ground.time(way, walkers.position[rows])
                # those who come and those who are there have room side by side: 2.6 people on a square metre
                crowded = int(there.sum()) + (0 if is_seat else int((left < _CROWDED).sum()) - 1)
                rows = rows[left < _ARRIVES + 0.35 * math.sqrt(max(crowded, 0))]
                self.mode[rows] = WAITS
                self.until[rows] = now + (0.0 if flow["then"] in ("queue", "sit") else flow["wait"])
                if is_seat:
                    # who finds the seat taken stands beside it until it is free
                    self.mode[rows], self.until[rows] = ARRIVED, NEVER
                    waiting = np.flatnonzero(mine & (self.mode == ARRIVED) & (self.stage == stage))[:1]
                    if not (mine & (self.stage == stage) & (self.mode == SITS)).any():
                        self.mode[waiting], self.target[waiting] = SITS, flow["seats"][stage]
                        self.came[waiting] = walkers.position[waiting]
                        self.until[waiting] = now + flow["wait"] if flow["wait"] > 0.0 else NEVER
            # who stands up goes back to where he came from
            rows = np.flatnonzero(mine & (self.mode == SITS) & (self.until <= now))
            rows = rows[~self._leaves(rows)]
            self.target[rows], self.until[rows] = self.came[rows], now + STANDS_UP
            rows = np.flatnonzero(mine & np.isin(self.mode, (WAITS, SITS)) & (self.until <= now))
            last = self.stage[rows] + 1 >= count
            self.mode[rows[~last]] = WALKS
            self.stage[rows[~last]] = count - 1 if flow["then"] == "sit" else self.stage[rows[~last]] + 1
            ends = rows[last]
            if flow["then"] == "repeat":
                self.mode[ends], self.stage[ends] = WALKS, 0
            else:
                self.mode[ends] = ARRIVED if flow["then"] == "stay" else GONE
        self.walkers.present = ~np.isin(self.mode, _ABSENT)

    def _leaves(self, rows: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Whether (R,) people who sit stand up."""
        return np.asarray((self.target[rows] == self.came[rows]).all(axis=1))

    def _change(self, rows: NDArray[np.intp], flow: int) -> None:
        """Let people have the goals of another flow, the next one of their schedule."""
        self.flow[rows] = flow
        seats = len(self._flows[flow]["goals"])
        self.stage[rows] = np.arange(len(rows)) % seats if self._flows[flow]["then"] == "sit" else 0
        free = rows[np.isin(self.mode[rows], (WAITS, ARRIVED, QUEUES, SITS))]
        self.mode[free] = WALKS

    def _queue(self, queue: Queue, rows: NDArray[np.intp], left: Floats, mine: NDArray[np.bool_]) -> None:
        """Let people join a line, and move up in it; serve the first one."""
        now, line = self.clock.time, np.flatnonzero(mine & (self.mode == QUEUES))
        joining = queue.joining(rows, left, len(line))
        if len(joining):
            begin = int(self.rank[line].max()) + 1 if len(line) else 0
            self.rank[joining], self.mode[joining] = begin + np.arange(len(joining)), QUEUES
            self.until[joining] = NEVER
            line = np.flatnonzero(mine & (self.mode == QUEUES))
        if not len(line):
            return
        self.target[line] = queue.places(self.rank[line])
        first = int(line[self.rank[line].argmin()])
        if self.until[first] <= now:
            self.mode[first] = WALKS
            self.stage[first] += 1
        elif self.until[first] == NEVER and length((self.walkers.position - self.target)[[first]])[0] < _ARRIVES:
            self.until[first] = now + queue.wait

    def _look_ahead(self) -> None:
        """Set where everybody wants to go."""
        wanted, position = self.walkers.wanted, self.walkers.position
        wanted[:] = 0.0
        for number, flow in enumerate(self._flows):
            for stage, way in enumerate(flow["ways"]):
                rows = np.flatnonzero((self.flow == number) & (self.mode == WALKS) & (self.stage == stage))
                if len(rows):
                    wanted[rows] = self.ground.heading(way, position[rows])
        queues, sits = np.flatnonzero(self.mode == QUEUES), np.flatnonzero(self.mode == SITS)
        wanted[queues] = steps_to(position[queues], self.target[queues])
        # seated people look to where they came from
        away = self.came[sits] - np.where(self._leaves(sits)[:, None], position[sits], self.target[sits])
        wanted[sits] = away / np.maximum(length(away), HERE)[:, None]
        if self._trails:
            self._follow_leaders()
        sent = np.flatnonzero(self.mode == SENT)
        for target in np.unique(self.target[sent], axis=0):
            rows = sent[(self.target[sent] == target).all(axis=1)]
            found = self._way_to(target.tolist())
            if found is None:
                self.mode[rows] = STOPPED
                continue
            arrived = self.ground.time(found, position[rows]) < _ARRIVES + 0.35 * math.sqrt(len(rows) - 1.0)
            self.mode[rows[arrived]] = STOPPED
            wanted[rows[~arrived]] = self.ground.heading(found, position[rows[~arrived]])

    def _place_of(self, leader: str) -> tuple[float, float] | None:
        """Return the place of a robot on the plane, m; None if it is not there."""
        robot = self.context.robots.get(leader)
        if robot is None:
            return None
        x, y, z = robot.bge_object.world_pose()[0]
        shift = self.floors.shift[self.floors.floor_of(z)]
        return (float(x + shift[0]), float(y + shift[1]))

    def _forget_leaders(self) -> None:
        """Drop the trails that nobody follows any more; leaders are numbered in the order of the others."""
        names, self.leader[self.mode != FOLLOWS] = list(self._trails), -1
        numbers = np.unique(self.leader[self.leader >= 0])
        self.leader[self.leader >= 0] = np.searchsorted(numbers, self.leader[self.leader >= 0])
        self._trails = {names[number]: self._trails[names[number]] for number in numbers.tolist()}

    def _follow_leaders(self) -> None:
        """Let people follow who are led."""
        position, wanted = self.walkers.position, self.walkers.wanted
        for number, (name, trail) in enumerate(self._trails.items()):
            place = self._place_of(name)
            rows = np.flatnonzero((self.mode == FOLLOWS) & (self.leader == number))
            if place is None or not len(rows):
                continue
            note(trail, place)
            order = np.argsort(np.argsort(self.rank[rows], kind="stable"), kind="stable")
            targets = aims(trail, place, position[rows], order)
            near = np.isfinite(targets[:, 0])
            wanted[rows[near]] = steps_to(position[rows[near]], targets[near])
            far = rows[~near]
            way = self._way_to(list(trail[0])) if len(far) else None
            if way is not None:
                wanted[far] = self.ground.heading(way, position[far])

    def _touch(self) -> None:
        """Let people and things that touch push each other, and tell of those that do so too hard."""
        data = self.local_data
        data["contacts"] = contacts = self._around.touch(
            self.walkers, self.riding.area, self.gait.height, self._touching
        )
        for key in self._reported.keys() - {f"{one['person']} {one['robot']}" for one in contacts}:
            del self._reported[key]
        for one in contacts:
            key = f"{one['person']} {one['robot']}"
            if one["force"] <= one["limit"] or key in self._reported:
                continue
            self._reported[key] = True
            data["exceeded"] += 1
            text = f"{one['robot']} hits person {one['person']} of {self.name()} with {one['force']:.0f} N, "
            text += f"{one['region']}: ISO/TS 15066 permits {one['limit']:.0f} N"
            self.context.complaints.warn(f"{self.name()} {one['robot']}", text)

    def _show(self) -> None:
        """Set the bodies and the data."""
        walkers, data = self.walkers, self.local_data
        here = length(walkers.position - self.target) < HERE
        sits = (self.mode == SITS) & here & ~self._leaves(np.arange(self._count))
        area = self.riding.area
        # from the plane to the world
        offset = np.column_stack([-self.floors.shift[area], self.floors.heights[area]])
        self._rows.place(*self.gait.poses(walkers.position, walkers.velocity, walkers.present, offset, sits))
        changed = np.flatnonzero(self._shown != walkers.present)
        if len(changed):
            legged = np.cumsum(~self.gait.rides) - 1
            total = int((~self.gait.rides).sum())
            for row in changed.tolist():
                is_here = bool(walkers.present[row])
                own = [row]
                if not self.gait.rides[row]:
                    own += [self._count + int(legged[row]), self._count + total + int(legged[row])]
                for part in own:
                    self._bodies[part].setVisible(is_here)
            self._shown = walkers.present.copy()
        data["positions"] = np.column_stack([walkers.position + offset[:, :2], offset[:, 2]])
        data["velocities"] = np.column_stack([walkers.velocity, self.riding.speeds()])
        data["present"] = walkers.present.copy()
        data["groups"] = walkers.group.astype(np.int32)

    def trunk(self, person: int) -> Body:
        """Return the trunk of a person."""
        return self._bodies[person]

    def record(self, person: int) -> dict[str, object]:
        """Return what trackers tell of a person; see `PeopleTracker`."""
        walkers, heading = self.walkers, self.gait.heading[person]
        return {
            "name": self._bodies[person].name,
            "id": person,
            "group_id": int(walkers.group[person]),
            "position": self.local_data["positions"][person].tolist(),
            "velocity": self.local_data["velocities"][person].tolist(),
            "yaw": math.atan2(float(heading[1]), float(heading[0])),
            "radius": float(walkers.radius[person]),
            "desired_velocity": float(walkers.free_speed[person]),
            "state": self._word(person),
        }

    def _word(self, person: int) -> str:
        """Return what a person does."""
        ride = int(self.riding.ride[person])
        return RIDES[ride] if ride != ON_FOOT else _WORDS[self.mode[person]]

    # -- services --------------------------------------------------------------------------

    def _check(self, person: int) -> None:
        if not 0 <= person < self._count:
            raise MorseRPCInvokationError(
                f"{self.name()} has {self._count} people: 0 to {self._count - 1}, not {person}"
            )
        if not self.walkers.present[person]:
            raise MorseRPCInvokationError(
                f"person {person} of {self.name()} is not in the world: {_WORDS[self.mode[person]]}"
            )

    def _obey(self) -> None:
        """Refuse commands to people who walk as others have walked."""
        if self._tracks is not None:
            raise MorseRPCInvokationError(f"{self.name()} follows recorded trajectories: it obeys nobody")

    def _demand_way(self, x: float, y: float, floor: int) -> tuple[Way, list[float]]:
        """Return the way to a place of a floor, and the place on the plane."""
        if not np.isfinite([x, y]).all():
            raise MorseRPCInvokationError(f"the place ({x}, {y}) is not finite")
        if not 0 <= floor < self.floors.count:
            raise MorseRPCInvokationError(f"{self.name()} has the floors 0 to {self.floors.count - 1}, not {floor}")
        shape = self.ground.shape
        low = self.ground.origin
        high = low + self.ground.cell * (np.array([shape[1] // self.floors.count, shape[0]]) - 1)
        if not (low[0] <= x <= high[0] and low[1] <= y <= high[1]):
            raise MorseRPCInvokationError(
                f"({x:g}, {y:g}) is outside the ground of {self.name()}: x {low[0]:g} to {high[0]:g} m, "
                f"y {low[1]:g} to {high[1]:g} m"
            )
        place = (np.array([float(x), float(y)]) + self.floors.shift[floor]).tolist()
        way = self._way_to(place)
        if way is None:
            raise MorseRPCInvokationError(f"nobody can stand at ({x:g}, {y:g}), or within {_BESIDE:g} m of it")
        return way, place

    @service
    def send(self, person: _Person, x: Position, y: Position, floor: int = -1) -> None:
        """Send a person to a place, where it stands until it is released by `resume`.

        Args:
            person: number of the person.
            x: metres, in the world.
            y: metres, in the world.
            floor: number of the floor; -1 for that on which the person is.
        """
        self._obey()
        self._check(person)
        if floor < 0:
            height = float(self.floors.heights[self.riding.area[person]])
            floor = self.floors.floor_of(height)
        way, place = self._demand_way(x, y, floor)
        if math.isinf(float(self.ground.time(way, self.walkers.position[[person]])[0])):
            raise MorseRPCInvokationError(f"person {person} cannot reach ({x:g}, {y:g}): walls are between")
        self.target[person], self.mode[person] = place, SENT

    @service
    def call(self, x: Position, y: Position, count: _Person = 1, floor: int = 0) -> list[int]:
        """Call the nearest people to a place; return their numbers, those with the shortest way first.

        Args:
            x: metres, in the world.
            y: metres, in the world.
            count: number of people.
            floor: number of the floor.
        """
        self._obey()
        way, place = self._demand_way(x, y, floor)
        rows = np.flatnonzero(self.walkers.present)
        time = self.ground.time(way, self.walkers.position[rows])
        order = np.argsort(time, kind="stable")
        chosen = rows[order[np.isfinite(time[order])]][:count]
        self.target[chosen], self.mode[chosen] = place, SENT
        return [int(row) for row in chosen]

    @service
    def follow(self, robot: str, count: _Person = 1) -> list[int]:
        """Let the nearest people follow a robot, or a human, until `resume`; return their numbers.

        They come to where it is now, and walk behind it on its trail, one after the other.

        Args:
            robot: name of the robot.
            count: number of people.
        """
        self._obey()
        place = self._place_of(robot)
        if place is None or robot == self.name():
            hint = nearest_name(robot, sorted(self.context.robots))
            raise MorseRPCInvokationError(f"there is no robot '{robot:.80}' to follow{hint}")
        self._forget_leaders()
        if robot not in self._trails and len(self._trails) >= MOST_LEADERS:
            raise MorseRPCInvokationError(f"{self.name()} follows {MOST_LEADERS} robots at most")
        way = self._way_to(list(place))
        if way is None:
            raise MorseRPCInvokationError(f"{robot:.80} is where nobody can go: on the ground, or within a wall")
        rows = np.flatnonzero(self.walkers.present & (self.riding.ride == ON_FOOT))
        time = self.ground.time(way, self.walkers.position[rows])
        order = np.argsort(time, kind="stable")
        chosen = rows[order[np.isfinite(time[order])]][:count]
        self._trails[robot] = [place]
        names = list(self._trails)
        self.mode[chosen], self.rank[chosen] = FOLLOWS, np.arange(len(chosen))
        self.leader[chosen] = names.index(robot)
        return [int(row) for row in chosen]

    @service
    def stop(self, person: int = -1) -> None:
        """Let a person, or everybody, stand still until `resume` is called.

        Args:
            person: number of the person; -1 for all.
        """
        self._obey()
        if person >= 0:
            self._check(person)
        rows = np.flatnonzero(self.walkers.present) if person < 0 else np.array([person])
        self.mode[rows] = STOPPED

    @service
    def resume(self, person: int = -1) -> None:
        """Let a person, or everybody, go on with the goals of the scene.

        Args:
            person: number of the person; -1 for all.
        """
        self._obey()
        if person >= 0:
            self._check(person)
        rows = np.flatnonzero(self.walkers.present) if person < 0 else np.array([person])
        rows = rows[np.isin(self.mode[rows], (STOPPED, SENT, FOLLOWS))]
        self.mode[rows] = WALKS

    @service(changes=False)
    def ask(self, person: _Person) -> dict[str, Any]:
        """Return what a person does: state, position and velocity (x, y), floor, free speed, group, height.

        The floor is -1 for somebody who rides in a lift.

        Args:
            person: number of the person.
        """
        if not 0 <= person < self._count:
            raise MorseRPCInvokationError(
                f"{self.name()} has {self._count} people: 0 to {self._count - 1}, not {person}"
            )
        walkers = self.walkers
        return {
            "state": self._word(person),
            "position": self.local_data["positions"][person, :2].tolist(),
            "floor": int(self.riding.area[person]) if self.riding.area[person] < self.floors.count else -1,
            "velocity": walkers.velocity[person].tolist(),
            "free_speed": float(walkers.free_speed[person]),
            "group": int(walkers.group[person]),
            "height": float(self.gait.height[person]),
        }

    # -- state -----------------------------------------------------------------------------

    def _arrays(self) -> dict[str, Any]:
        walkers, gait = self.walkers, self.gait
        return {
            **{
                name: getattr(walkers, name)
                for name in ("position", "velocity", "free_speed", "group", "present", "planned")
            },
            **{name: getattr(gait, name) for name in ("phase", "stride", "feet", "heading", "stands")},
            **{
                name: getattr(self, name)
                for name in ("flow", "stage", "mode", "until", "target", "came", "rank", "alert", "leader")
            },
            **{name: getattr(self.riding, name) for name in ("area", "ride", "lift", "slot", "turn", "opened")},
        }

    def get_state(self) -> StateData:
        """See `Object.get_state`."""
        state = super().get_state()
        state["people"] = {name: values.copy() for name, values in self._arrays().items()} | {"lag": self.walkers.lag}
        return state

    def set_state(self, state: StateData) -> None:
        """See `Object.set_state`.

        Raises:
            StateError: the people of the state are not those of the scene.
        """
        state = dict(state)
        people = state.pop("people", None)
        arrays = self._arrays()
        if not isinstance(people, dict) or people.keys() != {*arrays, "lag"}:
            raise StateError(f"the people of {self.name()} are missing")
        for name, present in arrays.items():
            given = people[name]
            fits = isinstance(given, np.ndarray) and given.dtype == present.dtype and given.shape == present.shape
            if not fits or not np.isfinite(given).all():
                raise StateError(f"the people of {self.name()} have another '{name}'")
        if not self._can_be(people) or not can_touch(state.get("_touching", {})):
            raise StateError(f"the people of {self.name()} are where, or as, nobody can be")
        trails: Any = state.get("_trails", {})
        if not can_be(trails) or (people["leader"] >= len(trails)).any() or (people["leader"] < -1).any():
            raise StateError(f"the people of {self.name()} are where, or as, nobody can be")
        super().set_state(state)
        for name in arrays:
            owner = next(one for one in (self.walkers, self.gait, self.riding, self) if hasattr(one, name))
            setattr(owner, name, people[name].copy())
        self.walkers.lag = people["lag"]
        self._around.forget()
        self._show()

    def _can_be(self, people: dict[str, Any]) -> bool:
        """Whether the values of a state are possible."""
        flow, stage, group, lag = people["flow"], people["stage"], people["group"], people["lag"]
        stages = np.array([max(len(one["ways"]), 1) for one in self._flows] + [1])
        heading = people["heading"]
        near = all(
            np.abs(people[name]).max(initial=0.0) < 1e6 for name in ("position", "feet", "target", "came", "planned")
        )
        bounds = {"mode": (0, len(_WORDS) - 1), "stride": (0.05, 5.0), "free_speed": (0.0, 20.0), "alert": (0.0, 1.0)}
        within = all(((low <= people[name]) & (people[name] <= high)).all() for name, (low, high) in bounds.items())
        return bool(
            near
            and within
            and ((flow >= -1) & (flow < len(self._flows))).all()
            and ((stage >= 0) & (stage < stages[flow])).all()
            and ((group >= -1) & (group < self._count)).all()
            and (np.abs(people["rank"]) < 1e9).all()
            and self.riding.can_be(people)
            and (np.abs((heading * heading).sum(axis=1) - 1.0) < 1e-6).all()
            and (np.abs(people["velocity"]) < 1e3).all()
            and ((people["phase"] >= 0.0) & (people["phase"] < 1e9)).all()
            and isinstance(lag, float)
            and abs(lag) < 10.0
        )
