"""Many kinematic robots with one pose sensor each."""

from __future__ import annotations

import argparse
import math
import time
from typing import TYPE_CHECKING

from benchmarks import stopwatch, work
from benchmarks.programs.loading import command_all, prepare, sensors_with

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.simulation.simulation import Simulation


def main() -> None:
    """Run for about ``--secs`` simulated seconds."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--n", type=int, default=1000)
    parser.add_argument("--secs", type=float, default=5.0)
    arguments = parser.parse_args()
    begin = time.perf_counter()
    simulation = prepare("crowd", count=arguments.n)
    loaded = time.perf_counter() - begin
    error = start(simulation)
    pace, _ = stopwatch.measure(simulation.tick, arguments.secs)
    stopwatch.report(factor=pace.wall, processor_factor=pace.processor, load_s=loaded, position_error_m=error())
    simulation.close()


def start(simulation: Simulation) -> Callable[[], float]:
    """Drive all robots; returns a function for the maximum position error, m."""
    command_all(simulation)
    places = [sensor.local_data for sensor in sensors_with(simulation, "yaw")]
    simulation.tick()
    begin = simulation.clock.time
    starts = [(data["x"], data["y"], data["yaw"]) for data in places]

    def error() -> float:
        seconds = simulation.clock.time - begin
        return max(
            math.dist((data["x"], data["y"]), work.on_circle(start, seconds)[:2])
            for data, start in zip(places, starts, strict=True)
        )

    return error


if __name__ == "__main__":
    main()
