"""The cost of the live view in real time, while many objects move.

Pages connect and disconnect while one simulation runs: their cost is a tenth of that of the tick, less than the
difference between two processes, or between two seconds of a loaded machine.
"""

from __future__ import annotations

import argparse
import time
from statistics import median

from benchmarks import stopwatch
from benchmarks.programs.crowd import start
from benchmarks.programs.loading import prepare
from benchmarks.programs.readers import read_pages

_TICKS = 12
"""Duration with one number of pages: short, so that the load of the machine hardly changes."""
_SETTLING = 4
"""Number of ticks after which a change of the number of pages has no more effect."""


def main() -> None:
    """Run for about ``--secs`` seconds with each number of ``--pages``, and as long without."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--n", type=int, default=500)
    parser.add_argument("--secs", type=float, default=5.0)
    parser.add_argument("--pages", type=int, nargs="+", default=[1])
    arguments = parser.parse_args()
    simulation = prepare("crowd", view=True, count=arguments.n, visible="yes")
    error = start(simulation)
    counts = (0, *arguments.pages)

    def cost(ticks: int) -> float:
        begin = time.process_time()
        for _ in range(ticks):
            simulation.tick()
            simulation.pacer.wait()
        return (time.process_time() - begin) / ticks * 1e3

    rounds = []
    with read_pages(simulation) as show:
        for _ in range(max(1, round(arguments.secs * simulation.clock.frequency / _TICKS))):
            costs = {}
            for count in counts:
                show(count)
                simulation.pacer.restart()
                cost(_SETTLING)
                costs[count] = cost(_TICKS)
            rounds.append(costs)
    differences = {f"pages_{n}_ms": median(costs[n] - costs[0] for costs in rounds) for n in arguments.pages}
    alone = median(costs[0] for costs in rounds)
    stopwatch.report(alone_ms=alone, position_error_m=error(), **differences)
    simulation.close()


if __name__ == "__main__":
    main()
