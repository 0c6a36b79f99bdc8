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


def people(plan: Plan) -> Iterator[Result]:
    """People among walls, and a robot with a lidar of 181 rays."""
    for count, bound in ((20, 1.0),) if plan.quick else ((200, 1.0), (1000, 0.2)):
        case = f"{count} people, a robot with 181 rays"
        program = Program("morse", "benchmarks.programs.people", ("--n", str(count), "--secs", str(plan.seconds(3.0))))
        try:
            trial = interleave([program], plan.repeats, _stands)["morse"]
        except TrialFailed as error:
            yield failure("people", case, str(error))
            continue
        details = {"load_s": trial.median("load_s"), "memory_mb": trial.median("memory_mb")}
        yield Result(
            "people", case, trial.median(plan.clock("factor")), "x real time", at_least(bound), details=details
        )


def _stands(record: Record) -> str | None:
    speed = record["mean_speed_m_s"]
    return None if speed > 0.1 else f"people walk at {speed:.2g} m/s"


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
