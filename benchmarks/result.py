"""What a benchmark found out."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any, Literal


@dataclass(frozen=True)
class Wanted:
    """What a value should be.

    Attributes:
        relation: ``>=`` or ``<=``.
        bound: in the unit of the value.
    """

    relation: Literal[">=", "<="]
    bound: float

    def holds(self, value: float) -> bool:
        """Whether a value is as wanted."""
        return value >= self.bound if self.relation == ">=" else value <= self.bound


@dataclass(frozen=True)
class Result:
    """One line of the table.

    Attributes:
        benchmark: its name.
        case: what exactly was done.
        value: what came out, or None if nothing could be measured.
        unit: of the value.
        wanted: or None where a value is for information only.
        peers: the same work by others, by name, in the unit of the value unless ``details`` says more.
        details: more numbers, for the JSON file.
        trouble: why nothing was measured, or what was wrong.
        left_out: others that broke down or did wrong work, by name, and why.
        failed: the work was wrong or a program broke down, so that the whole command fails.
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
        """Whether it is as wanted; None where nothing is wanted or nothing was measured."""
        if self.wanted is None or self.value is None:
            return None
        return self.wanted.holds(self.value)

    def as_json(self) -> dict[str, Any]:
        """For the JSON file."""
        return {**asdict(self), "good": self.is_good}


def at_least(bound: float) -> Wanted:
    """As much as that or more."""
    return Wanted(">=", bound)


def at_most(bound: float) -> Wanted:
    """As much as that or less."""
    return Wanted("<=", bound)


def skipped(benchmark: str, case: str, why: str) -> Result:
    """Nothing was measured, for a good reason."""
    return Result(benchmark, case, None, "", trouble=why)


def failure(benchmark: str, case: str, why: str) -> Result:
    """Nothing was measured, as something is broken."""
    return Result(benchmark, case, None, "", trouble=why, failed=True)
