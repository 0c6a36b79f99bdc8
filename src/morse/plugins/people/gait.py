"""How the bodies of people walk: a foot on the ground stays where it is.

One foot supports while the other one swings to the place where it will support next. People who stop put their feet
beside each other first, and those who stand make a step when their feet are no longer below them. The length of a step
follows from the speed by the walk ratio, 0.0064 m / (steps/min) of N. Sekiya and H. Nagasaki, Reproducibility of the
walking patterns of normal young adults, Gait & Posture 7 (1998), which hardly depends on the speed.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils import portable

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.plugins.people.stairs import Steps

    Floats = NDArray[np.float64]
    Booleans = NDArray[np.bool_]

#: share of the height of a body up to the hip (Drillis and Contini 1966)
HIP = 0.53
#: m per (steps/min), as m s per step
_WALK_RATIO = 0.0064 * 60.0
#: m, at heights of 1.72 m: half the distance of the feet, their largest lift
_HALF_WIDTH, _LIFT = 0.09, 0.07
#: m/s; slower ones stand
_STANDS = 0.05
#: s, of the slowest step, and of one of people whose supporting foot is far from them
_SLOWEST, _FASTEST = 0.8, 0.25
#: share of a step after which the goal of the foot is certain
_DECIDED = 0.7
#: m; feet that are nearer to their places below the hips may stand there, and farther ones make a step
_NEAR, _FAR = 0.05, 0.12
#: m/s, of hips that rise or are lowered
_RISE = 0.8
#: share of the height of a body, of the hips of somebody who sits
_SEAT = 0.27
#: where the bodies of those are who have left, m below the ground
_BELOW = 100.0


@dataclass(slots=True)
class Gait:
    """The feet of people.

    Attributes:
        height: (N,) m.
        rides: (N,) who has no legs that walk.
        phase: (N,) steps since the start: the left foot supports in even ones, the right foot in odd ones.
        stride: (N,) m, length of the present step.
        feet: (N, 2, 2) m, where the left and the right foot are, seen from above.
        heading: (N, 2) unit vectors.
        stands: (N,) who stands on both feet.
        hip: (N,) m, height of the hips above the ground.
        goal: (N, 2) m, where the swinging foot is put down.
        ground: (N, 2) m, heights of the steps of stairs below the feet, above the part of the plane.
    """

    height: Floats
    rides: Booleans
    phase: Floats
    stride: Floats
    feet: Floats
    heading: Floats
    stands: Booleans
    hip: Floats = field(init=False)
    goal: Floats = field(init=False)
    ground: Floats = field(init=False)

    def __post_init__(self) -> None:
        """Stand upright."""
        self.hip = HIP * self.height
        self.goal, self.ground = np.zeros((2, len(self.height), 2))

    @classmethod
    def at(cls, position: Floats, heading: Floats, height: Floats, rides: Booleans, phase: Floats) -> Gait:
        """Let people stand somewhere."""
        count = len(height)
        gait = cls(
            height, rides, phase, np.full(count, 0.3), np.zeros((count, 2, 2)), heading, np.ones(count, dtype=bool)
        )
        gait.stand(np.arange(len(height)), position)
        return gait

    def stand(self, rows: NDArray[np.intp], position: Floats, steps: Steps | None = None) -> None:
        """Put some people, (R,) of them, on both feet at once: those who appear at another place.

        Args:
            rows: their numbers.
            position: (N, 2) m, of all people.
            steps: below those who are on stairs.
        """
        self.phase[rows] = np.floor(self.phase[rows])
        self.stands[rows] = True
        self.hip[rows] = HIP * self.height[rows]
        self.feet[rows] = _on_steps(steps, self._homes(position))[rows]
        for side in (0, 1):
            self.ground[rows, side] = 0.0 if steps is None else steps.ground(rows, self.feet[rows, side])

    def _homes(self, position: Floats, sits: Booleans | None = None) -> Floats:
        """Return where the feet (N, 2, 2) of people stand, m: below the hips; who sits has them in front."""
        left = np.stack([-self.heading[:, 1], self.heading[:, 0]], axis=1)
        aside = left * (_HALF_WIDTH / 1.72 * self.height)[:, None]
        middle = position
        if sits is not None:
            reach = np.sqrt(np.maximum((HIP * self.height) ** 2 - self.hip * self.hip, 0.0)) * sits
            middle = position + reach[:, None] * self.heading
        return np.stack([middle + aside, middle - aside], axis=1)

    def step(
        self,
        seconds: float,
        position: Floats,
        velocity: Floats,
        facing: Floats,
        sits: Booleans,
        steps: Steps | None = None,
    ) -> None:
        """Walk for some time.

        Args:
            seconds: at most the time of a step.
            position: (N, 2) m, after that time.
            velocity: (N, 2) m/s.
            facing: (N, 2) where those look who stand; 0 for no change.
            sits: (N,) who sits.
            steps: below those who are on stairs: each of them takes one after the other.
        """
        each = np.arange(len(position))
        speed = _size(velocity)
        # people walk forwards where they can: they turn by at most 3 rad/s
        walks = speed > _STANDS
        self._turn(np.where((speed > 0.3)[:, None], velocity, facing), 3.0 * seconds)
        length = np.sqrt(_WALK_RATIO * np.maximum(speed, 0.2)) * np.sqrt(self.height / 1.72)
        if steps is not None:
            length = np.where(np.isnan(steps.tread), length, steps.tread)
        homes = self._homes(position, sits)
        stand = _on_steps(steps, homes)
        away = _size(self.feet - stand)
        begins = self.stands & (walks | (away.max(axis=1) > _FAR))
        # the foot that is farther away steps first
        self.phase += begins & (away[each, self._supporting()] > away.min(axis=1))
        self.stride = np.where(begins, length, self.stride)
        self.stands &= ~begins
        # a step of those who turn, are pushed, or sit down is short
        hurries = sits | (_size(self.feet[each, self._supporting()] - position) > 0.5 * self.stride + 0.1)
        rate = np.maximum(speed / self.stride, np.where(hurries, 1.0 / _FASTEST, 1.0 / _SLOWEST))
        share, side = self._share(), 1 - self._supporting()
        progress = np.where(self.stands, 0.0, np.minimum(rate * seconds, 1.0))
        self.phase += progress
        after = share + progress
        # the foot is put down half a step ahead of where the hip is then
        left = (1.0 - after) / rate + 0.5 * np.minimum(self.stride / np.maximum(speed, 1e-9), _SLOWEST)
        # a foot that is nearly there does not change its goal, so that it does not slide when it touches the ground
        aim = homes[each, side] + velocity * left[:, None]
        aim = aim if steps is None else steps.landing(each, aim)
        self.goal = np.where((share < _DECIDED)[:, None], aim, self.goal)
        lands = after >= 1.0
        covered = _smooth(share)
        part = np.where(lands, 1.0, (_smooth(np.minimum(after, 1.0)) - covered) / np.maximum(1.0 - covered, 1e-12))
        self.feet[each, side] += part[:, None] * (self.goal - self.feet[each, side])
        ground = 0.0 if steps is None else steps.ground(each, self.goal)
        self.ground[each, side] += part * (ground - self.ground[each, side])
        self.stride = np.where(lands, length, self.stride)
        stops = lands & ~walks & (_size(self.feet - stand).max(axis=1) < _NEAR)
        self.phase = np.where(stops, np.floor(self.phase), self.phase)
        self.stands |= stops
        self._raise(seconds, position, sits, steps)

    def _supporting(self) -> NDArray[np.intp]:
        """Return the feet (N,) that support: 0 for the left one."""
        return np.floor(self.phase).astype(np.intp) % 2

    def _share(self) -> Floats:
        """Return the parts (N,) of the present steps that are over."""
        return self.phase - np.floor(self.phase)

    def _raise(self, seconds: float, position: Floats, sits: Booleans, steps: Steps | None) -> None:
        """Raise or lower the hips: as high as the leg that supports allows."""
        leg = HIP * self.height
        aim, rise = np.where(sits, _SEAT * self.height, leg), self.ground
        if steps is not None:
            # hips move along the slope, and are so low that the leg reaches the step behind
            low = np.sqrt(leg * leg - steps.half**2) - steps.bend
            aim, rise = aim + np.where(sits, 0.0, steps.share) * (low - aim), self.ground - steps.slope()[:, None]
        self.hip += np.clip(aim - self.hip, -_RISE * seconds, _RISE * seconds)
        each, supporting = np.arange(len(position)), self._supporting()
        apart = _size(self.feet - self._homes(position))
        # nobody stretches: who is carried away puts the feet down anew
        gone = np.flatnonzero((apart[each, supporting] > 0.95 * leg) & ~self.rides)
        allowed = rise + np.sqrt(np.maximum((leg * leg)[:, None] - apart * apart, 0.0))
        # hips of those who stand are as low as both legs allow, and at the end of a step as low as the other one will
        ahead = allowed[each, 1 - supporting] + np.where(self.stands, 0.0, 0.2) * (1.0 - self._share())
        self.hip = np.minimum(self.hip, np.minimum(allowed[each, supporting], ahead))
        if len(gone):
            self.stand(gone, position, steps)
        self.hip = np.where(self.rides, leg, np.maximum(self.hip, 0.0))

    def _turn(self, aim: Floats, most: float) -> None:
        size = _size(aim)
        cross = self.heading[:, 0] * aim[:, 1] - self.heading[:, 1] * aim[:, 0]
        angle = np.where(size > 1e-6, portable.arctan2(cross, (self.heading * aim).sum(axis=1)), 0.0)
        angle = np.clip(angle, -most, most)
        c, s = portable.cos(angle), portable.sin(angle)
        x, y = self.heading[:, 0], self.heading[:, 1]
        turned = np.stack([c * x - s * y, s * x + c * y], axis=1)
        self.heading = turned / np.sqrt((turned * turned).sum(axis=1))[:, None]

    def poses(
        self, position: Floats, present: Booleans, offset: Floats, steps: Steps | None = None
    ) -> tuple[Floats, Floats]:
        """Return positions (N + 2 L, 3) and quaternions (N + 2 L, 4) of trunks, left legs and right legs.

        L people have legs; the legs are in the order of these people.

        Args:
            position: (N, 2) m.
            present: (N,) who is in the world.
            offset: (N, 3) m, from the plane on which people walk to the world.
            steps: below those who are on stairs.
        """
        yaw = _turned(self.heading[:, 0], self.heading[:, 1])
        walkers = np.flatnonzero(~self.rides)
        leg, height, heading = HIP * self.height[walkers], self.hip[walkers], self.heading[walkers]
        hips = self._homes(position)[walkers]
        rise = self.ground[walkers] if steps is None else (self.ground - steps.slope()[:, None])[walkers]
        share, supporting = self._share()[walkers], self._supporting()[walkers]
        # short steps are low
        most = _LIFT * self.height[walkers] / 1.72 * np.clip(self.stride[walkers] / 0.4, 0.4, 1.0)
        trunk = np.column_stack([position, self.hip - HIP * self.height])
        parts_p, parts_q = [trunk], [yaw]
        for side in (0, 1):
            lift = np.where(supporting == side, 0.0, most * 4.0 * share * (1.0 - share))
            place, turn = _leg(hips[:, side], height, self.feet[walkers, side], lift + rise[:, side], leg, heading)
            parts_p.append(place)
            parts_q.append(turn)
        places, turns = np.concatenate(parts_p), np.concatenate(parts_q)
        hidden = np.concatenate([~present, ~present[walkers], ~present[walkers]])
        places += np.concatenate([offset, offset[walkers], offset[walkers]])
        places[:, 2] -= np.where(hidden, _BELOW, 0.0)
        return places, turns


def _on_steps(steps: Steps | None, places: Floats) -> Floats:
    """Return places (N, 2, 2) of feet, on the middles of steps where people are on stairs."""
    if steps is None:
        return places
    each = np.arange(len(places))
    return np.stack([steps.landing(each, places[:, side]) for side in (0, 1)], axis=1)


def _size(vectors: Floats) -> Floats:
    """Return the lengths of vectors (..., 2)."""
    sizes: Floats = np.sqrt((vectors * vectors).sum(axis=-1))
    return sizes


def _smooth(share: Floats) -> Floats:
    """Return how much of its way a swinging foot has covered: it starts and ends slowly."""
    return share * share * (3.0 - 2.0 * share)


def _turned(x: Floats, y: Floats) -> Floats:
    """Return quaternions (N, 4) of the turns about Z to the directions (x, y), of length 1."""
    w = np.sqrt(np.maximum(0.5 * (1.0 + x), 0.0))
    z = np.sqrt(np.maximum(0.5 * (1.0 - x), 0.0)) * np.where(y < 0.0, -1.0, 1.0)
    zero = np.zeros_like(w)
    return np.stack([w, zero, zero, z], axis=1)


def _leg(
    hips: Floats, height: Floats, foot: Floats, lift: Floats, leg: Floats, heading: Floats
) -> tuple[Floats, Floats]:
    """Return places (L, 3) of soles and quaternions (L, 4) of legs from the sole to the hip, without the floor."""
    apart = hips - foot
    along = (apart * heading).sum(axis=1)
    across = heading[:, 0] * apart[:, 1] - heading[:, 1] * apart[:, 0]
    up = np.maximum(height - lift, 0.1)
    size = np.sqrt(along * along + across * across + up * up)
    x, y, z = along / size, across / size, up / size
    # the leg has its length: a foot in the air is where the leg ends
    place = np.stack([hips[:, 0], hips[:, 1], height], axis=1)
    forward = np.stack([heading[:, 0], heading[:, 1]], axis=1)
    left = np.stack([-heading[:, 1], heading[:, 0]], axis=1)
    flat = x[:, None] * forward + y[:, None] * left
    bent = np.minimum(size, leg)
    place[:, :2] -= flat * bent[:, None]
    place[:, 2] -= z * bent
    # about Z to the heading, then by the shortest turn from Z to the leg
    w = np.sqrt(np.maximum(0.5 * (1.0 + z), 0.0))
    half = 0.5 / np.maximum(w, 1e-9)
    tilt = np.stack([w, -y * half, x * half, np.zeros_like(w)], axis=1)
    return place, _product(_turned(heading[:, 0], heading[:, 1]), tilt)


def _product(a: Floats, b: Floats) -> Floats:
    """Return the products (N, 4) of quaternions w, x, y, z."""
    w, x, y, z = a.T
    s, i, j, k = b.T
    return np.stack(
        [
            w * s - x * i - y * j - z * k,
            w * i + x * s + y * k - z * j,
            w * j - x * k + y * s + z * i,
            w * k + x * j - y * i + z * s,
        ],
        axis=1,
    )
