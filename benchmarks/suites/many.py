"""A batch of simulations, compared with a loop around MuJoCo with as many states."""

from __future__ import annotations

from typing import TYPE_CHECKING

from benchmarks.result import Result, at_least, at_most, failure
from benchmarks.trial import Program, TrialFailed, beyond, interleave

if TYPE_CHECKING:
    from collections.abc import Iterator

    from benchmarks.plan import Plan
    from benchmarks.trial import Record

#: minimum ratio to the bare loop, by mode and number of rows
_WANTED = {("free", 64): 3.5, ("crash", 64): 2.0, ("free", 1): 1.0}
_ARRAYS = 0.05
_POSITION_ERROR, _SCAN_ERROR = 0.02, 0.02  # m


def check(record: Record) -> str | None:
    """Errors of a run: both loops drive along the same circle, and see the same walls."""
    return beyond(record, "position_error_m", _POSITION_ERROR) or beyond(record, "scan_error_m", _SCAN_ERROR)


def many(plan: Plan) -> Iterator[Result]:
    """Environment steps of a batch, in processor time on one thread."""
    for (mode, count), wanted in _WANTED.items():
        count = min(count, 4) if plan.quick else count
        case = f"{count} row{'s' * (count > 1)}, {mode}"
        words = ("--n", str(count), "--mode", mode, "--rounds", "2" if plan.quick else "20")
        try:
            trial = interleave([Program("morse", "benchmarks.programs.many", words)], plan.repeats, check)["morse"]
        except TrialFailed as error:
            yield failure("many", case, str(error))
            continue
        details = {f"{name}_us": trial.median(f"{name}_us") for name in ("morse", "bare")}
        yield Result("many", case, trial.median("ratio"), "x bare loop", at_least(wanted), details=details)
        if count > 1:
            share = 100.0 * trial.median("arrays")
            yield Result("many", f"{case}: arrays", share, "% of a step", at_most(100.0 * _ARRAYS))
    words = ("--n", "2" if plan.quick else "64", "--memory")
    try:
        trial = interleave([Program("morse", "benchmarks.programs.many", words)], 1)["morse"]
    except TrialFailed as error:
        yield failure("many", "memory", str(error))
        return
    yield Result("many", "a further row", trial.median("row_mb"), "MB", at_most(0.5))
    yield from _sweeps(plan)


def _sweeps(plan: Plan) -> Iterator[Result]:
    """What a run costs besides its function, and what a second worker brings."""
    module, runs = "benchmarks.programs.sweeps", "8" if plan.quick else "40"
    try:
        cost = Program("morse", module, ("overhead", "--runs", runs)).run()
        pair = Program("morse", module, ("workers", "--runs", runs, "--rounds", "1" if plan.quick else "5")).run()
    except TrialFailed as error:
        yield failure("many", "sweeps", str(error))
        return
    share, load = 100.0 * cost["overhead"], 100.0 * cost["of_a_load"]
    case = "a run of 0.05 s: all but its function"
    yield Result("many", case, share, "% of the function", at_most(10.0), details={"with a load": load})
    yield Result("many", "two workers, of one", pair["two_of_one"], "x", at_least(1.8))
