"""Many robots without bodies; many moving objects in the live view."""

from __future__ import annotations

from typing import TYPE_CHECKING

from benchmarks.result import Result, at_least, at_most, failure
from benchmarks.trial import Program, TrialFailed, beyond, interleave

if TYPE_CHECKING:
    from collections.abc import Iterator

    from benchmarks.plan import Plan
    from benchmarks.trial import Record


def _check(record: Record) -> str | None:
    return beyond(record, "position_error_m", 1e-6)


def crowd(plan: Plan) -> Iterator[Result]:
    """A thousand kinematic robots with one pose sensor each."""
    count = 50 if plan.quick else 1000
    case = f"{count} kinematic robots, pose"
    program = Program("morse", "benchmarks.programs.crowd", ("--n", str(count), "--secs", str(plan.seconds(3.0))))
    try:
        trial = interleave([program], plan.repeats, _check)["morse"]
    except TrialFailed as error:
        yield failure("crowd", case, str(error))
        return
    details = {"load_s": trial.median("load_s"), "memory_mb": trial.median("memory_mb")}
    yield Result("crowd", case, trial.median(plan.clock("factor")), "x real time", at_least(1.0), details=details)


def view(plan: Plan) -> Iterator[Result]:
    """Processor time of the server of the view, in real time."""
    count = 20 if plan.quick else 500
    bounds = {1: 0.5, 4: 0.8}
    words = ("--n", str(count), "--secs", str(plan.seconds(12.0)), "--pages", *map(str, bounds))
    program = Program("morse", "benchmarks.programs.watched", words)
    try:
        trial = interleave([program], plan.repeats, _check)["morse"]
    except TrialFailed as error:
        yield failure("view", f"{count} moving objects", str(error))
        return
    details = {"alone": trial.median("alone_ms")}
    for pages, bound in bounds.items():
        case = f"{count} moving objects, {pages} page{'s' * (pages > 1)}"
        yield Result("view", case, trial.median(f"pages_{pages}_ms"), "ms a tick", at_most(bound), details=details)
