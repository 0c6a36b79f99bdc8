"""W3: 28,800 rays ten times a second."""

from __future__ import annotations

from typing import TYPE_CHECKING

from benchmarks.result import Result, at_least, failure
from benchmarks.trial import Program, TrialFailed, beyond, interleave

if TYPE_CHECKING:
    from collections.abc import Iterator

    from benchmarks.plan import Plan
    from benchmarks.trial import Record


def _check(record: Record) -> str | None:
    return beyond(record, "scan_error_m", 1e-3) or beyond(record, "scan_bad_share", 0.02)


def panorama(plan: Plan) -> Iterator[Result]:
    """W3: a laser scanner of 16 rows all around."""
    words = ("--secs", str(plan.seconds(5.0)))
    programs = [
        Program("morse", "benchmarks.programs.panorama", words),
        Program("mujoco", "benchmarks.peers.mujoco_loop", ("panorama", *words)),
    ]
    try:
        trials = interleave(programs, plan.repeats, _check)
    except TrialFailed as error:
        yield failure("W3", "16 x 1800 rays", str(error))
        return
    rates = {name: trial.median(plan.clock("rays_per_s")) for name, trial in trials.items()}
    own = rates.pop("morse")
    yield Result("W3", "16 x 1800 rays", own / rates["mujoco"], "x bare loop", at_least(4.0), rates, {"morse": own})
