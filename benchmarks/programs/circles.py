"""W1 in MORSE: N robots drive in circles, pose at 60 Hz, a scan of 181 rays at 10 Hz."""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
import time
from contextlib import nullcontext
from typing import TYPE_CHECKING

from benchmarks import stopwatch, work
from benchmarks.programs.loading import command_all, poses, prepare, sensors_with
from benchmarks.programs.readers import read_pages, read_streams

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from morse.simulation.simulation import Simulation


def recorded(simulation: Simulation, what: str | None, folder: str) -> AbstractContextManager[object]:
    """Record the run in a file of that folder, if requested."""
    if what is None:
        return nullcontext()
    return simulation.record(f"{folder}/run.mcap", None if what == "all" else [])


def main() -> None:
    """Run for about ``--secs`` simulated seconds, five times as fast as possible."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--n", type=int, default=1)
    parser.add_argument("--secs", type=float, default=20.0)
    parser.add_argument("--drive", choices=["planar", "wheels"], default="planar")
    parser.add_argument("--sensors", choices=["scan", "pose"], default="scan")
    parser.add_argument("--readers", type=int, default=0, help="clients that read every stream")
    parser.add_argument("--binary", action="store_true", help="these clients read binary frames")
    parser.add_argument("--pages", type=int, default=0, help="pages that show the live view")
    parser.add_argument("--record", choices=["all", "inputs"], help="record the run in a file")
    parser.add_argument("--paced", action="store_true", help="in real time")
    arguments = parser.parse_args()
    begin = time.perf_counter()
    simulation = prepare(
        "arena", view=arguments.pages > 0, count=arguments.n, drive=arguments.drive, sensors=arguments.sensors
    )
    loaded = time.perf_counter() - begin
    command_all(simulation)
    if not arguments.paced:
        simulation.pacer.set_speed(math.inf)

    def paced_tick() -> None:
        simulation.tick()
        simulation.pacer.wait()

    with (
        tempfile.TemporaryDirectory() as folder,
        recorded(simulation, arguments.record, folder),
        read_streams(simulation, arguments.readers, binary=arguments.binary),
        read_pages(simulation, arguments.pages),
    ):
        pace, seconds = stopwatch.measure(paced_tick if arguments.paced else simulation.tick, arguments.secs)
        final = poses(simulation)
        scan_error, scan_bad = (None, None)
        if arguments.sensors == "scan":
            # scans come with the first of six ticks: take the poses of that tick
            simulation.tick()
            (laser, *_) = sensors_with(simulation, "range_list")
            scan_error, scan_bad = work.scan_errors(list(laser.local_data["range_list"]), poses(simulation))
    stopwatch.report(
        factor=pace.wall,
        processor_factor=pace.processor,
        seconds=seconds,
        load_s=loaded,
        position_error_m=work.worst_position(final, seconds),
        scan_error_m=scan_error,
        scan_bad_share=scan_bad,
    )
    simulation.close()
    sys.stdout.flush()


if __name__ == "__main__":
    main()
