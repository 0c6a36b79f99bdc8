"""Contacts of people and robots: limited forces on both, and how hard they are.

A body is a spring between a robot and the mass of the person, with the constants and the limits of ISO/TS 15066:2016,
annex A: the peak of a free impact is v sqrt(mu k), with the reduced mass mu (A.3.4). People are no walls: they are
moved, and give way to forces that no body withstands. Only what has approached compresses the spring: who stands in
something that was put there is moved out of it, and exerts no force.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.core.reports.quoting import nearest as nearest_name
from morse.plugins.people.walking import Others, Walkers
from morse.plugins.people.wayfinding import HEIGHT, Ground, distance_to, hull
from morse.scene import PhysicsType
from morse.scene.extent import corners
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.core.world import Body
    from morse.plugins.people.floors import Floors
    from morse.scene import Node

    Floats = NDArray[np.float64]


class Region(NamedTuple):
    """A region of the body, by ISO/TS 15066:2016, tables A.2 and A.3.

    Attributes:
        name: of the region.
        top: share of the height of the body up to which it reaches.
        stiffness: N/m.
        mass: kg, effective.
        pressing, impact: N, permissible forces, quasi-static and transient; None where an impact is not permissible.
    """

    name: str
    top: float
    stiffness: float
    mass: float
    pressing: float
    impact: float | None


REGIONS = (
    Region("lower legs", 0.285, 60e3, 75.0, 130.0, 260.0),
    Region("thighs and knees", 0.48, 50e3, 75.0, 220.0, 440.0),
    Region("pelvis", 0.58, 25e3, 40.0, 180.0, 360.0),
    Region("abdomen", 0.68, 10e3, 40.0, 110.0, 220.0),
    Region("chest", 0.80, 25e3, 40.0, 140.0, 280.0),
    Region("neck", 0.87, 50e3, 1.2, 150.0, 300.0),
    Region("skull and face", 1.0, 75e3, 4.4, 65.0, None),
)


def regions(low: float, high: float, height: float) -> tuple[Region, ...]:
    """Return the regions of a body of a height that something between two heights above the floor meets, m."""
    bottom, met = 0.0, []
    for region in REGIONS:
        top = region.top * height
        if low < top and high > bottom:
            met.append(region)
        bottom = top
    return tuple(met)


class Footprint(NamedTuple):
    """What a robot covers of the floor, in its own axes.

    Attributes:
        outline: (V, 2) convex, counter-clockwise, m.
        low, high: heights of its lowest and its highest point above its origin, m.
        discs: (D, 3) centres and radii, m: circles that cover the outline.
    """

    outline: Floats
    low: float
    high: float
    discs: Floats


class Strangers(NamedTuple):
    """People of another crowd on a floor of this one: places (M, 2) on the plane, m, velocities, m/s, radii (M,), m."""

    position: Floats
    velocity: Floats
    radius: Floats
    floor: int


class Mover(NamedTuple):
    """A robot that people may see and touch."""

    body: Body
    print: Footprint
    seen: NDArray[np.bool_]


def is_placed(node: Node) -> bool:
    """Whether explicit calls move a body that others touch."""
    return node.body.type is PhysicsType.KINEMATIC and node.body.collides


def footprint(node: Node, bodies: Iterable[Node]) -> Footprint | None:
    """Return the footprint of a robot; None if it has no shapes.

    Args:
        node: of the robot.
        bodies: with the shapes of the robot, at their poses in the scene.
    """
    own = rigid_frame(node)
    turn = np.array([[float(v) for v in row] for row in own.rotation])
    clouds = []
    for body in bodies:
        frame = rigid_frame(body)
        position = np.array([float(v) for v in frame.position])
        rotation = np.array([[float(v) for v in row] for row in frame.rotation])
        clouds += [corners(shape, position, rotation) for shape in body.shapes or () if shape.heights is None]
    if not clouds:
        return None
    apart = np.concatenate(clouds) - np.array([float(v) for v in own.position])
    points = np.stack([(apart * turn[:, axis]).sum(axis=1) for axis in range(3)], axis=1)
    outline = hull(points[:, :2])
    if len(outline) < 3:
        return None
    return Footprint(outline, float(points[:, 2].min()), float(points[:, 2].max()), _discs(outline))


def _discs(outline: Floats) -> Floats:
    low, high = outline.min(axis=0), outline.max(axis=0)
    size = high - low
    long = int(size.argmax())
    count = min(max(1, round(size[long] / max(size[1 - long], 0.1))), 8)
    part = size[long] / count
    discs = np.zeros((count, 3))
    discs[:, 1 - long] = 0.5 * (low[1 - long] + high[1 - long])
    discs[:, long] = low[long] + part * (np.arange(count) + 0.5)
    discs[:, 2] = 0.5 * math.hypot(part, size[1 - long])
    return discs


def ways_out(outline: Floats, point: Floats) -> list[tuple[float, Floats, Floats]]:
    """Return distance (m, negative within), place and way out of a point for the edges of a convex outline.

    The first one is the nearest; from outside of the outline, there is only that one.
    """
    a, b = outline, np.roll(outline, -1, axis=0)
    way = b - a
    share = np.clip(((point - a) * way).sum(axis=1) / np.maximum((way * way).sum(axis=1), 1e-12), 0.0, 1.0)
    places = a + share[:, None] * way
    apart = point - places
    distances = np.sqrt((apart * apart).sum(axis=1))
    side = way[:, 0] * (point[1] - a[:, 1]) - way[:, 1] * (point[0] - a[:, 0])
    within = bool((side >= 0.0).all())
    found = []
    for edge in np.argsort(distances, kind="stable").tolist() if within else [int(distances.argmin())]:
        outward = np.array([way[edge, 1], -way[edge, 0]])
        outward = outward / max(math.hypot(*outward.tolist()), 1e-12)
        if not within and distances[edge] > 1e-9:
            outward = apart[edge] / distances[edge]
        found.append((-float(distances[edge]) if within else float(distances[edge]), places[edge], outward))
    return found


#: steps of the spring within a tick
_PARTS = 32
#: N: a body gives way to more, because people who are hit harder fall; legs break at 4,000 N
GIVES_WAY = 2500.0


def press(
    overlap: float, closing: float, seconds: float, region: Region, robot_mass: float, body_mass: float
) -> tuple[float, float, float]:
    """Return the impulse (N s) of a contact during a tick, its largest force (N), and how far the body gave way (m).

    Args:
        overlap: m, at the beginning; negative for a gap.
        closing: m/s, speed at which they approach each other.
        seconds: of the tick.
        region: of the body.
        robot_mass: kg; infinite for a robot whose drive does not yield.
        body_mass: kg, of the person.
    """
    inverse = 1.0 / body_mass + (0.0 if math.isinf(robot_mass) else 1.0 / robot_mass)
    step, impulse, peak, gave = seconds / _PARTS, 0.0, 0.0, 0.0
    deepest = GIVES_WAY / region.stiffness
    for _ in range(_PARTS):
        if overlap > deepest:
            gave, overlap = gave + overlap - deepest, deepest
        force = region.stiffness * max(overlap, 0.0)
        closing -= step * force * inverse
        overlap += step * closing
        impulse += step * force
        peak = max(peak, force)
    return impulse, peak, gave


#: s: a contact that lasts longer is a pressure, not an impact (ISO/TS 15066, 5.5.4)
_IMPACT = 0.5
#: m: a contact that deepens by that much more than by its speed in a tick was put there
_JUMP = 0.01
#: m/s, at which people leave what they stand in
_LEAVES = 1.0
#: m, from which people open a door
_REACHES_DOORS = 1.6
#: m, height of what people step onto without noticing
_FLAT = 0.05
#: m: people and doors that are so near to a floor are on it
_SAME_FLOOR = 1.0


class Touch(NamedTuple):
    """A contact that lasts, as plain data of a state.

    Attributes:
        since: s, its begin.
        rest: m, overlap without a force.
        overlap: m, in the last tick.
    """

    since: float
    rest: float
    overlap: float


def can_touch(touching: object) -> bool:
    """Whether contacts of a state are possible."""
    return isinstance(touching, dict) and all(
        isinstance(one, tuple | list)
        and len(one) == 3
        and all(isinstance(value, float) and abs(value) < 1e12 for value in one)
        for one in touching.values()
    )


class Surroundings:
    """What people meet besides each other and walls: robots, objects that move, other crowds.

    Args:
        context: of the simulation.
        crowd: name of the robot that the crowd is.
        floors: on which people walk.
        shares: names of robots, and which share of the people sees them.
        alert: (N,) who sees a robot: those below its share.
    """

    def __init__(
        self, context: Context, crowd: str, floors: Floors, shares: Mapping[str, float], alert: Callable[[], Floats]
    ) -> None:
        self.context, self.crowd, self.floors, self.shares = context, crowd, floors, shares
        self._alert = alert
        self._movers: list[Mover] | None = None
        self._arrangement: tuple[int, list[str]] = (-1, [])

    def crowds(self) -> list[Strangers]:
        """Return the people of the other crowds, on the floors of this one."""
        found = []
        for name, robot in self.context.robots.items():
            walkers = getattr(robot, "walkers", None)
            if name == self.crowd or not isinstance(walkers, Walkers):
                continue
            rows, places = np.flatnonzero(walkers.present), np.asarray(robot.local_data["positions"])
            if len(places) != len(walkers.present):
                continue  # it has not begun
            for floor in range(self.floors.count):
                apart = np.abs(places[rows, 2] - self.floors.heights[floor])
                here = rows[(apart < _SAME_FLOOR) & self.floors.within(places[rows, :2])]
                position = places[here, :2] + self.floors.shift[floor]
                found.append(Strangers(position, walkers.velocity[here], walkers.radius[here], floor))
        return found

    def people_on(self, floor: int) -> list[Floats]:
        """Return the places (M, 2) of the people of other crowds on a floor, on the plane, m."""
        return [one.position for one in self.crowds() if one.floor == floor]

    def forget(self) -> None:
        """Look at all things again."""
        self._movers = None

    def movers(self) -> list[Mover]:
        """Return the robots and the moving objects, which people may see and touch."""
        world = self.context.world
        # members of crowds are people, not robots
        members = [name for robot in self.context.robots.values() for name in present_members(robot)]
        if self._movers is not None and self._arrangement == (world.arrangement, members):
            return self._movers
        self._arrangement, self._movers = (world.arrangement, members), []
        for name in self.shares:
            if name not in self.context.robots:
                hint = nearest_name(name, sorted(self.context.robots))
                text = f"{self.crowd}.avoids: there is no robot '{name:.80}'{hint}"
                self.context.complaints.warn(text, text)
        roots: dict[Body, float] = {}
        stairs = {flight.node for flight in self.floors.flights}
        for name, robot in self.context.robots.items():
            if isinstance(getattr(robot, "walkers", None), Walkers) or name in members:
                continue
            if robot.bge_object.node in stairs:
                continue
            share, body = self.shares.get(name, 1.0), robot.bge_object
            # what only owns others, such as the panels of a door, is nothing of its own
            panels = [node for node in body.node.walk() if is_placed(node)]
            roots |= dict.fromkeys([world.object_of(node) for node in panels] if panels else [body], share)
        nodes = {body.node for body in roots}
        nodes |= stairs
        nodes |= {self.context.robots[name].bge_object.node for name in members if name in self.context.robots}
        stack = list(self.context.scene.roots)
        while stack:
            node = stack.pop()
            if node in nodes:
                continue
            found = world.find_object(node) if node.body.moves or is_placed(node) else None
            if found is not None:
                roots[found] = 1.0
            else:
                stack += node.children
        for body, share in roots.items():
            outline = footprint(body.node, [node for node in body.node.walk() if node.body.collides])
            if outline is not None:
                self._movers.append(Mover(body, outline, self._alert() < share))
        return self._movers

    def outlines(self) -> list[Floats]:
        """Return the outlines (V, 2) of what may move and is as high as people, at its present places, m."""
        return [one for floor in range(self.floors.count) for one in self.outlines_on(floor)]

    def outlines_on(self, floor: int) -> list[Floats]:
        """Return those of them that are on a floor."""
        found = []
        for mover in self.movers():
            place, turn = mover.body.world_pose()
            if self._is_met(mover, place[2], floor) and self.floors.within(np.array([place[:2]]))[0]:
                x, y = mover.print.outline.T
                flat = [turn[0] * x + turn[1] * y + place[0], turn[3] * x + turn[4] * y + place[1]]
                found.append(hull(np.stack(flat, axis=1) + self.floors.shift[floor]))
        return found

    def _is_met(self, mover: Mover, height: float, area: int) -> bool:
        low, high = (height + part - self.floors.heights[area] for part in (mover.print.low, mover.print.high))
        return bool(low < HEIGHT and high > _FLAT)

    def open_doors(self, walkers: Walkers, area: NDArray[np.intp]) -> None:
        """Let people open the doors to which they walk: robots with a service ``open`` and a field ``openness``.

        Args:
            walkers: people.
            area: (N,) on which floor each of them is.
        """
        rows: NDArray[np.intp] | None = None
        for robot in self.context.robots.values():
            data = robot.local_data
            call: Callable[[], object] | None = getattr(robot, "open", None)
            if not callable(call) or data.get("openness", 1.0) == 1.0 or data.get("locked", True):
                continue
            if rows is None:
                rows = np.flatnonzero(walkers.present & (walkers.wanted != 0.0).any(axis=1))
            place = robot.bge_object.world_pose()[0]
            apart = np.array([place[0], place[1]]) - (walkers.position[rows] - self.floors.shift[area[rows]])
            towards = (apart * walkers.wanted[rows]).sum(axis=1)
            beside = np.abs(place[2] - self.floors.heights[area[rows]]) <= _SAME_FLOOR
            if (beside & (towards > 0.0) & ((apart * apart).sum(axis=1) < _REACHES_DOORS**2)).any():
                call()

    def seen(self, count: int) -> Others:
        """Return what ``count`` people see besides each other."""
        position, velocity, radius, seen = [], [], [], []
        for mover in self.movers():
            place, turn = mover.body.world_pose()
            met = [floor for floor in range(self.floors.count) if self._is_met(mover, place[2], floor)]
            if not met or not self.floors.within(np.array([place[:2]]))[0]:
                continue
            linear, angular = mover.body.velocity()
            for shift in self.floors.shift[met].tolist():
                for x, y, r in mover.print.discs.tolist():
                    dx, dy = turn[0] * x + turn[1] * y, turn[3] * x + turn[4] * y
                    position.append((place[0] + dx + shift[0], place[1] + dy + shift[1]))
                    velocity.append((linear[0] - angular[2] * dy, linear[1] + angular[2] * dx))
                    radius.append(r)
                    seen.append(mover.seen)
        places, speeds = [np.reshape(position, (-1, 2))], [np.reshape(velocity, (-1, 2))]
        radii, sights = [np.array(radius)], [np.reshape(seen, (-1, count)).T]
        for there in self.crowds():
            places.append(there.position)
            speeds.append(there.velocity)
            radii.append(there.radius)
            sights.append(np.ones((count, len(there.radius)), dtype=bool))
        columns = [np.concatenate(parts) for parts in (places, speeds, radii)]
        return Others(columns[0], columns[1], columns[2], np.concatenate(sights, axis=1).astype(bool))

    def touch(
        self,
        walkers: Walkers,
        area: NDArray[np.intp],
        heights: Floats,
        touching: dict[str, tuple[float, float, float]],
    ) -> list[dict[str, Any]]:
        """Let people and things that touch push each other; return the contacts.

        Args:
            walkers: people, whose pushes are set, and who are moved out of what they stand in. The physics pushes
                members, who are the last ones.
            area: (N,) on which floor, or in which cabin, each of them is.
            heights: (P,) m, of the people without the members.
            touching: contacts that last, `Touch` by the names of both, which is changed.
        """
        contacts: list[dict[str, Any]] = []
        alive: dict[str, tuple[float, float, float]] = {}
        present = np.flatnonzero(walkers.present[: len(heights)])
        heights_of_floors = self.floors.heights_of(walkers.position, area)
        floor, shift = heights_of_floors[present], self.floors.shift[area[present]]
        for mover in self.movers():
            place, _ = mover.body.world_pose()
            outer = float(np.sqrt((mover.print.outline**2).sum(axis=1)).max())
            apart = walkers.position[present] - shift - np.array([place[0], place[1]])
            reach = outer + walkers.radius[present] + 0.1
            near = (apart * apart).sum(axis=1) < reach * reach
            if self.floors.count > 1:
                # who rides in a cabin touches no wall of it
                rides = (area[present] >= self.floors.count) & is_placed(mover.body.node)
                near &= (place[2] + mover.print.low - floor < HEIGHT) & (place[2] + mover.print.high > floor) & ~rides
            for person in present[near].tolist():
                below = float(heights_of_floors[person])
                contact = self._contact(
                    mover, person, int(area[person]), below, walkers, float(heights[person]), touching, alive
                )
                if contact is not None:
                    contacts.append(contact)
        touching.clear()
        touching.update(alive)
        return contacts

    def _contact(
        self,
        mover: Mover,
        person: int,
        area: int,
        floor: float,
        walkers: Walkers,
        tall: float,
        before: Mapping[str, tuple[float, float, float]],
        alive: dict[str, tuple[float, float, float]],
    ) -> dict[str, Any] | None:
        body, seconds = mover.body, 1.0 / self.context.clock.frequency
        place, turn = body.world_pose()
        met = regions(place[2] + mover.print.low - floor, place[2] + mover.print.high - floor, tall)
        if not met:
            return None
        dx, dy = (walkers.position[person] - self.floors.shift[area] - np.array([place[0], place[1]])).tolist()
        local = np.array([turn[0] * dx + turn[3] * dy, turn[1] * dx + turn[4] * dy])
        ways = ways_out(mover.print.outline, local)
        distance, touched, out = ways[0][0], ways[0][1].tolist(), ways[0][2].tolist()
        overlap = float(walkers.radius[person]) - distance
        normal = (turn[0] * out[0] + turn[1] * out[1], turn[3] * out[0] + turn[4] * out[1])
        arm = (turn[0] * touched[0] + turn[1] * touched[1], turn[3] * touched[0] + turn[4] * touched[1])
        linear, angular = body.velocity()
        robot = (linear[0] - angular[2] * arm[1], linear[1] + angular[2] * arm[0])
        own = walkers.velocity[person].tolist()
        closing = (robot[0] - own[0]) * normal[0] + (robot[1] - own[1]) * normal[1]
        if overlap + closing * seconds <= 0.0:
            return None
        key, now = f"{person} {body.name}", self.context.clock.time
        since, rest, last = before.get(key, Touch(now, 0.0, 0.0))
        jump = overlap - last - max(closing, 0.0) * seconds
        # what leaves does not take its dent along
        rest = max(min(rest + (jump if jump > _JUMP else 0.0), overlap), 0.0)
        if rest > _JUMP:
            self._move_out(walkers, person, turn, ways, overlap)
        # the softest region yields first; the strictest limit holds
        region = min(met, key=lambda one: one.stiffness)
        mass = body.mass if body.is_dynamic and body.mass > 0.0 else math.inf
        impulse, peak, gave = press(overlap - rest, closing, seconds, region, mass, float(walkers.mass[person]))
        alive[key] = Touch(since, rest + gave, overlap)
        if impulse <= 0.0:
            return None
        force = impulse / seconds
        walkers.push[person] += (force * normal[0], force * normal[1])
        if body.is_dynamic:
            push = (-force * normal[0], -force * normal[1], 0.0)
            body.wrench(push, (0.0, 0.0, arm[0] * push[1] - arm[1] * push[0]), False)
        strict = min(met, key=lambda one: one.pressing)
        return {
            "person": person,
            "robot": body.name,
            "force": peak,
            "region": strict.name,
            "limit": (strict.impact or 0.0) if now - since < _IMPACT else strict.pressing,
            "point": [place[0] + arm[0], place[1] + arm[1], place[2] + 0.5 * (mover.print.low + mover.print.high)],
        }

    @staticmethod
    def _move_out(
        walkers: Walkers, person: int, turn: Any, ways: list[tuple[float, Floats, Floats]], overlap: float
    ) -> None:
        """Move a person out of something by the nearest way that no wall shuts."""
        radius, here = float(walkers.radius[person]), walkers.position[person]
        for distance, _, out in ways:
            aim = np.array([turn[0] * out[0] + turn[1] * out[1], turn[3] * out[0] + turn[4] * out[1]])
            if walkers.ground.clearance((here + (radius - distance) * aim)[None])[0][0] >= walkers.ground.radius:
                walkers.leave[person] = aim * min(_LEAVES, overlap * 60.0)
                return


class Places:
    """Where people may begin: not in walls, nor in what may move, nor in others.

    Args:
        ground: with the walls.
        outlines: (V, 2) of all else that people would stand in, m.
        crowds: other people, who are there already.
        present: the people of the own crowd, who are there already.
    """

    def __init__(
        self, ground: Ground, outlines: Iterable[Floats], crowds: Iterable[Strangers], present: Walkers | None = None
    ) -> None:
        self._ground, self._outlines = ground, [one for one in outlines if len(one) > 2]
        self._taken = np.zeros((64, 3))
        self._count = 0
        if present is not None:
            for row in np.flatnonzero(present.present).tolist():
                self.take(present.position[row], float(present.radius[row]))
        for crowd in crowds:
            for place, radius in zip(crowd.position, crowd.radius.tolist(), strict=True):
                self.take(place, radius)

    def take(self, place: Floats, radius: float) -> None:
        """Note that somebody of a radius (m) stands at a place (2,)."""
        if self._count == len(self._taken):
            self._taken = np.concatenate([self._taken, np.zeros_like(self._taken)])
        self._taken[self._count, :2], self._taken[self._count, 2] = place, radius
        self._count += 1

    def are_open(self, points: Floats, radius: float) -> NDArray[np.bool_]:
        """Whether nothing but people is at points (P, 2) for a body of a radius, m."""
        good = self._ground.clearance(points)[0] > radius
        for outline in self._outlines:
            rows = np.flatnonzero(good)
            if len(rows):
                good[rows] = distance_to(outline, points[rows]) > radius
        return good

    def are_free(self, points: Floats, radius: float, gap: float = 0.0) -> NDArray[np.bool_]:
        """Whether nobody is within a gap, m, of bodies of a radius at points (P, 2)."""
        taken = self._taken[: self._count]
        good = np.ones(len(points), dtype=bool)
        for begin in range(0, len(points), 64):
            part = points[begin : begin + 64, None, :] - taken[None, :, :2]
            least = taken[:, 2] + radius + gap
            good[begin : begin + 64] = ((part * part).sum(axis=2) >= (least * least)[None] * (1.0 - 1e-9)).all(axis=1)
        return good


def present_members(robot: Any) -> list[str]:
    """Return the names of the robots that walk with a crowd at present; none for a robot that is no crowd."""
    rows, walkers = getattr(getattr(robot, "members", None), "rows", None), getattr(robot, "walkers", None)
    if not isinstance(rows, dict) or not isinstance(walkers, Walkers):
        return []
    return [name for name, row in rows.items() if walkers.present[row]]
