"""The result of a benchmark."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any, Literal


@dataclass(frozen=True)
class Wanted:
    """The target of a value.

    Attributes:
        relation: ``>=`` or ``<=``.
        bound: in the unit of the value.
    """

    relation: Literal[">=", "<="]
    bound: float

    def holds(self, value: float) -> bool:
        """Whether a value reaches the target."""
        return value >= self.bound if self.relation == ">=" else value <= self.bound


@dataclass(frozen=True)
class Result:
    """One line of the table.

    Attributes:
        benchmark: its name.
        case: the measured case.
        value: the result, or None if nothing could be measured.
        unit: of the value.
        wanted: the target, or None.
        peers: results of other simulators, by name, in the unit of the value unless ``details`` contains the unit.
        details: more numbers, for the JSON file.
        trouble: the reason for a missing or wrong result.
        left_out: other simulators that failed or gave wrong results, by name, with the reason.
        failed: a program failed or gave wrong results, so that the whole command fails.
    """

    benchmark: str
    case: str
    value: float | None
    unit: str
    wanted: Wanted | None = None
    peers: dict[str, float] = field(default_factory=dict)
    details: dict[str, Any] = field(default_factory=dict)
    trouble: str = ""
    failed: bool = False
    left_out: dict[str, str] = field(default_factory=dict)

    @property
    def is_good(self) -> bool | None:
        """Whether it reaches the target; None without a target or a value."""
        if self.wanted is None or self.value is None:
            return None
        return self.wanted.holds(self.value)

    def as_json(self) -> dict[str, Any]:
        """For the JSON file."""
        return {**asdict(self), "good": self.is_good}


def at_least(bound: float) -> Wanted:
    """A target with a minimum."""
    return Wanted(">=", bound)


def at_most(bound: float) -> Wanted:
    """A target with a maximum."""
    return Wanted("<=", bound)


def skipped(benchmark: str, case: str, why: str) -> Result:
    """No measurement, for a valid reason."""
    return Result(benchmark, case, None, "", trouble=why)


def failure(benchmark: str, case: str, why: str) -> Result:
    """No measurement, because of an error."""
    return Result(benchmark, case, None, "", trouble=why, failed=True)
