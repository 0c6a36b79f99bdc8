"""What a run of a sweep costs besides its function, and what a second worker brings.

``overhead`` compares the processor time of a run with that of its function, for scenes that are used again and for
loads. ``workers`` compares the wall-clock times of one and of two workers, in turns.
"""

from __future__ import annotations

import argparse
import logging
import statistics
import tempfile
import time
from pathlib import Path
from typing import Any

import morse
from benchmarks import stopwatch
from morse.many import Study
from morse.many.run import run_once
from morse.many.scenes import SceneCache

_SCENE = Path(__file__).parents[1] / "scenes" / "rows.py"
#: processor time of the function of a run, s
_TIME = 0.05
#: runs of which the first ones load the scene
_WARM = 5


def drive(sim: Any, length: int) -> dict[str, float]:
    """Drive along a circle for that many ticks; return the processor time, s."""
    begin = time.process_time()
    sim.robot.motion.publish({"v": 0.5, "w": 0.5})
    for _ in range(length // 6):
        sim.step(6, measure=True)
    return {"own": time.process_time() - begin}


def _length() -> int:
    """The number of ticks that take `_TIME`."""
    length = 60
    with morse.load(_SCENE) as sim:
        drive(sim, length)
        while (spent := drive(sim, length)["own"]) < _TIME / 2:
            length *= 2
    return round(length * _TIME / spent)


def overhead(runs: int) -> None:
    """The processor time of a run besides that of its function, with a scene that is used again, and with loads."""
    study = Study(_SCENE, drive, length=[_length()], seeds=runs + _WARM)
    cache = SceneCache()
    shares: dict[str, list[float]] = {"overhead": [], "of_a_load": []}
    for number, run in enumerate(study.runs()):
        again, anew = run_once(study, run, None, cache), run_once(study, run)
        if again["hash"] != anew["hash"] or again["error"]:
            raise RuntimeError(f"run {number} differs from that of a new load: {again['error']}")
        if number >= _WARM:
            shares["overhead"].append(again["cpu"] / again["own"] - 1.0)
            shares["of_a_load"].append(anew["cpu"] / anew["own"] - 1.0)
    stopwatch.report(**{name: statistics.median(values) for name, values in shares.items()})


def workers(runs: int, rounds: int) -> None:
    """The runs per second of two workers, of those of one."""
    study = Study(_SCENE, drive, length=[6000], seeds=runs)
    times: dict[int, list[float]] = {1: [], 2: []}
    for _ in range(rounds):
        for count, walls in times.items():
            with tempfile.TemporaryDirectory() as folder:
                begin = time.perf_counter()
                study.run(folder, workers=count)
                walls.append(time.perf_counter() - begin)
    ratios = [one / two for one, two in zip(times[1], times[2], strict=True)]
    stopwatch.report(two_of_one=statistics.median(ratios), one_s=statistics.median(times[1]))


def main() -> None:
    """Run the measurement that the first argument names."""
    logging.disable(logging.WARNING)
    parser = argparse.ArgumentParser()
    parser.add_argument("what", choices=["overhead", "workers"])
    parser.add_argument("--runs", type=int, default=40)
    parser.add_argument("--rounds", type=int, default=3)
    given = parser.parse_args()
    if given.what == "overhead":
        overhead(given.runs)
    else:
        workers(given.runs, given.rounds)


if __name__ == "__main__":
    main()
