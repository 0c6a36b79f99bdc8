"""How the bodies of people walk: feet stay where they are put.

The foot of the supporting leg stays at its place on the ground until the other one is put down; the hip is as high as
that leg allows. The length of a step follows from the speed by the walk ratio, 0.0064 m / (steps/min) of N. Sekiya and
H. Nagasaki, Reproducibility of the walking patterns of normal young adults, Gait & Posture 7 (1998), which hardly
depends on the speed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils import portable

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.plugins.people.stairs import Steps

    Floats = NDArray[np.float64]

#: share of the height of a body up to the hip (Drillis and Contini 1966)
HIP = 0.53
#: m per (steps/min), as m s per step
_WALK_RATIO = 0.0064 * 60.0
#: m, at heights of 1.72 m: half the distance of the feet, their largest lift
_HALF_WIDTH, _LIFT = 0.09, 0.07
#: m/s; slower ones stand, with their feet together
_STANDS = 0.05
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
        feet: (N, 2, 2) m, where the left and the right foot were put down last.
        heading: (N, 2) unit vectors.
        stands: (N,) who stands.
    """

    height: Floats
    rides: NDArray[np.bool_]
    phase: Floats
    stride: Floats
    feet: Floats
    heading: Floats
    stands: NDArray[np.bool_]

    @classmethod
    def at(cls, position: Floats, heading: Floats, height: Floats, rides: NDArray[np.bool_], phase: Floats) -> Gait:
        """Let people stand somewhere."""
        count = len(height)
        gait = cls(
            height, rides, phase, np.full(count, 0.3), np.zeros((count, 2, 2)), heading, np.ones(count, dtype=bool)
        )
        gait.stand(np.arange(len(height)), position)
        return gait

    def stand(self, rows: NDArray[np.intp], position: Floats) -> None:
        """Put the feet of some people together, (R,) of them."""
        aside = self._aside(rows)
        # in the middle of a step
        self.phase[rows] = np.floor(self.phase[rows]) + 0.5
        self.feet[rows, 0], self.feet[rows, 1] = position[rows] + aside, position[rows] - aside

    def _aside(self, rows: NDArray[np.intp] | slice) -> Floats:
        """Return the vectors (R, 2) from the middle to the left foot, m."""
        left = np.stack([-self.heading[rows, 1], self.heading[rows, 0]], axis=1)
        width = _HALF_WIDTH / 1.72 * self.height[rows]
        return left * width[:, None]

    def step(
        self, seconds: float, position: Floats, velocity: Floats, facing: Floats, steps: Steps | None = None
    ) -> None:
        """Walk for some time.

        Args:
            position: (N, 2) m, after that time.
            velocity: (N, 2) m/s.
            facing: (N, 2) where those look who stand; 0 for no change.
            steps: below those who are on stairs: each of them takes one after the other.
        """
        speed = np.sqrt((velocity * velocity).sum(axis=1))
        # people walk forwards where they can: they turn by at most 3 rad/s
        walks = speed > _STANDS
        aim = np.where((speed > 0.3)[:, None], velocity, facing)
        self._turn(aim, 3.0 * seconds)
        length = np.sqrt(_WALK_RATIO * np.maximum(speed, 0.2)) * np.sqrt(self.height / 1.72)
        if steps is not None:
            length = np.where(np.isnan(steps.tread), length, steps.tread)
        begins = walks & self.stands
        self.stride[begins] = length[begins]
        before = np.floor(self.phase)
        self.phase += np.where(walks, seconds * speed / self.stride, 0.0)
        # who turns puts the other foot down early
        far = walks & (self._stretch(position) > 0.5 * self.stride + 0.1) & (np.floor(self.phase) == before)
        self.phase[far] = before[far] + 1.0
        landed = np.flatnonzero((np.floor(self.phase) > before) & walks)
        if len(landed):
            # the foot that was in the air is put down half a step ahead
            foot = (np.floor(self.phase[landed]).astype(np.intp)) % 2
            points = self._landing(landed, foot, position, velocity)
            self.feet[landed, foot] = points if steps is None else steps.landing(landed, points)
            self.stride[landed] = length[landed]
        stopped = np.flatnonzero(~walks & ~self.stands)
        if len(stopped):
            self.stand(stopped, position)
        self.stands = ~walks
        # nobody stretches: who was pushed or carried away puts the feet down again
        gone = self._stretch(position) > 0.65 * HIP * self.height
        if gone.any():
            self.stand(np.flatnonzero(gone), position)

    def _stretch(self, position: Floats) -> Floats:
        """Return the distances (N,) of supporting feet from the middle, m."""
        supporting = np.floor(self.phase).astype(np.intp) % 2
        apart = self.feet[np.arange(len(position)), supporting] - position
        distances: Floats = np.sqrt((apart * apart).sum(axis=1))
        return distances

    def _landing(self, rows: NDArray[np.intp], foot: NDArray[np.intp], position: Floats, velocity: Floats) -> Floats:
        speed = np.maximum(np.sqrt((velocity[rows] * velocity[rows]).sum(axis=1)), 1e-9)
        ahead = velocity[rows] / speed[:, None] * (0.5 * self.stride[rows])[:, None]
        side = np.where(foot == 0, 1.0, -1.0)
        landing: Floats = position[rows] + ahead + side[:, None] * self._aside(rows)
        return landing

    def _turn(self, aim: Floats, most: float) -> None:
        size = np.sqrt((aim * aim).sum(axis=1))
        cross = self.heading[:, 0] * aim[:, 1] - self.heading[:, 1] * aim[:, 0]
        angle = np.where(size > 1e-6, portable.arctan2(cross, (self.heading * aim).sum(axis=1)), 0.0)
        angle = np.clip(angle, -most, most)
        c, s = portable.cos(angle), portable.sin(angle)
        x, y = self.heading[:, 0], self.heading[:, 1]
        turned = np.stack([c * x - s * y, s * x + c * y], axis=1)
        self.heading = turned / np.sqrt((turned * turned).sum(axis=1))[:, None]

    def poses(
        self,
        position: Floats,
        velocity: Floats,
        present: NDArray[np.bool_],
        offset: Floats,
        sits: NDArray[np.bool_],
        steps: Steps | None = None,
    ) -> tuple[Floats, Floats]:
        """Return positions (N + 2 L, 3) and quaternions (N + 2 L, 4) of trunks, left legs and right legs.

        L people have legs; the legs are in the order of these people. Who sits has the legs in front, on the ground.

        Args:
            position: (N, 2) m.
            velocity: (N, 2) m/s.
            present: (N,) who is in the world.
            offset: (N, 3) m, from the plane on which people walk to the world.
            sits: (N,) who sits.
            steps: below those who are on stairs.
        """
        yaw = _turned(self.heading[:, 0], self.heading[:, 1])
        hip = np.zeros(len(position))
        walkers = np.flatnonzero(~self.rides)
        parts_p: list[Floats] = []
        parts_q: list[Floats] = []
        leg = HIP * self.height[walkers]
        middle, feet = position[walkers], self.feet[walkers]
        share = self.phase[walkers] - np.floor(self.phase[walkers])
        supporting = np.floor(self.phase[walkers]).astype(np.intp) % 2
        aside = self._aside(walkers)
        hips = np.stack([middle + aside, middle - aside], axis=1)
        each = np.arange(len(walkers))
        apart = feet[each, supporting] - hips[each, supporting]
        height = np.sqrt(np.maximum(leg * leg - (apart * apart).sum(axis=1), 0.25 * leg * leg))
        height = np.where(self.stands[walkers], leg, height)
        if steps is not None:
            # hips move along the slope, and are so low that the leg reaches the step behind
            low = np.sqrt(leg * leg - steps.half[walkers] ** 2) - steps.bend[walkers]
            height += steps.share[walkers] * (low - height)
        seated = sits[walkers]
        height = np.where(seated, _SEAT * self.height[walkers], height)
        reach = np.sqrt(leg * leg - height * height) * seated
        hip[walkers] = height - leg
        speed = np.sqrt((velocity[walkers] * velocity[walkers]).sum(axis=1))
        length = self.stride[walkers]
        for side in (0, 1):
            foot, lift = feet[:, side].copy(), np.zeros(len(walkers))
            rise = np.zeros(len(walkers)) if steps is None else steps.rises(walkers, feet[:, side])
            foot[seated] = (hips[:, side] + reach[:, None] * self.heading[walkers])[seated]
            swings = (supporting != side) & ~self.stands[walkers] & ~seated
            if swings.any():
                rows = np.flatnonzero(swings)
                rest = (1.0 - share[rows]) * length[rows]
                way = velocity[walkers[rows]] / np.maximum(speed[rows], 1e-9)[:, None]
                goal = hips[rows, side] + way * (rest + 0.5 * length[rows])[:, None]
                smooth = share[rows] * share[rows] * (3.0 - 2.0 * share[rows])
                if steps is not None:
                    goal = steps.landing(walkers[rows], goal)
                    rise[rows] += smooth * (steps.rises(walkers[rows], goal) - rise[rows])
                foot[rows] = feet[rows, side] + smooth[:, None] * (goal - feet[rows, side])
                lift[rows] = _LIFT * self.height[walkers[rows]] / 1.72 * 4.0 * share[rows] * (1.0 - share[rows])
            place, turn = _leg(hips[:, side], height, foot, lift + rise, leg, self.heading[walkers])
            parts_p.append(place)
            parts_q.append(turn)
        trunk = np.stack([position[:, 0], position[:, 1], hip], axis=1)
        places, turns = np.concatenate([trunk, *parts_p]), np.concatenate([yaw, *parts_q])
        hidden = np.concatenate([~present, ~present[walkers], ~present[walkers]])
        places += np.concatenate([offset, offset[walkers], offset[walkers]])
        places[:, 2] -= np.where(hidden, _BELOW, 0.0)
        return places, turns


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
