"""How thoroughly to measure."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Plan:
    """What the command line asks for.

    Attributes:
        quick: only see whether everything runs and does its work.
        repeats: runs of each program.
        processor: count processor time, not that of the wall clock: for machines that do other work too.
    """

    quick: bool = False
    repeats: int = 3
    processor: bool = False

    def counts(self, *counts: int) -> tuple[int, ...]:
        """Sizes to measure: all of them, or the first."""
        return counts[:1] if self.quick else counts

    def seconds(self, seconds: float) -> float:
        """Simulated seconds to run for."""
        return min(seconds, 0.5) if self.quick else seconds

    def clock(self, key: str) -> str:
        """The name of a value in the reports of programs, by the clock that counts."""
        return f"processor_{key}" if self.processor else key
