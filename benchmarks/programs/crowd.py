"""Many kinematic robots with a pose each; with pages, what the live view costs at the pace of the wall clock."""

from __future__ import annotations

import argparse
import math
import time

from benchmarks import stopwatch, work
from benchmarks.programs.loading import command_all, prepare, sensors_with
from benchmarks.programs.readers import read_pages


def main() -> None:
    """Run for about ``--secs`` simulated seconds."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--n", type=int, default=1000)
    parser.add_argument("--secs", type=float, default=5.0)
    parser.add_argument("--view", action="store_true")
    parser.add_argument("--pages", type=int, default=0)
    parser.add_argument("--paced", action="store_true", help="in real time")
    arguments = parser.parse_args()
    begin = time.perf_counter()
    simulation = prepare("crowd", view=arguments.view, count=arguments.n, visible="yes" if arguments.view else "no")
    loaded = time.perf_counter() - begin
    command_all(simulation)
    places = [sensor.local_data for sensor in sensors_with(simulation, "yaw")]
    simulation.tick()
    starts = [(data["x"], data["y"], data["yaw"]) for data in places]

    def paced_tick() -> None:
        simulation.tick()
        simulation.pacer.wait()

    with read_pages(simulation, arguments.pages):
        simulation.pacer.restart()
        pace, seconds = stopwatch.measure(paced_tick if arguments.paced else simulation.tick, arguments.secs)
    error = max(
        math.dist((data["x"], data["y"]), work.on_circle(start, seconds)[:2])
        for data, start in zip(places, starts, strict=True)
    )
    stopwatch.report(
        factor=pace.wall,
        processor_factor=pace.processor,
        processor_ms_per_tick=1e3 / work.TICK / pace.processor,
        load_s=loaded,
        position_error_m=error,
    )
    simulation.shut_down()


if __name__ == "__main__":
    main()
