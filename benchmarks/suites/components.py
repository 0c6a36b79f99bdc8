"""The cost of each component per tick."""

from __future__ import annotations

from typing import TYPE_CHECKING

from benchmarks.result import Result, at_most, failure
from benchmarks.trial import Program, TrialFailed, interleave

if TYPE_CHECKING:
    from collections.abc import Iterator

    from benchmarks.plan import Plan

_WANTED = {"empty": 3.0, "Pose": 5.0, "MotionVW": 5.0}
#: target for every other component without rays or images
_MOST = 15.0


def components(plan: Plan) -> Iterator[Result]:
    """All sensors and actuators of MORSE."""
    for name in _WANTED if plan.quick else (*_WANTED, *_others()):
        program = Program(name, "benchmarks.programs.components", (name,))
        try:
            trial = interleave([program], plan.repeats)[name]
        except TrialFailed as error:
            yield failure("components", name, str(error))
            continue
        bound = None if trial.records[0]["rays"] else _WANTED.get(name, _MOST)
        value = trial.median(plan.clock("us"))
        if bound is None:
            yield Result("components", name, value, "µs")
        else:
            yield Result("components", name, value, "µs", at_most(bound), details={"share_of_bound": value / bound})


def _others() -> list[str]:
    # imported here: an error in MORSE must not prevent the other benchmarks from running
    from morse.builder.names import catalog

    packages = ("morse.sensors", "morse.actuators")
    return sorted({name for package in packages for name in catalog.components(package)} - set(_WANTED))
