"""How cars follow and change lanes: models of the literature, without a world.

* Following: the Intelligent Driver Model, M. Treiber, A. Hennecke and D. Helbing, "Congested traffic states in
  empirical observations and microscopic simulations", Phys. Rev. E 62 (2000), with the parameters of its table I.
* Changing: MOBIL, A. Kesting, M. Treiber and D. Helbing, "General lane-changing model MOBIL for car-following models",
  Transportation Research Record 1999 (2007).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

#: m/s²: tyres on dry asphalt do not brake harder
HARDEST = 9.0
#: m: a smaller gap counts as that
_LEAST = 0.1


class Driver(NamedTuple):
    """The parameters of the Intelligent Driver Model and of MOBIL.

    Attributes:
        headway: T, s, desired time gap.
        acceleration: a, m/s².
        deceleration: b, m/s², comfortable.
        gap: s0, m, between bumpers at rest.
        politeness: p, weight of what the others lose.
        threshold: m/s², of the advantage for which a lane is changed.
        safe: b_safe, m/s²: nobody has to brake harder for a change.
        bias: m/s², in favour of the right lane.
    """

    headway: float = 1.6
    acceleration: float = 0.73
    deceleration: float = 1.67
    gap: float = 2.0
    politeness: float = 0.3
    threshold: float = 0.1
    safe: float = 4.0
    bias: float = 0.0

    def accelerations(self, speed: ArrayLike, desired: ArrayLike, gap: ArrayLike, closing: ArrayLike) -> Floats:
        """Return the accelerations (N,) of cars, m/s².

        Args:
            speed: (N,) v, m/s.
            desired: (N,) v0, m/s, of a free road.
            gap: (N,) to the car ahead, m; infinite for a free road.
            closing: (N,) speed relative to the car ahead, m/s: positive if they come nearer.
        """
        v, apart = np.asarray(speed, dtype=np.float64), np.maximum(np.asarray(gap, dtype=np.float64), _LEAST)
        ratio = v / np.maximum(np.asarray(desired, dtype=np.float64), 0.1)
        squared = ratio * ratio
        rate = 2.0 * math.sqrt(self.acceleration * self.deceleration)
        wanted = self.gap + np.maximum(0.0, v * self.headway + v * np.asarray(closing, dtype=np.float64) / rate)
        share = wanted / apart
        return np.maximum(self.acceleration * (1.0 - squared * squared - share * share), -HARDEST)

    def equilibrium_gap(self, speed: float, desired: float) -> float:
        """Return the gap at which a car of a steady stream neither accelerates nor brakes, m."""
        return (self.gap + speed * self.headway) / math.sqrt(1.0 - (speed / desired) ** 4)

    def wants_change(
        self, own: tuple[float, float], new: tuple[float, float], old: tuple[float, float], side: int
    ) -> bool:
        """Whether a driver changes lanes, by MOBIL; each pair is an acceleration now and after the change, m/s².

        Args:
            own: of the driver.
            new: of the follower in the new lane.
            old: of the follower in the present lane.
            side: 1 for a change to the left, -1 to the right.
        """
        if new[1] < -self.safe or own[1] < -self.safe:
            return False
        gain = own[1] - own[0] + self.politeness * (new[1] - new[0] + old[1] - old[0])
        return gain > self.threshold + side * self.bias


def advance(position: Floats, speed: Floats, acceleration: Floats, seconds: float) -> tuple[Floats, Floats]:
    """Return positions and speeds after a time with constant accelerations; cars that come to rest stay there."""
    after = speed + acceleration * seconds
    stops = after < 0.0
    braking = np.where(stops, acceleration, -1.0)
    way = np.where(stops, -0.5 * speed * speed / braking, (speed + 0.5 * acceleration * seconds) * seconds)
    return position + way, np.where(stops, 0.0, after)


class Things(NamedTuple):
    """What is on the lanes: cars, and what else stands or moves there, sorted by lane and place.

    Attributes:
        keys: (M,) lane and place of the front, see `key`.
        lane: (M,) number of the lane.
        front, rear: (M,) m along the lane.
        speed: (M,) m/s along the lane.
        owner: (M,) number of the car; -1 for what is no car.
    """

    keys: Floats
    lane: NDArray[np.int64]
    front: Floats
    rear: Floats
    speed: Floats
    owner: NDArray[np.int64]


#: m: longer than any road
_LONG = 1e6


def sort(lane: NDArray[np.int64], front: Floats, rear: Floats, speed: Floats, owner: NDArray[np.int64]) -> Things:
    """Return things in the order of their lanes and places."""
    keys = lane * _LONG + front
    order = np.argsort(keys, kind="stable")
    return Things(keys[order], lane[order], front[order], rear[order], speed[order], owner[order])


def leaders(
    things: Things, lane: NDArray[np.int64], front: Floats, around: Floats, owner: NDArray[np.int64]
) -> tuple[Floats, Floats]:
    """Return the gaps (N,) to what is ahead, m, infinite for nothing, and its speeds (N,), m/s.

    Args:
        things: on all lanes.
        lane, front: (N,) where to look from.
        around: (N,) length of the lane if it is closed, m; 0 for an open one.
        owner: (N,) car that looks, which does not see itself.
    """
    count = len(things.keys)
    gap, speed = np.full(len(lane), np.inf), np.zeros(len(lane))
    if not count:
        return gap, speed
    place = np.searchsorted(things.keys, lane * _LONG + front, side="right")
    lap = np.zeros(len(lane))
    for _ in range(2):
        at = np.minimum(place, count - 1)
        is_there = (place < count) & (things.lane[at] == lane)
        # a car that changes lanes is on two of them, and may be alone on a closed one
        sees = is_there & ((things.owner[at] != owner) | (owner < 0))
        found = np.where(sees, things.rear[at] + lap - front, np.inf)
        nearer = found < gap
        gap, speed = np.where(nearer, found, gap), np.where(nearer, things.speed[at], speed)
        # once around
        again = ~is_there & (around > 0.0) & (lap == 0.0)
        if not again.any():
            break
        place = np.where(again, np.searchsorted(things.keys, lane * _LONG - 0.5 * _LONG, side="right"), place)
        lap = np.where(again, around, lap)
    return gap, speed


def follower(things: Things, lane: int, front: float, around: float, owner: int) -> int:
    """Return the number of the car that follows a place on a lane; -1 for none."""
    place = int(np.searchsorted(things.keys, lane * _LONG + front, side="left"))
    begin, end = (int(one) for one in np.searchsorted(things.keys, [(lane - 0.5) * _LONG, (lane + 0.5) * _LONG]))
    order = [*range(place - 1, begin - 1, -1), *(range(end - 1, place - 1, -1) if around else ())]
    for number in order:
        car = int(things.owner[number])
        if car >= 0 and car != owner:
            return car
    return -1
