"""What people do at goals besides passing them: stand in line, sit, and have other goals at other times."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.plugins.people.wayfinding import Ground, Way

    Floats = NDArray[np.float64]
    Indices = NDArray[np.intp]

#: m between those who stand in line; m, from the end of the line, at which one joins it
PITCH, _JOINS = 0.65, 1.2
#: m/s, at which people sit down; m: they have arrived
_SITS_DOWN, HERE = 0.6, 0.1
#: s: later than all runs; s, to stand up from a seat
NEVER, STANDS_UP = 1e12, 1.5


def phases(flows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return flows with those of their schedules after them: ``next`` is the time and the number of the next one."""
    result = list(flows)
    for flow in flows:
        before = flow
        for later in flow.get("later") or ():
            before["next"] = (float(later["at"]), len(result))
            before = {**flow, **later, "count": 0, "later": None, "next": None}
            result.append(before)
    return result


def line_back(ground: Ground, way: Way, begin: Floats, counter: Floats, count: int) -> Floats:
    """Return the places (K, 2) of a line of people in front of a counter, m: along the way from where they begin."""
    path, here = [begin], begin[None].copy()
    for _ in range(20_000):
        heading = ground.heading(way, here)
        if not heading.any():
            break
        here = here + 0.5 * ground.cell * heading
        path.append(here[0])
    points = np.concatenate([counter[None], np.array(path[::-1])])
    steps = np.sqrt((np.diff(points, axis=0) ** 2).sum(axis=1))
    along = np.concatenate([[0.0], np.cumsum(steps)])
    spots = np.arange(count) * PITCH
    spots = spots[spots <= max(along[-1], PITCH)]
    return np.stack([np.interp(spots, along, points[:, k]) for k in (0, 1)], axis=1)


class Queue:
    """A line of people in front of a counter.

    Args:
        spots: (K, 2) m, places; those who find no place stand at the last one.
        wait: s, that each person takes at the counter.
    """

    def __init__(self, spots: Floats, wait: float) -> None:
        self.spots, self.wait = spots, wait

    def joining(self, rows: Indices, left: Floats, waiting: int) -> Indices:
        """Return who joins the line, the nearest first.

        Args:
            rows: (R,) who comes.
            left: (R,) m, ways to the counter.
            waiting: number of those who stand in line.
        """
        near = left < _JOINS + PITCH * min(waiting, len(self.spots))
        return rows[near][np.argsort(left[near], kind="stable")]

    def places(self, ranks: NDArray[np.intp]) -> Floats:
        """Return the places (R, 2) of those who stand in line, by their ranks (R,), which may have gaps."""
        order = np.argsort(np.argsort(ranks, kind="stable"), kind="stable")
        places: Floats = self.spots[np.minimum(order, len(self.spots) - 1)]
        return places


def steps_to(position: Floats, target: Floats) -> Floats:
    """Return where (R, 2) people want to go who are near their places: unit vectors, shorter near the place."""
    apart = target - position
    far = np.sqrt((apart * apart).sum(axis=1))
    share = np.where(far < HERE, 0.0, np.minimum(far / 0.4, 1.0)) / np.maximum(far, 1e-9)
    steps: Floats = apart * share[:, None]
    return steps


def sit_down(position: Floats, target: Floats, seconds: float) -> Floats:
    """Return the places (R, 2) of people who sit down, after some time."""
    apart = target - position
    far = np.maximum(np.sqrt((apart * apart).sum(axis=1)), 1e-9)
    moved: Floats = position + apart * np.minimum(_SITS_DOWN * seconds / far, 1.0)[:, None]
    return moved
