"""How people follow somebody who leads them: on the trail of the leader, one behind the other."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Indices = NDArray[np.intp]

#: m, between two points of a trail; their largest number; most leaders of a crowd
_PITCH, _MOST, MOST_LEADERS = 0.25, 400, 16
#: m: how far behind the leader the first one walks, and each one behind the one before
_BEHIND, _APART = 1.1, 0.65
#: m: who is that near to a trail walks along it; and is on it
NEAR, _BESIDE = 1.5, 0.5
#: ticks after which people who are far from a trail look where it begins
SEEKS = 30
#: m: a leader that moves farther in a tick was put elsewhere
_JUMP = 2.0
#: m: bodies are nowhere farther from the origin, on whichever part of the plane
_FAR = 1e8

#: places (x, y) on the plane of the crowd where a leader has been, m, the latest one last, by its name
Trails = dict[str, list[tuple[float, float]]]


def can_be(trails: object) -> bool:
    """Whether trails of a state are possible."""
    return (
        isinstance(trails, dict)
        and len(trails) <= MOST_LEADERS
        and all(isinstance(name, str) and isinstance(path, list) for name, path in trails.items())
        and all(1 <= len(path) <= _MOST for path in trails.values())
        and all(
            isinstance(point, tuple | list)
            and len(point) == 2
            and all(isinstance(value, float) and abs(value) < _FAR for value in point)
            for path in trails.values()
            for point in path
        )
    )


def note(trail: list[tuple[float, float]], place: tuple[float, float]) -> None:
    """Add the present place of a leader to its trail, m."""
    if trail:
        way = math.dist(place, trail[-1])
        if way < _PITCH:
            return
        if way > _JUMP:
            trail.clear()
    trail.append(place)
    del trail[:-_MOST]


def aims(trail: list[tuple[float, float]], leader: tuple[float, float], positions: Floats, ranks: Indices) -> Floats:
    """Return where followers go next, (R, 2) m; NaN for those who are not near the trail.

    Args:
        trail: of the leader.
        leader: its present place, m.
        positions: (R, 2) m.
        ranks: (R,) order in which they follow, from 0.
    """
    points = np.array(trail)
    steps = np.sqrt((np.diff(np.concatenate([points, [leader]]), axis=0) ** 2).sum(axis=1))
    # m, along the trail, from each point to the leader
    left = np.cumsum(steps[::-1])[::-1]
    apart = positions[:, None, :] - points[None, :, :]
    squares = (apart * apart).sum(axis=2)
    nearest = squares.argmin(axis=1)
    # where the trail crosses itself, the later part of it: nobody walks in circles
    beside = squares < _BESIDE * _BESIDE
    nearest = np.where(beside.any(axis=1), len(points) - 1 - beside[:, ::-1].argmax(axis=1), nearest)
    places = np.searchsorted(-left, -(_BEHIND + _APART * ranks), side="right") - 1
    target = np.minimum(np.maximum(places, nearest), nearest + 3)
    target = np.where(places <= nearest, nearest, target)
    found = points[np.clip(target, 0, len(points) - 1)]
    # who is at the own place, or nearer to the leader, stands
    found = np.where((left[nearest] <= _BEHIND + _APART * ranks)[:, None], positions, found)
    return np.where((squares.min(axis=1) < NEAR * NEAR)[:, None], found, np.nan)
