"""Measures loops, and prints the results as one line of JSON."""

from __future__ import annotations

import json
import resource
import statistics
import sys
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from benchmarks import work

if TYPE_CHECKING:
    from collections.abc import Callable

_CHUNKS = 5


@dataclass(frozen=True)
class Pace:
    """The speed of a loop.

    Attributes:
        wall: simulated seconds per wall-clock second.
        processor: simulated seconds per second of processor time of the whole process.
    """

    wall: float
    processor: float


def measure(tick: Callable[[], object], seconds: float) -> tuple[Pace, float]:
    """Run ticks for that many simulated seconds, in chunks of whole scans.

    Returns:
        The pace of the median chunk, so that interruptions of the machine do not count; and the simulated
        seconds that have passed.
    """
    scans = max(1, round(seconds * work.SCAN_RATE / _CHUNKS))
    ticks = scans * work.TICKS_PER_SCAN
    passed = ticks / work.TICK
    cost = cost_of(tick, ticks)
    return Pace(passed / (cost.wall * ticks), passed / (cost.processor * ticks)), _CHUNKS * passed


@dataclass(frozen=True)
class Cost:
    """Wall-clock time and processor time of a call, seconds."""

    wall: float
    processor: float


def cost_of(action: Callable[[], object], repeats: int) -> Cost:
    """The time of one call: median over chunks of calls."""
    walls, processors = [], []
    for _ in range(_CHUNKS):
        wall, processor = time.perf_counter(), time.process_time()
        for _ in range(repeats):
            action()
        walls.append((time.perf_counter() - wall) / repeats)
        processors.append((time.process_time() - processor) / repeats)
    return Cost(statistics.median(walls), statistics.median(processors))


def peak_memory() -> float:
    """Maximum memory of this process, MB."""
    unit = 2**20 if sys.platform == "darwin" else 2**10
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit


def report(**values: Any) -> None:
    """The result of a program: its last line."""
    print(json.dumps({**values, "memory_mb": peak_memory()}), flush=True)
