"""W3 in MORSE: one robot, and a laser scanner with 16 x 1800 rays at 10 Hz."""

from __future__ import annotations

import argparse

from benchmarks import stopwatch, work
from benchmarks.programs.loading import command_all, poses, prepare, sensors_with


def main() -> None:
    """Run for about ``--secs`` simulated seconds."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--secs", type=float, default=5.0)
    arguments = parser.parse_args()
    simulation = prepare("arena", sensors="panorama")
    command_all(simulation)
    pace, _ = stopwatch.measure(simulation.tick, arguments.secs)
    simulation.tick()
    (eye,) = sensors_with(simulation, "ranges")
    error, bad = work.panorama_errors(list(eye.local_data["ranges"]), poses(simulation)[0])
    rays = work.PANORAMA_ROWS * work.PANORAMA_COLUMNS
    stopwatch.report(
        rays_per_s=pace.wall * work.SCAN_RATE * rays,
        processor_rays_per_s=pace.processor * work.SCAN_RATE * rays,
        scan_error_m=error,
        scan_bad_share=bad,
    )
    simulation.close()


if __name__ == "__main__":
    main()
