"""People among walls, and a robot with a lidar that drives among them."""

from __future__ import annotations

import argparse
import time

import numpy as np

from benchmarks import stopwatch
from benchmarks.programs.loading import prepare


def main() -> None:
    """Run for about ``--secs`` simulated seconds."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--n", type=int, default=200)
    parser.add_argument("--secs", type=float, default=3.0)
    parser.add_argument("--model", default="social-force")
    arguments = parser.parse_args()
    begin = time.perf_counter()
    simulation = prepare("people", count=arguments.n, model=arguments.model)
    loaded = time.perf_counter() - begin
    simulation["robot"].motion.publish({"v": 0.4, "w": 0.05})
    for _ in range(60):
        simulation.tick()
    people = simulation["people"]
    before = people.data["positions"]
    pace, seconds = stopwatch.measure(simulation.tick, arguments.secs)
    walked = np.linalg.norm(people.data["positions"] - before, axis=1).mean()
    simulation.close()
    stopwatch.report(
        factor=pace.wall, processor_factor=pace.processor, load_s=loaded, mean_speed_m_s=float(walked / seconds)
    )


if __name__ == "__main__":
    main()
