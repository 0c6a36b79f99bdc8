"""How the speed grows with the number of workers, and what limits it, from measured costs in processor time.

``python -m benchmarks.programs.scaling --plot workers.svg``. On a machine with few processors, or with other work, the
wall-clock time of many workers says nothing; the costs of the workers, and of the process that gives them work, do. A
sweep is limited by its driver, which takes rows while the workers go on. A vector of environments steps all of its rows
together: its process works while the workers wait.
"""

from __future__ import annotations

import argparse
import logging
import statistics
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

import morse.gym
from benchmarks import stopwatch
from benchmarks.plot import draw
from benchmarks.programs.sweeps import drive
from morse.gym.reach import Reach
from morse.many import Study

_SCENE = Path(__file__).parents[1] / "scenes" / "rows.py"
#: rows of a process of a vector
_ROWS = 16
_COUNTS = (1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1000)


class Costs(NamedTuple):
    """Processor time, s.

    Attributes:
        row: of the driver of a sweep, for a row.
        run: of a run of a sweep besides its function.
        work: of a process of a vector, for a step of its rows.
        step, worker: of the process of a vector, for a step, and for each worker in a step.
    """

    row: float
    run: float
    work: float
    step: float
    worker: float


def sweep(runs: int) -> tuple[float, float]:
    """The costs ``row`` and ``run``."""
    spent: dict[int, float] = {}
    # the first one imports what the others use
    for count in (1, runs, 8 * runs):
        study = Study(_SCENE, drive, length=[6], seeds=count)
        with tempfile.TemporaryDirectory() as folder:
            begin = time.process_time()
            table = study.run(folder, workers=1)
            spent[count] = time.process_time() - begin
    row = (spent[8 * runs] - spent[runs]) / (7 * runs)
    return row, statistics.median(cpu - own for cpu, own in zip(table["cpu"], table["own"], strict=True))


def vector(steps: int) -> tuple[float, float, float]:
    """The costs ``work``, ``step`` and ``worker``."""
    own: dict[int, float] = {}
    for workers in (1, 4):
        env = morse.gym.vector(Reach, _ROWS * workers, workers=workers)
        env.reset(seed=0)
        rng = np.random.default_rng(0)
        actions = rng.uniform(-1.0, 1.0, (steps, *env.action_space.shape)).astype(np.float32)
        begin, theirs = time.process_time(), _processor_time(env._parts.workers[0].pid)
        for action in actions:
            env.step(action)
        own[workers] = (time.process_time() - begin) / steps
        if workers == 1:
            work = (_processor_time(env._parts.workers[0].pid) - theirs) / steps
        env.close()
    worker = max((own[4] - own[1]) / 3.0, 0.0)
    return work, max(own[1] - worker, 0.0), worker


def _processor_time(pid: int) -> float:
    """Processor time of a process, s."""
    words = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(words[11]) + int(words[12])) / 100.0


def lines(costs: Costs) -> dict[str, list[tuple[float, float]]]:
    """The speed of N workers, of that of one: pairs of N and speed."""
    result: dict[str, list[tuple[float, float]]] = {}
    for own in (1.0, 0.05):
        rate = [min(n / (own + costs.run), 1.0 / costs.row) for n in _COUNTS]
        result[f"runs of {own:g} s"] = [(float(n), one / rate[0]) for n, one in zip(_COUNTS, rate, strict=True)]
    rate = [n / (costs.work + costs.step + costs.worker * n) for n in _COUNTS]
    result[f"vector, {_ROWS} rows"] = [(float(n), one / rate[0]) for n, one in zip(_COUNTS, rate, strict=True)]
    return result


def main() -> None:
    """Measure the costs, and draw the curve."""
    logging.disable(logging.WARNING)
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=50)
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--plot", type=Path)
    given = parser.parse_args()
    costs = Costs(*sweep(given.runs), *vector(given.steps))
    curves = lines(costs)
    if given.plot is not None:
        title = "Speed of N workers with a processor each, of that of one"
        given.plot.write_text(draw(curves, title, "workers"), encoding="utf-8")
    stopwatch.report(
        costs_ms={name: 1e3 * value for name, value in costs._asdict().items()},
        speed={name: dict(line)[64.0] for name, line in curves.items()},
    )


if __name__ == "__main__":
    main()
