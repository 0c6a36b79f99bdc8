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
from morse.core.validation.arguments import Range
from morse.helpers.components import add_data, add_property, add_state
from morse.plugins.people.agenda import FOLLOWS, GONE, OUTSIDE, RECORDED, SENT, SITS, STOPPED, WALKS, WORDS, Agenda
from morse.plugins.people.contacts import Surroundings, can_touch
from morse.plugins.people.errands import HERE, sit_down
from morse.plugins.people.floors import MOST_FLOORS, Floors
from morse.plugins.people.following import MOST_LEADERS, Trails, can_be
from morse.plugins.people.gait import Gait
from morse.plugins.people.members import HEIGHT, Members
from morse.plugins.people.plan import Plan
from morse.plugins.people.progress import advance, follow_leaders, look_ahead
from morse.plugins.people.recorded import FASTEST, Tracks
from morse.plugins.people.riding import ON_FOOT, Riding
from morse.plugins.people.riding import WORDS as RIDES
from morse.plugins.people.starts import Starts
from morse.plugins.people.states import States
from morse.plugins.people.walking import Orca, Others, SocialForce, Walkers, length
from morse.scene import PhysicsType

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.values import StateData
    from morse.core.world import Body
    from morse.plugins.people.members import Guided
    from morse.plugins.people.stairs import Steps
    from morse.plugins.people.wayfinding import Way

    Floats = NDArray[np.float64]

#: kg of a man of 1.75 m; the mass goes with the square of the height
_MASS = 76.0
#: N: a smaller force is a touch, also on the head, where no impact is permitted
_TOUCH = 1.0

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
    add_state("_sought", dict, "Where those go who are far from a trail, m, by the names of the leaders")
    add_state("_reported", dict, "Contacts that were above the limit")

    not_state: ClassVar[tuple[str, ...]] = ("local_data",)

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        # read once: clients may change properties while the simulation runs
        heights = np.array(_json(self, "Heights", self._heights, list), dtype=np.float64)
        self._shares = {
            str(name): float(share) for name, share in _json(self, "Attention", self._attention, dict).items()
        }
        self._own = count = len(heights)
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
        self._sought: Trails = {}
        random = self.context.random(self.name())
        x, y, _ = (float(one) for one in obj.world_pose()[0])
        plan = _json(self, "Plan", self._plan, dict)
        slimmest = float(self._radii(heights).min(initial=1.0))
        self.plan = Plan(self.context, self.name(), self.floors, plan, count, (x, y), slimmest)
        self.members = Members(self.context, self.plan.members, count)
        heights = np.concatenate([heights, np.full(len(self.members.rows), HEIGHT)])
        self._count, rides, radius = len(heights), self._rides_of(heights), self._radii(heights)
        self.ground, self._tracks = self.plan.ground, self.plan.tracks
        self.agenda = Agenda(self._count)
        self._around = Surroundings(self.context, self.name(), self.floors, self._shares, lambda: self.agenda.alert)
        self.walkers = Walkers.at(self.ground, np.zeros((self._count, 2)), 0.0, radius)
        # wheelchairs, and bodies of robots, take no stairs
        self.walkers.level = legless = rides | (np.arange(self._count) >= count)
        self.walkers.mass = _MASS * (heights / 1.75) ** 2 + np.where(rides, 20.0, 0.0)
        self.riding = Riding(self.context, self.floors, self.ground, self._around, self._count)
        self._starts = Starts(self.context, self.name(), self.plan, self._around, self.agenda, self.walkers, random)
        self._starts.settle(self._free_speeds(heights, random), self._groups, self.riding.area)
        self.members.begin(self.agenda, self.walkers)
        if self._tracks is not None:
            self._follow(self._tracks, begins=True)
        look_ahead(self.plan, self.agenda, self.walkers)
        heading = self.walkers.wanted.copy()
        heading[(heading == 0.0).all(axis=1)] = (1.0, 0.0)
        draw = random.random(self._count)
        self.gait = Gait.at(self.walkers.position, heading, heights, legless, np.floor(8.0 * draw))
        legs = [[node.children[side] for node in trunks if node.children] for side in (0, 1)]
        self._bodies = [self.context.world.object_of(node) for node in (*trunks, *legs[0], *legs[1])]
        self._rows = self.context.world.kinematic_bodies(self._bodies)
        self._trunks = [*self._bodies[:count], *self.members.bodies()]
        self._shown = np.ones(count, dtype=bool)
        self._states = States(self.name(), self.walkers, self.gait, self.agenda, self.riding, self.plan)
        self._show(self._steps())

    def _rides_of(self, heights: Floats) -> NDArray[np.bool_]:
        """Return (N,) who sits in a wheelchair."""
        return np.arange(len(heights)) < int(self._rides)

    def _radii(self, heights: Floats) -> Floats:
        """Return the radii (N,) of people by their heights (N,), m."""
        own = self._radius * np.minimum(heights / 1.7, 1.0) ** 0.5
        return np.where(self._rides_of(heights), np.maximum(0.38, self._radius), own)

    def _free_speeds(self, heights: Floats, random: np.random.Generator) -> Floats:
        """Return the speeds (N,) of people whose way is free, m/s, by their heights (N,), m."""
        speeds = np.clip(random.normal(0.0, 1.0, len(heights)), -2.0, 2.0) * self._deviation + self._free_speed
        rides = self._rides_of(heights)
        # children of 1.0 to 1.45 m: 80 to 95 % of the speed; wheelchairs: 1.08 m/s (Weidmann 1993; Boyce et al. 1999)
        speeds = np.where((heights < 1.5) & ~rides, speeds * (0.45 + 0.35 * heights), speeds)
        speeds = np.where(rides, speeds * 0.8, speeds)
        return np.maximum(speeds, 0.2)

    # -- the tick --------------------------------------------------------------------------

    def _follow(self, tracks: Tracks, *, begins: bool = False) -> None:
        """Set the people of trajectories where they are: at the end of this tick, or at the beginning of the run."""
        walkers, time = self.walkers, self.clock.time
        before, here = tracks.at(time), tracks.at(time + (0.0 if begins else self._seconds))
        was_there = np.isin(self.agenda.mode, (RECORDED, GONE)) & (not begins)
        came = here.present & ~(self.agenda.mode == RECORDED)
        self.agenda.mode[:] = np.where(here.present, RECORDED, np.where(was_there, GONE, OUTSIDE))
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
            now = self.clock.time
            self.members.observe(walkers, self.agenda, self.riding, self.floors, self.ground, self._seconds)
            self._starts.enter(now, self.gait)
            advance(self.plan, self.agenda, walkers, now)
            look_ahead(self.plan, self.agenda, walkers)
            tick = self.clock.tick
            follow_leaders(self.plan, self.agenda, walkers, self._trails, self._sought, tick, self._place_of)
            if self.floors.shafts:
                walks = np.isin(self.agenda.mode, (WALKS, SENT, FOLLOWS))
                self.riding.plan(walkers, walks, self._lifts_of_leaders(), self._way_of, self._move)
            self._around.open_doors(walkers, self.riding.area)
            others = self._around.seen(self._count)
            self._touch()
            before = walkers.position.copy()
            self._walk(others)
            carried = self.riding.carried()
            walkers.position[carried], walkers.velocity[carried] = before[carried], 0.0
            sits = np.flatnonzero(self.agenda.mode == SITS)
            walkers.position[sits] = sit_down(before[sits], self.agenda.target[sits], self._seconds)
            walkers.velocity[sits] = 0.0
        steps = self._steps()
        self.gait.step(self._seconds, walkers.position, walkers.velocity, walkers.wanted, self._sits(), steps)
        if self._tracks is None:
            self.members.guide(walkers, before, self.gait, self._seconds)
        self._show(steps)

    def _walk(self, others: Others) -> None:
        """Walk for a tick, slower on stairs."""
        walkers, area = self.walkers, self.riding.area
        if not self.floors.flights:
            walkers.step(self._seconds, self._law, others)
            return
        stairs = self.floors.stairs
        free, walkers.free_speed = walkers.free_speed, walkers.free_speed * stairs.paces(walkers, area)
        walkers.step(self._seconds, self._law, others.joined(stairs.others(walkers, area)))
        walkers.free_speed = free
        stairs.change(walkers, area, self._move)

    def _steps(self) -> Steps | None:
        """Return the steps below those who are on stairs; None if nobody is."""
        if not self.floors.flights:
            return None
        return self.floors.stairs.steps(self.walkers.position, self.riding.area, self.gait.height)

    def _way_of(self, person: int) -> Way | None:
        """Return the way on which a person is; None if there is none."""
        way = self._any_way_of(person)
        return way.level if way is not None and way.level is not None and self.walkers.level[person] else way

    def _any_way_of(self, person: int) -> Way | None:
        if self.agenda.mode[person] == SENT:
            return self.plan.way_to(self.agenda.target[person].tolist())
        if self.agenda.mode[person] == FOLLOWS:
            place = self._sought.get(list(self._trails)[self.agenda.leader[person]])
            return self.plan.way_to(list(place[0])) if place else None
        ways = self.plan.flows[self.agenda.flow[person]]["ways"]
        return ways[self.agenda.stage[person]] if ways else None

    def _move(self, people: NDArray[np.intp], area: int) -> None:
        """Put people who enter or leave a cabin to another part of the plane."""
        shift = self.floors.shift[area] - self.floors.shift[self.riding.area[people]]
        self.walkers.position[people] += shift
        self.gait.feet[people] += shift[:, None, :]
        self.gait.goal[people] += shift
        lower = self.floors.heights[self.riding.area[people]] - self.floors.heights[area]
        self.gait.ground[people] += lower[:, None]
        self.riding.area[people] = area

    def _place_of(self, leader: str) -> tuple[float, float] | None:
        """Return the place of a robot on the plane, m; None if it is not there."""
        robot = self.context.robots.get(leader)
        if robot is None:
            return None
        x, y, z = robot.bge_object.world_pose()[0]
        shift = self.floors.shift[self.floors.floor_of(z)]
        return (float(x + shift[0]), float(y + shift[1]))

    def _lifts_of_leaders(self) -> NDArray[np.intp]:
        """Return the numbers (N,) of the lifts in which the leaders of those stand who follow; -1 for none."""
        lifts = np.full(self._count, -1, dtype=np.intp)
        for number, name in enumerate(self._trails):
            robot = self.context.robots.get(name)
            if robot is not None:
                rows = (self.agenda.mode == FOLLOWS) & (self.agenda.leader == number)
                lifts[rows] = self.riding.cabin_at(robot.bge_object.world_pose()[0])
        return lifts

    def _touch(self) -> None:
        """Let people and things that touch push each other, and tell of those that do so too hard."""
        data = self.local_data
        data["contacts"] = contacts = self._around.touch(
            self.walkers, self.riding.area, self.gait.height[: self._own], self._touching
        )
        for key in self._reported.keys() - {f"{one['person']} {one['robot']}" for one in contacts}:
            del self._reported[key]
        for one in contacts:
            key = f"{one['person']} {one['robot']}"
            if one["force"] <= max(one["limit"], _TOUCH) or key in self._reported:
                continue
            self._reported[key] = True
            data["exceeded"] += 1
            text = f"{one['robot']} and person {one['person']} of {self.name()} touch with {one['force']:.0f} N, "
            permitted = f"{one['limit']:.0f} N" if one["limit"] else "no impact there"
            text += f"{one['region']}: ISO/TS 15066 permits {permitted}"
            self.context.complaints.warn(f"{self.name()} {one['robot']}", text)

    def _sits(self) -> NDArray[np.bool_]:
        """Return who (N,) sits on a seat, or sits down there."""
        here = length(self.walkers.position - self.agenda.target) < HERE
        return np.asarray((self.agenda.mode == SITS) & here & ~self.agenda.stands_up(np.arange(self._count)), np.bool_)

    def _show(self, steps: Steps | None) -> None:
        """Set the bodies and the data; `steps` are below those who are on stairs."""
        walkers, data = self.walkers, self.local_data
        area = self.riding.area
        # from the plane to the world
        offset = np.column_stack([-self.floors.shift[area], self.floors.heights_of(walkers.position, area)])
        poses = self.gait.poses(walkers.position, walkers.present, offset, steps)
        # the bodies of members are those of their robots
        self._rows.place(*(np.concatenate([one[: self._own], one[self._count :]]) for one in poses))
        present = walkers.present[: self._own]
        changed = np.flatnonzero(self._shown != present)
        if len(changed):
            legged = np.cumsum(~self.gait.rides) - 1
            total = int((~self.gait.rides).sum())
            for row in changed.tolist():
                is_here = bool(present[row])
                own = [row]
                if not self.gait.rides[row]:
                    own += [self._own + int(legged[row]), self._own + total + int(legged[row])]
                for part in own:
                    self._bodies[part].setVisible(is_here)
            self._shown = present.copy()
        data["positions"] = np.column_stack([walkers.position + offset[:, :2], offset[:, 2]])
        climbs = self.floors.stairs.climbs(walkers.velocity, walkers.position, area)
        data["velocities"] = np.column_stack([walkers.velocity, self.riding.speeds() + climbs])
        data["present"] = walkers.present.copy()
        data["groups"] = walkers.group.astype(np.int32)

    def trunk(self, person: int) -> Body:
        """Return the trunk of a person."""
        return self._trunks[person]

    def record(self, person: int) -> dict[str, object]:
        """Return what trackers tell of a person; see `PeopleTracker`."""
        walkers, heading = self.walkers, self.gait.heading[person]
        return {
            "name": self._trunks[person].name,
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
        return RIDES[ride] if ride != ON_FOOT else WORDS[self.agenda.mode[person]]

    # -- services --------------------------------------------------------------------------

    def _check(self, person: int) -> None:
        if not 0 <= person < self._count:
            raise MorseRPCInvokationError(
                f"{self.name()} has {self._count} people: 0 to {self._count - 1}, not {person}"
            )
        if not self.walkers.present[person]:
            raise MorseRPCInvokationError(
                f"person {person} of {self.name()} is not in the world: {WORDS[self.agenda.mode[person]]}"
            )

    def _obey(self) -> None:
        """Refuse commands to people who walk as others have walked."""
        if self._tracks is not None:
            raise MorseRPCInvokationError(f"{self.name()} follows recorded trajectories: it obeys nobody")

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
            height = float(self.floors.heights_of(self.walkers.position, self.riding.area)[person])
            floor = self.floors.floor_of(height)
        way, place = self.plan.demand_way(x, y, floor)
        if math.isinf(float(self.walkers.time_on(way, np.array([person]))[0])):
            raise MorseRPCInvokationError(f"person {person} cannot reach ({x:g}, {y:g}): walls are between")
        self.agenda.target[person], self.agenda.mode[person] = place, SENT

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
        way, place = self.plan.demand_way(x, y, floor)
        rows = np.flatnonzero(self.walkers.present)
        time = self.walkers.time_on(way, rows)
        order = np.argsort(time, kind="stable")
        chosen = rows[order[np.isfinite(time[order])]][:count]
        self.agenda.target[chosen], self.agenda.mode[chosen] = place, SENT
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
        self._trails = self.agenda.forget_leaders(self._trails)
        self._sought = {name: place for name, place in self._sought.items() if name in self._trails}
        if robot not in self._trails and len(self._trails) >= MOST_LEADERS:
            raise MorseRPCInvokationError(f"{self.name()} follows {MOST_LEADERS} robots at most")
        way = self.plan.way_to(list(place))
        if way is None:
            raise MorseRPCInvokationError(f"{robot:.80} is where nobody can go: on the ground, or within a wall")
        rows = np.flatnonzero(self.walkers.present & (self.riding.ride == ON_FOOT))
        # a member that leads does not follow itself
        rows = rows[rows != self.members.rows.get(robot, -1)]
        time = self.walkers.time_on(way, rows)
        order = np.argsort(time, kind="stable")
        chosen = rows[order[np.isfinite(time[order])]][:count]
        self._trails[robot], self._sought[robot] = [place], [place]
        names = list(self._trails)
        self.agenda.mode[chosen], self.agenda.rank[chosen] = FOLLOWS, np.arange(len(chosen))
        self.agenda.leader[chosen] = names.index(robot)
        return [int(row) for row in chosen]

    def _member(self, robot: str) -> Guided:
        self._obey()
        guided = self.members.robot(robot)
        if guided is None:
            hint = nearest_name(robot, sorted(self.members.rows))
            raise MorseRPCInvokationError(
                f"'{robot:.80}' is no member of {self.name()}{hint}: members are those whom the script lets join"
            )
        return guided

    @service
    def join(self, robot: str) -> int:
        """Let a member of the crowd, a `Human`, walk with it to its goals; return its number.

        Its own actuators have no effect until `leave`.

        Args:
            robot: name of the robot, of which the script has said that it ``joins``.
        """
        place = self._place_of(robot) if self._member(robot) else None
        row = self.members.rows[robot]
        if self.walkers.present[row]:
            return row
        if place is None or self.ground.cell_at(np.array(place)) < 0:
            raise MorseRPCInvokationError(f"{robot:.80} is where nobody can go: on the ground, or within a wall")
        self.riding.area[row] = self.floors.floor_of(self._trunks[row].world_pose()[0][2])
        self.members.join(robot, self.walkers, self.agenda, np.array(place))
        self.gait.stand(np.array([row]), self.walkers.position)
        return row

    @service
    def leave(self, robot: str) -> None:
        """Leave a member of the crowd to its own actuators: people see it as a robot.

        Args:
            robot: name of the robot.
        """
        self._member(robot)
        self.riding.forget(self.members.rows[robot])
        self.members.leave(robot, self.walkers, self.agenda)

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
        self.agenda.mode[rows] = STOPPED

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
        rows = rows[np.isin(self.agenda.mode[rows], (STOPPED, SENT, FOLLOWS))]
        self.agenda.mode[rows] = WALKS

    @service(changes=False)
    def ask(self, person: _Person) -> dict[str, Any]:
        """Return what a person does: state, position and velocity (x, y), floor, free speed, group, height.

        The floor is -1 for somebody who rides in a lift, or is on stairs.

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

    def get_state(self) -> StateData:
        """See `Object.get_state`."""
        state = super().get_state()
        state["people"] = self._states.get()
        return state

    def set_state(self, state: StateData) -> None:
        """See `Object.set_state`.

        Raises:
            StateError: the people of the state are not those of the scene.
        """
        state = dict(state)
        trails = state.get("_trails", {})
        people = self._states.check(state.pop("people", None), trails)
        if not can_touch(state.get("_touching", {})) or not can_be(trails) or not can_be(state.get("_sought", {})):
            self._states.refuse()
        super().set_state(state)
        self._states.set(people)
        self._around.forget()
        self._show(self._steps())
