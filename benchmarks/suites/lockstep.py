"""W6: a client controls the clock."""

from __future__ import annotations

from typing import TYPE_CHECKING

from benchmarks.result import Result, at_least, failure
from benchmarks.trial import Program, TrialFailed, beyond, interleave

if TYPE_CHECKING:
    from collections.abc import Iterator

    from benchmarks.plan import Plan
    from benchmarks.trial import Record


def _check(record: Record) -> str | None:
    return beyond(record, "position_error_m", 0.02)


def lockstep(plan: Plan) -> Iterator[Result]:
    """W6: command, one tick, pose: over TCP."""
    words = ("--rounds", "30" if plan.quick else "1500")
    programs = [
        Program(name, "benchmarks.programs.lockstep", ("--with", name, *words))
        for name in ("socket", "pymorse", "mujoco", "socket_streams", "pymorse_streams")
    ]
    try:
        trials = interleave(programs, plan.repeats, _check)
    except TrialFailed as error:
        yield failure("W6", "lockstep", str(error))
        return
    rates = {name: trial.median("rounds_per_s") for name, trial in trials.items()}
    bare = rates["mujoco"]
    peers = {"mujoco": bare}
    yield Result(
        "W6", "sockets", rates["socket"] / bare, "x bare loop", at_least(0.8), peers, {"morse": rates["socket"]}
    )
    yield Result(
        "W6", "pymorse", rates["pymorse"] / bare, "x bare loop", at_least(0.55), peers, {"morse": rates["pymorse"]}
    )
    for name in ("socket", "pymorse"):
        own = rates[f"{name}_streams"]
        yield Result("W6", f"{name}, by streams and step", own / bare, "x bare loop", None, peers, {"morse": own})
