"""Floods: whether one client of a simulation in real time can disturb another one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from benchmarks.programs.flood import ATTACKS
from benchmarks.result import Result, at_least, at_most, failure
from benchmarks.trial import Program, TrialFailed, interleave

if TYPE_CHECKING:
    from collections.abc import Iterator

    from benchmarks.plan import Plan

#: longest additional gap (s) by the number of clients that flood, and share of the real-time factor
_GAPS = {1: 0.1, 4: 0.25}
_FACTOR = 0.95
#: packages of the middlewares that are not always installed
_NEEDS = {"ros2": "cyclonedds", "mavlink": "pymavlink", "mqtt": "paho"}


def floods(plan: Plan) -> Iterator[Result]:
    """Every port, with one client that floods it, and with four."""
    words = ("--secs", str(plan.seconds(3.0)), "--rounds", str(plan.repeats))
    for attack, (middleware, _) in ATTACKS.items() if not plan.quick else list(ATTACKS.items())[:1]:
        for clients in plan.counts(*_GAPS):
            case = f"{clients} x {attack}"
            arguments = ("--attack", attack, "--clients", str(clients), *words)
            program = Program(attack, "benchmarks.programs.flooded", arguments, needs=_NEEDS.get(middleware))
            if not program.is_installed:
                continue
            try:
                (record,) = interleave([program], 1)[attack].records
            except TrialFailed as error:
                yield failure("floods", case, str(error))
                continue
            control = max(record["gap_alone_s"], record["gap_hog_s"])
            gap = max(0.0, record["gap_flood_s"] - control)
            yield Result("floods", f"{case}: gap", gap, "s longer", at_most(_GAPS[clients]), details=record)
            usual = min(1.0, record["factor_alone"], record["factor_hog"])
            factor = record["factor_flood"] / usual
            yield Result("floods", f"{case}: factor", factor, "x without", at_least(_FACTOR), details=record)
