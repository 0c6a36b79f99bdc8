"""Fleets of robots that drive in circles (W1), for any simulator."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Protocol

from benchmarks import stopwatch, work

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence


class Fleet(Protocol):
    """N robots in a simulator."""

    def tick(self) -> None:
        """Command, physics."""

    def poses(self) -> list[work.Pose]:
        """x, y, yaw of every robot."""

    def scan(self) -> Sequence[Sequence[float]]:
        """The ranges that every robot measures."""


def circles(make: Callable[[int], Fleet]) -> None:
    """W1 with the fleet that ``make`` creates, given the number of robots."""
    parser = argparse.ArgumentParser()
    parser.add_argument("work", choices=["circles"])
    parser.add_argument("--n", type=int, default=1)
    parser.add_argument("--secs", type=float, default=20.0)
    parser.add_argument("--drive", choices=["planar"], default="planar")
    parser.add_argument("--sensors", choices=["scan", "pose"], default="scan")
    arguments = parser.parse_args()
    fleet = make(arguments.n)
    scans = arguments.sensors == "scan"
    ranges: Sequence[Sequence[float]] = [[]]
    ticks = 0

    def tick() -> None:
        nonlocal ticks, ranges
        fleet.tick()
        fleet.poses()
        ticks += 1
        if scans and ticks % work.TICKS_PER_SCAN == 0:
            ranges = fleet.scan()

    pace, seconds = stopwatch.measure(tick, arguments.secs)
    final = fleet.poses()
    error, bad = work.scan_errors(list(ranges[0]), final) if scans else (None, None)
    stopwatch.report(
        factor=pace.wall,
        processor_factor=pace.processor,
        seconds=seconds,
        position_error_m=work.worst_position(final, seconds),
        scan_error_m=error,
        scan_bad_share=bad,
    )
