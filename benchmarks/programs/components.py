"""What a tick of a component costs: ``components NAME``, ``empty`` for one that does nothing."""

from __future__ import annotations

import sys

from benchmarks import stopwatch
from benchmarks.programs.loading import prepare

_WARM_UP = 60


def main() -> None:
    """Let it act again and again, each time as if everything had moved."""
    simulation = prepare("single", **{"class": sys.argv[1]})
    for _ in range(_WARM_UP):
        simulation.tick()
    parts = [*simulation.loaded.sensors, *simulation.loaded.actuators]
    world = simulation.world

    def act() -> None:
        world.stamp += 1
        for part in parts:
            part.action()

    once = stopwatch.cost_of(act, 1).wall
    cost = stopwatch.cost_of(act, max(1, min(2000, int(0.05 / max(once, 1e-9)))))
    stopwatch.report(us=cost.wall * 1e6, processor_us=cost.processor * 1e6)
    simulation.close()


if __name__ == "__main__":
    main()
