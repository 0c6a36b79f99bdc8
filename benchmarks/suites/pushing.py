"""Robots in contact with other bodies, compared with a bare loop on the same model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from benchmarks.result import Result, at_least, failure
from benchmarks.trial import Program, TrialFailed, beyond, interleave

if TYPE_CHECKING:
    from collections.abc import Iterator

    from benchmarks.plan import Plan
    from benchmarks.trial import Record

#: between the poses of both loops, and between robots and crates, m
_DISAGREEMENT, _GAP = 1e-4, 1e-3


def check(record: Record) -> str | None:
    """Errors of a run: every robot touches its crate, and both loops reach the same poses."""
    return beyond(record, "disagreement_m", _DISAGREEMENT) or beyond(record, "gap_m", _GAP)


def pushing(plan: Plan) -> Iterator[Result]:
    """Robots that push crates: none of them glides."""
    count = 10 if plan.quick else 50
    case = f"{count} robots push crates"
    program = Program("morse", "benchmarks.programs.pushing", ("--n", str(count), "--secs", str(plan.seconds(10.0))))
    try:
        trial = interleave([program], plan.repeats, check)["morse"]
    except TrialFailed as error:
        yield failure("pushing", case, str(error))
        return
    details = {"us": trial.median("us"), "moved_m": trial.median("moved_m")}
    yield Result("pushing", case, trial.median(plan.clock("ratio")), "x bare loop", at_least(0.9), details=details)
