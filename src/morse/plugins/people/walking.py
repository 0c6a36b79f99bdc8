"""How people walk: positions and velocities on a plane, moved by a model of the literature.

Models:

* ``social-force``: D. Helbing and P. Molnár, Social force model for pedestrian dynamics, Phys. Rev. E 51 (1995), with
  the elliptical repulsion and the parameters of A. Johansson, D. Helbing and P. Shukla, Specification of the social
  force pedestrian model by evolutionary adjustment to video tracking data, Adv. Complex Syst. 10 (2007); forces of
  walls and between bodies that touch of D. Helbing, I. Farkas and T. Vicsek, Simulating dynamical features of escape
  panic, Nature 407 (2000); groups of M. Moussaïd et al., The walking behaviour of pedestrian social groups, PLoS ONE 5
  (2010).
* ``orca``: J. van den Berg, S. Guy, M. Lin and D. Manocha, Reciprocal n-body collision avoidance, Robotics Research
  (2011).

In the first one, people choose the direction in which they come farthest towards their goal, as in M. Moussaïd,
D. Helbing and G. Theraulaz, How simple rules determine pedestrian behavior and crowd disasters, PNAS 108 (2011).

In both, nobody wants to be faster than the room ahead allows: (gap to the next body ahead) / T, of A. Tordeux,
M. Chraibi and A. Seyfried, Collision-free speed model for pedestrian dynamics, Traffic and Granular Flow '15 (2016).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.kernel.walking import directions
from morse.mathutils import portable

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.plugins.people.wayfinding import Ground, Way

    Floats = NDArray[np.float64]
    Indices = NDArray[np.intp]


class SocialForce(NamedTuple):
    """Parameters of the social force model.

    Attributes:
        relaxation: s, to the wanted velocity.
        time_gap: s, to the body ahead (Tordeux et al. 2016).
        margin: m, added to the radius of bodies.
        strength, range: of the elliptical repulsion, m/s^2 and m.
        step: s, for which the others are seen to walk on.
        ahead: share of the repulsion of those behind, 0..1.
        wall, wall_range: of the repulsion of walls, m/s^2 and m, by the distance of the centre (Moussaid et al. 2009).
        gaze, attraction, separation: of groups, 1/s^2 and m/s^2.
    """

    relaxation: float = 0.5
    time_gap: float = 1.06
    margin: float = 0.0
    strength: float = 0.04
    range: float = 3.22
    step: float = 0.5
    ahead: float = 0.06
    wall: float = 3.0
    wall_range: float = 0.1
    gaze: float = 4.0
    attraction: float = 3.0
    separation: float = 1.0


class Orca(NamedTuple):
    """Parameters of ORCA.

    Attributes:
        time_gap: s, to the body ahead (Tordeux et al. 2016).
        margin: m, added to the radius of bodies.
        horizon: s, without collisions with others.
        wall_horizon: s, without collisions with walls.
        most: number of nearest neighbours.
        reach: m, of neighbours.
        acceleration: m/s^2, largest.
        rate: Hz, of new velocities.
    """

    time_gap: float = 1.06
    margin: float = 0.05
    horizon: float = 2.0
    wall_horizon: float = 0.5
    most: int = 10
    reach: float = 3.0
    acceleration: float = 5.0
    rate: float = 15.0


#: bodies are less deep than broad: 0.24 m to 0.4 m
_DEPTH = 0.6
#: N/m and kg/(m s), of bodies of 80 kg that touch (Helbing et al. 2000)
_BODY, _FRICTION, _MASS = 1.2e5, 2.4e5, 80.0
#: no walker is faster than its free speed by more than this (Helbing and Molnar 1995)
_FASTEST = 1.3
#: share of the radius up to which walls are from the centre: people turn their shoulders where it is narrow
_BY_WALLS = 0.75
#: m, in which people look for a free way (2011: 8 m, of few people)
_SIGHT = 3.0
#: cosines and sines of the other directions: 12 to 84 degrees, to the right first, the side to which people give way
_TURNS = np.array(
    [(math.cos(a), math.sin(a)) for k in range(1, 8) for a in (-k * math.radians(12), k * math.radians(12))]
)
#: m, cut-off of the repulsion: beyond it, it is below 1 % of gravity even at full speed
_REACH = 2.5
#: m: members of groups that are farther from their middle are on another floor, or lost
_APART = 30.0
_TINY = 1e-9


@dataclass(slots=True)
class Others:
    """Bodies that the walkers see and that this model does not move: robots, other crowds.

    Attributes:
        position, velocity: (M, 2) m, m/s.
        radius: (M,) m.
        seen: (N, M) which walker sees which of them.
    """

    position: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    velocity: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    radius: Floats = field(default_factory=lambda: np.zeros(0))
    seen: NDArray[np.bool_] = field(default_factory=lambda: np.zeros((0, 0), dtype=bool))

    def joined(self, more: Others) -> Others:
        """Return these bodies and others."""
        return Others(
            np.concatenate([self.position, more.position]),
            np.concatenate([self.velocity, more.velocity]),
            np.concatenate([self.radius, more.radius]),
            np.concatenate([self.seen, more.seen], axis=1),
        )


class Pairs(NamedTuple):
    """Directed pairs of neighbours: the second one influences the first one.

    Attributes:
        first: (P,) number of a walker.
        apart: (P, 2) from the second to the first one, m.
        distance: (P,) m, between the centres.
        velocity: (P, 2) of the second one, m/s.
        radii: (P,) sum of both radii, m.
        second: (P,) number of the second one; -1 for what this model does not move.
    """

    first: Indices
    apart: Floats
    distance: Floats
    velocity: Floats
    radii: Floats
    second: Indices


def neighbours(position: Floats, reach: float, others: Floats | None = None) -> tuple[Indices, Indices]:
    """Return the pairs (P,), (P,) of points that are closer than ``reach``, by cells of that size.

    Args:
        position: (N, 2) m.
        others: (M, 2) points for the second places; None for the points themselves.
    """
    second = position if others is None else others
    if not len(position) or not len(second):
        return np.zeros(0, dtype=np.intp), np.zeros(0, dtype=np.intp)
    low = np.minimum(position.min(axis=0), second.min(axis=0))
    cells = np.floor((second - low) / reach).astype(np.int64) + 1
    own = np.floor((position - low) / reach).astype(np.int64) + 1
    width = int(max(cells[:, 1].max(), own[:, 1].max())) + 2
    keys = cells[:, 0] * width + cells[:, 1]
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    rows: list[Indices] = []
    columns: list[Indices] = []
    # three cells of a column are one range of keys
    for across in (-1, 0, 1):
        middle = (own[:, 0] + across) * width + own[:, 1]
        begin, end = np.searchsorted(keys, middle - 1, "left"), np.searchsorted(keys, middle + 1, "right")
        count = end - begin
        row = np.repeat(np.arange(len(position)), count)
        offset = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        rows.append(row)
        columns.append(order[np.repeat(begin, count) + offset])
    i, j = np.concatenate(rows), np.concatenate(columns)
    apart = position[i] - second[j]
    near = (apart * apart).sum(axis=1) < reach * reach
    if others is None:
        near &= i != j
    i, j = i[near], j[near]
    # the same order of sums, whatever the cells are
    order = np.lexsort((j, i))
    return i[order], j[order]


def length(rows: Floats) -> Floats:
    """Return the lengths (N,) of vectors (N, 2)."""
    lengths: Floats = np.sqrt(rows[:, 0] * rows[:, 0] + rows[:, 1] * rows[:, 1])
    return lengths


def sums(first: Indices, vectors: Floats, count: int) -> Floats:
    """Return the sums (count, 2) of vectors (P, 2) by their first index."""
    x, y = (np.bincount(first, vectors[:, k], count) for k in (0, 1))
    return np.stack([x, y], axis=1)


@dataclass(slots=True)
class Walkers:
    """People on a plane.

    Attributes:
        ground: walls and ways.
        position, velocity: (N, 2) m, m/s.
        wanted: (N, 2) unit vector of the way; 0 for those who stand.
        free_speed: (N,) m/s.
        radius: (N,) m; walls and bodies are that far from the centre.
        mass: (N,) kg.
        group: (N,) number of the group; -1 for those who walk alone.
        present: (N,) whether a walker takes part.
        push: (N, 2) N, from outside, in the next step.
        leave: (N, 2) m/s, at which people are moved out of what they stand in, in the next step; 0 for the others.
        lag: s until ORCA has new velocities.
        planned: (N, 2) m/s, that ORCA has chosen.
        level: (N,) who takes no stairs.
    """

    ground: Ground
    position: Floats
    velocity: Floats
    wanted: Floats
    free_speed: Floats
    radius: Floats
    mass: Floats
    group: Indices
    present: NDArray[np.bool_]
    push: Floats
    leave: Floats
    lag: float = 0.0
    planned: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    level: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))

    @classmethod
    def at(
        cls, ground: Ground, position: Floats, free_speed: Floats | float = 1.34, radius: Floats | float = 0.25
    ) -> Walkers:
        """Create walkers at rest, of 80 kg, alone."""
        count = len(position)
        return cls(
            ground,
            np.array(position, dtype=np.float64).reshape(count, 2),
            np.zeros((count, 2)),
            np.zeros((count, 2)),
            np.full(count, free_speed) if np.isscalar(free_speed) else np.array(free_speed, dtype=np.float64),
            np.full(count, radius) if np.isscalar(radius) else np.array(radius, dtype=np.float64),
            np.full(count, _MASS),
            np.full(count, -1, dtype=np.intp),
            np.ones(count, dtype=bool),
            np.zeros((count, 2)),
            np.zeros((count, 2)),
            planned=np.zeros((count, 2)),
            level=np.zeros(count, dtype=bool),
        )

    def time_on(self, way: Way, rows: Indices) -> Floats:
        """Return the lengths (R,) of the ways of some walkers, m; infinite where there is none."""
        time = self.ground.time(way, self.position[rows])
        if way.level is None:
            return time
        return np.where(self.level[rows], self.ground.time(way.level, self.position[rows]), time)

    def heading_on(self, way: Way, rows: Indices) -> Floats:
        """Return the unit vectors (R, 2) in which some walkers go on a way; 0 where it ends, or where there is none."""
        heading = self.ground.heading(way, self.position[rows])
        if way.level is None:
            return heading
        return np.where(self.level[rows, None], self.ground.heading(way.level, self.position[rows]), heading)

    def step(self, seconds: float, model: SocialForce | Orca, others: Others | None = None) -> None:
        """Walk for some time."""
        here = np.flatnonzero(self.present)
        if not len(here):
            return
        pairs = self._pairs(here, others or Others(), model.reach if isinstance(model, Orca) else _REACH, model.margin)
        way = self.wanted if isinstance(model, Orca) else self._direction(pairs)
        speed = np.minimum(self.free_speed, self._room_ahead(pairs, way) / model.time_gap)
        speed = np.maximum(speed, 0.0)
        if isinstance(model, Orca):
            self.lag -= seconds
            if self.lag <= 1e-9:
                self.lag += 1.0 / model.rate
                self.planned = _orca_velocities(self, pairs, model, way * speed[:, None])
            change = self.planned - self.velocity
            most = model.acceleration * seconds
            size = length(change)
            acceleration = (
                change * np.where(size > most, model.acceleration / np.maximum(size, _TINY), 1.0 / seconds)[:, None]
            )
        else:
            acceleration = self._social(pairs, model, way * speed[:, None])
        acceleration = acceleration + self.push / self.mass[:, None]
        velocity = self.velocity + seconds * acceleration
        velocity += seconds * self._touching(pairs, velocity, seconds)
        size, most_speed = length(velocity), _FASTEST * self.free_speed
        pushed = (self.push != 0.0).any(axis=1)
        too_fast = (size > most_speed) & ~pushed
        velocity[too_fast] *= (most_speed[too_fast] / size[too_fast])[:, None]
        leaves = (self.leave != 0.0).any(axis=1)
        velocity[leaves] = self.leave[leaves] + (seconds / self.mass * self.push.T).T[leaves]
        velocity[~self.present] = 0.0
        self.push[:] = self.leave[:] = 0.0
        before = self.position
        self.position = self.ground.keep_out(before, before + seconds * velocity, _BY_WALLS * self.radius)
        self.velocity = np.where(self.present[:, None], (self.position - before) / seconds, 0.0)

    def _pairs(self, here: Indices, others: Others, reach: float, margin: float) -> Pairs:
        i, j = neighbours(self.position[here], reach)
        i, j = here[i], here[j]
        apart, velocity, radii = self.position[i] - self.position[j], self.velocity[j], self.radius[i] + self.radius[j]
        if len(others.position):
            k, m = neighbours(self.position[here], reach, others.position)
            k = here[k]
            sees = others.seen[k, m]
            k, m = k[sees], m[sees]
            apart = np.concatenate([apart, self.position[k] - others.position[m]])
            velocity = np.concatenate([velocity, others.velocity[m]])
            radii = np.concatenate([radii, self.radius[k] + others.radius[m]])
            i, j = np.concatenate([i, k]), np.concatenate([j, np.full(len(k), -1, dtype=np.intp)])
        distance = np.maximum(length(apart), _TINY)
        return Pairs(i, apart, distance, velocity, radii + 2.0 * margin, j)

    def _direction(self, pairs: Pairs) -> Floats:
        """Return the directions (N, 2) that bring people farthest towards their goals (Moussaid et al. 2011).

        Of each direction counts how far one walks at the free speed before the first collision, at most `_SIGHT`.
        """
        return directions(
            *(pairs.first, pairs.apart, pairs.velocity, pairs.distance, pairs.radii, self.position, self.wanted),
            *(self.free_speed, _BY_WALLS * self.radius, self.present, self.ground.gap, self.ground.origin),
            *(self.ground.cell, _SIGHT, _TURNS),
        )

    def _room_ahead(self, pairs: Pairs, way: Floats) -> Floats:
        """Return the gaps (N,) to the next body ahead, m: of those whose bodies are in the way (Tordeux 2016)."""
        room = np.full(len(self.position), np.inf)
        own = way[pairs.first]
        along = -(own * pairs.apart).sum(axis=1)
        across = np.abs(own[:, 0] * pairs.apart[:, 1] - own[:, 1] * pairs.apart[:, 0])
        deep = _DEPTH * pairs.radii
        is_ahead = (along > 0.0) & (across < deep)
        np.minimum.at(room, pairs.first[is_ahead], (pairs.distance - deep)[is_ahead])
        return room

    def _social(self, pairs: Pairs, model: SocialForce, aim: Floats) -> Floats:
        """Return the accelerations (N, 2), m/s^2, towards velocities (N, 2), m/s."""
        total = (aim - self.velocity) / model.relaxation
        y = (pairs.velocity - self.velocity[pairs.first]) * model.step
        d = pairs.apart
        shifted = d - y
        far, near, ahead = pairs.distance, np.maximum(length(shifted), _TINY), length(y)
        b = 0.5 * np.sqrt(np.maximum((far + near) ** 2 - ahead * ahead, 1e-4))
        size = model.strength * portable.exp(-b / model.range) * (far + near) / (2.0 * b)
        towards = 0.5 * (d / far[:, None] + shifted / near[:, None])
        gaze = self._facing()[pairs.first]
        cosine = -(gaze * d).sum(axis=1) / far
        weight = model.ahead + (1.0 - model.ahead) * 0.5 * (1.0 + cosine)
        total += sums(pairs.first, (size * weight)[:, None] * towards, len(total))
        gap, normal = self.ground.clearance(self.position)
        room = gap / model.wall_range
        push = np.where(room < 8.0, model.wall * portable.exp(-np.clip(room, 0.0, 8.0)), 0.0)
        total += push[:, None] * normal
        if (self.group >= 0).any():
            total += self._together(model)
        return total

    def _facing(self) -> Floats:
        """Return the unit vectors (N, 2) in which they look: where they want to go, else where they walk."""
        size = length(self.velocity)
        walking = self.velocity / np.maximum(size, _TINY)[:, None]
        return np.where((self.wanted != 0.0).any(axis=1)[:, None], self.wanted, walking)

    def _together(self, model: SocialForce) -> Floats:
        """Return the accelerations (N, 2) that keep groups together (Moussaid et al. 2010)."""
        total = np.zeros_like(self.position)
        members = np.flatnonzero((self.group >= 0) & self.present)
        if not len(members):
            return total
        _, which = np.unique(self.group[members], return_inverse=True)
        size = np.bincount(which).astype(np.float64)
        middle = sums(which, self.position[members], len(size))
        rest = np.maximum(size[which] - 1.0, 1.0)[:, None]
        # the centre of the others decides where one looks, that of all whether one is too far away
        of_others = (middle[which] - self.position[members]) / rest
        centre = middle[which] / size[which][:, None]
        towards, to_centre = of_others - self.position[members], centre - self.position[members]
        gaze = self._facing()[members]
        angle = portable.arctan2(
            np.abs(gaze[:, 0] * towards[:, 1] - gaze[:, 1] * towards[:, 0]), (gaze * towards).sum(axis=1)
        )
        # the head turns by half of the field of view, 90 degrees, by itself
        turn = np.maximum(angle - 0.5 * np.pi, 0.0)
        total[members] -= (model.gaze * turn)[:, None] * self.velocity[members]
        away = length(to_centre)
        # those on another floor are far away on the plane
        pull = np.where((away > 0.5 * (size[which] - 1.0)) & (away < _APART), model.attraction, 0.0)
        total[members] += (pull / np.maximum(away, _TINY))[:, None] * to_centre
        i, j = neighbours(self.position[members], 0.8)
        same = which[i] == which[j]
        i, j = members[i[same]], members[j[same]]
        apart = self.position[i] - self.position[j]
        away = np.maximum(length(apart), _TINY)
        total += sums(i, model.separation * apart / away[:, None], len(total))
        return total

    def _touching(self, pairs: Pairs, velocity: Floats, seconds: float) -> Floats:
        """Return the accelerations (N, 2) of bodies that overlap (Helbing et al. 2000).

        They are limited to what ends the overlap, and the sliding, within a step.
        """
        overlap = pairs.radii - pairs.distance
        touch = overlap > 0.0
        total = np.zeros_like(velocity)
        if not touch.any():
            return total
        i, apart, distance = pairs.first[touch], pairs.apart[touch], pairs.distance[touch]
        normal = apart / distance[:, None]
        relative = pairs.velocity[touch] - velocity[i]
        tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
        sliding = (relative * tangent).sum(axis=1)
        approach = (relative * normal).sum(axis=1)
        mass = self.mass[i]
        most = np.maximum(approach, 0.0) / (2.0 * seconds) + 0.25 * overlap[touch] / seconds**2
        press = np.minimum(_BODY * overlap[touch] / mass, most)
        rub = np.minimum(_FRICTION * overlap[touch] / mass, 0.25 / seconds)
        total += sums(i, press[:, None] * normal + (rub * sliding)[:, None] * tangent, len(total))
        return total


def _orca_velocities(walkers: Walkers, pairs: Pairs, model: Orca, preferred: Floats) -> Floats:
    """Return the velocities (N, 2) nearest to the preferred ones that avoid collisions, m/s."""
    count = len(preferred)
    rows, lines = _half_planes(walkers, pairs, model)
    # the nearest neighbours of each, and the walls first
    points, directions, used, walls = _stacked(rows, lines, count, model.most)
    most = walkers.free_speed
    result, failed = _nearest_in(points, directions, used, most, preferred)
    bad = np.flatnonzero(failed < used)
    if len(bad):
        result[bad] = _least_bad(
            points[bad], directions[bad], used[bad], walls[bad], most[bad], result[bad], failed[bad]
        )
    return result


class _Lines(NamedTuple):
    """Half planes of allowed velocities, to the left of directed lines: point (L, 2), direction (L, 2)."""

    point: Floats
    direction: Floats
    distance: Floats
    is_wall: NDArray[np.bool_]


def _half_planes(walkers: Walkers, pairs: Pairs, model: Orca) -> tuple[Indices, _Lines]:
    """Return the walkers (L,) and their half planes (van den Berg et al., section 4)."""
    i = pairs.first
    away = -pairs.apart
    relative = walkers.velocity[i] - pairs.velocity
    squared, radius = pairs.distance * pairs.distance, pairs.radii
    # those who see each other share the effort; who meets a robot does it all
    share = np.where(pairs.second >= 0, 0.5, 1.0)
    tau = np.where(pairs.distance > radius, model.horizon, 1.0 / model.rate)
    w = relative - away / tau[:, None]
    size = np.maximum(length(w), _TINY)
    inner = (w * away).sum(axis=1)
    on_disc = (pairs.distance <= radius) | ((inner < 0.0) & (inner * inner > radius * radius * size * size))
    unit = w / size[:, None]
    direction = np.stack([unit[:, 1], -unit[:, 0]], axis=1)
    u = (radius / tau - size)[:, None] * unit
    leg = np.sqrt(np.maximum(squared - radius * radius, 0.0))
    left = (away[:, 0] * w[:, 1] - away[:, 1] * w[:, 0]) > 0.0
    sign = np.where(left, 1.0, -1.0)
    x = away[:, 0] * leg - sign * away[:, 1] * radius
    y = sign * away[:, 0] * radius + away[:, 1] * leg
    along = sign[:, None] * np.stack([x, y], axis=1) / squared[:, None]
    u_leg = (relative * along).sum(axis=1)[:, None] * along - relative
    direction = np.where(on_disc[:, None], direction, along)
    u = np.where(on_disc[:, None], u, u_leg)
    point = walkers.velocity[i] + share[:, None] * u
    gap, normal = walkers.ground.clearance(walkers.position)
    size = length(normal)
    near = np.flatnonzero((gap - walkers.radius < model.wall_horizon * 2.0) & walkers.present & (size > 0.5))
    normal = normal[near] / size[near][:, None]
    limit = -(gap[near] - walkers.radius[near]) / model.wall_horizon
    wall_direction = np.stack([normal[:, 1], -normal[:, 0]], axis=1)
    lines = _Lines(
        np.concatenate([limit[:, None] * normal, point]),
        np.concatenate([wall_direction, direction]),
        np.concatenate([np.full(len(near), -1.0), pairs.distance - radius]),
        np.concatenate([np.ones(len(near), dtype=bool), np.zeros(len(i), dtype=bool)]),
    )
    return np.concatenate([near, i]), lines


def _stacked(rows: Indices, lines: _Lines, count: int, most: int) -> tuple[Floats, Floats, Indices, Indices]:
    """Return points and directions (N, K, 2), the numbers of lines (N,), and those of walls among them (N,)."""
    order = np.lexsort((np.arange(len(rows)), lines.distance, rows))
    rows = rows[order]
    begin = np.searchsorted(rows, np.arange(count), "left")
    place = np.arange(len(rows)) - begin[rows] if len(rows) else np.zeros(0, dtype=np.intp)
    keep = place < most + 1
    rows, order, place = rows[keep], order[keep], place[keep]
    used = np.bincount(rows, minlength=count)
    depth = int(used.max(initial=0))
    points, directions = np.zeros((count, depth, 2)), np.zeros((count, depth, 2))
    points[rows, place], directions[rows, place] = lines.point[order], lines.direction[order]
    walls = np.bincount(rows, lines.is_wall[order].astype(np.float64), count).astype(np.intp)
    return points, directions, used, walls


def _cross(a: Floats, b: Floats) -> Floats:
    product: Floats = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return product


def _on_line(
    points: Floats, directions: Floats, number: int, radius: Floats, aim: Floats, *, is_direction: bool
) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the best velocities (N, 2) on a line within the lines before it, and whether there is one (N,)."""
    point, direction = points[:, number], directions[:, number]
    dot = (point * direction).sum(axis=1)
    root = dot * dot + radius * radius - (point * point).sum(axis=1)
    possible = root >= 0.0
    root = np.sqrt(np.maximum(root, 0.0))
    low, high = -dot - root, -dot + root
    for other in range(number):
        denominator = _cross(direction, directions[:, other])
        numerator = _cross(directions[:, other], point - points[:, other])
        parallel = np.abs(denominator) <= 1e-9
        possible &= ~(parallel & (numerator < 0.0))
        t = numerator / np.where(parallel, 1.0, denominator)
        high = np.where(~parallel & (denominator >= 0.0), np.minimum(high, t), high)
        low = np.where(~parallel & (denominator < 0.0), np.maximum(low, t), low)
    possible &= low <= high
    if is_direction:
        t = np.where((aim * direction).sum(axis=1) > 0.0, high, low)
    else:
        t = np.clip((direction * (aim - point)).sum(axis=1), low, np.maximum(low, high))
    return point + t[:, None] * direction, possible


def _nearest_in(
    points: Floats, directions: Floats, used: Indices, radius: Floats, aim: Floats, *, is_direction: bool = False
) -> tuple[Floats, Indices]:
    """Solve the linear programs in two dimensions: velocities (N, 2), and the lines (N,) at which they fail."""
    if is_direction:
        result = aim * radius[:, None]
    else:
        size = length(aim)
        result = aim * np.where(size > radius, radius / np.maximum(size, _TINY), 1.0)[:, None]
    failed = used.copy()
    for number in range(points.shape[1]):
        active = (number < used) & (failed == used)
        broken = active & (_cross(directions[:, number], points[:, number] - result) > 0.0)
        rows = np.flatnonzero(broken)
        if not len(rows):
            continue
        better, possible = _on_line(
            points[rows], directions[rows], number, radius[rows], aim[rows], is_direction=is_direction
        )
        result[rows[possible]] = better[possible]
        failed[rows[~possible]] = number
    return result, failed


def _least_bad(
    points: Floats, directions: Floats, used: Indices, walls: Indices, radius: Floats, result: Floats, failed: Indices
) -> Floats:
    """Return the velocities that enter the half planes of others least, but not walls (section 5.3)."""
    distance = np.zeros(len(points))
    for number in range(points.shape[1]):
        depth = _cross(directions[:, number], points[:, number] - result)
        rows = np.flatnonzero((number >= failed) & (number < used) & (depth > distance))
        if not len(rows):
            continue
        lines, ways, count = _between(points[rows], directions[rows], walls[rows], number)
        aim = np.stack([-directions[rows, number, 1], directions[rows, number, 0]], axis=1)
        better, stopped = _nearest_in(lines, ways, count, radius[rows], aim, is_direction=True)
        good = stopped >= count
        result[rows[good]] = better[good]
        distance[rows] = _cross(directions[rows, number], points[rows, number] - result[rows])
    return result


def _between(points: Floats, directions: Floats, walls: Indices, number: int) -> tuple[Floats, Floats, Indices]:
    """Return the lines (R, K, 2) at which earlier half planes are entered as deeply as that of a number."""
    own_point, own_way = points[:, number], directions[:, number]
    lines, ways = points[:, :number].copy(), directions[:, :number].copy()
    keep = np.ones(lines.shape[:2], dtype=bool)
    for other in range(number):
        is_wall = other < walls
        way = directions[:, other]
        determinant = _cross(own_way, way)
        parallel = np.abs(determinant) <= 1e-9
        same = parallel & ((own_way * way).sum(axis=1) > 0.0)
        t = _cross(way, own_point - points[:, other]) / np.where(parallel, 1.0, determinant)
        crossing = np.where(parallel[:, None], 0.5 * (own_point + points[:, other]), own_point + t[:, None] * own_way)
        between = way - own_way
        between = between / np.maximum(length(between), _TINY)[:, None]
        lines[:, other] = np.where(is_wall[:, None], points[:, other], crossing)
        ways[:, other] = np.where(is_wall[:, None], way, between)
        keep[:, other] = is_wall | ~same
    # lines that are left out go to the end
    order = np.argsort(~keep, axis=1, kind="stable")
    lines, ways = (
        np.take_along_axis(lines, order[..., None], axis=1),
        np.take_along_axis(ways, order[..., None], axis=1),
    )
    return lines, ways, keep.sum(axis=1)
