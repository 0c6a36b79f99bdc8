"""A simulation of a sweep on a cluster: a million runs, packs, nodes that fail, processors of different speeds.

No run is executed. The costs are measured ones, the packs those of `morse.many.executors`, and what is computed is how
much of the time of the processors becomes results.
"""

from __future__ import annotations

import argparse
import heapq
import json
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.many.executors import DISPATCHES, pack_size

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: start of a worker, s
START = 2.0
#: processors of a node; time until a node that has failed is back, s
PROCESSORS, RETURN = 64, 120.0
#: standard deviations of the logarithm of the time of a run, and of the speed of a node
SPREAD, SPEEDS = 0.5, 0.2


class Sweep(NamedTuple):
    """What is simulated.

    Attributes:
        runs: number of runs.
        time: mean time of a run, s of processor time.
        nodes: number of nodes.
        failures: failures of a node per hour.
        packed: whether runs are given in packs; otherwise one by one.
    """

    runs: int
    time: float
    nodes: int
    failures: float
    packed: bool = True


def simulate(sweep: Sweep, seed: int = 0) -> dict[str, float]:
    """Simulate a sweep.

    Returns:
        ``wall``: s; ``ideal``: s, if all processors worked all the time; ``share``: their ratio; ``lost``: share of the
        processor time that was lost with nodes; ``packs``: number of messages.
    """
    rng = np.random.default_rng(seed)
    times = sweep.time * np.exp(SPREAD * rng.standard_normal(sweep.runs) - SPREAD**2 / 2)
    ends: NDArray[np.float64] = np.concatenate([[0.0], np.cumsum(times)])
    workers = sweep.nodes * PROCESSORS
    speeds = np.exp(SPEEDS * rng.standard_normal(sweep.nodes))
    downs = _next_failures(rng, sweep, np.zeros(sweep.nodes))
    free = [(START, worker) for worker in range(workers)]
    heapq.heapify(free)
    again: list[tuple[int, int]] = []
    first, dispatched, wall, lost, packs = 0, 0.0, 0.0, 0.0, 0
    while first < sweep.runs or again:
        now, worker = heapq.heappop(free)
        node = worker // PROCESSORS
        if now >= downs[node] + RETURN:
            downs[node] = _next_failures(rng, sweep, np.array([now]))[0]
        if now >= downs[node]:
            heapq.heappush(free, (downs[node] + RETURN + START, worker))
            continue
        if again:
            pack = again.pop()
        else:
            size = pack_size(sweep.runs - first, workers, sweep.time) if sweep.packed else 1
            pack = first, min(first + size, sweep.runs)
            first = pack[1]
        packs += 1
        # one driver hands out all packs, one after the other
        dispatched = max(dispatched, now) + 1.0 / DISPATCHES
        end = dispatched + (ends[pack[1]] - ends[pack[0]]) / speeds[node]
        if end > downs[node]:
            lost += (max(downs[node] - dispatched, 0.0)) * speeds[node]
            again.append(pack)
            heapq.heappush(free, (max(downs[node], dispatched) + RETURN + START, worker))
            wall = max(wall, downs[node])
            continue
        wall = max(wall, end)
        heapq.heappush(free, (end, worker))
    work = float(ends[-1])
    ideal = work / (float(speeds.sum()) * PROCESSORS)
    return {"wall": wall, "ideal": ideal, "share": ideal / wall, "lost": lost / work, "packs": packs}


def _next_failures(rng: np.random.Generator, sweep: Sweep, now: NDArray[np.float64]) -> NDArray[np.float64]:
    if not sweep.failures:
        return np.full(len(now), np.inf)
    return now + rng.exponential(3600.0 / sweep.failures, len(now))


def main() -> None:
    """Print a line of JSON for each sweep."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=1_000_000)
    given = parser.parse_args()
    for time, nodes in ((0.2, 10), (0.2, 100), (2.0, 100), (20.0, 100), (20.0, 1000), (200.0, 1000)):
        for packed in (True, False):
            sweep = Sweep(given.runs, time, nodes, 1.0, packed)
            print(json.dumps(sweep._asdict() | {key: round(value, 4) for key, value in simulate(sweep).items()}))


if __name__ == "__main__":
    main()
