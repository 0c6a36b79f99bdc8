"""The settings of a measurement."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Plan:
    """The options of the command line.

    Attributes:
        quick: only check that everything runs correctly.
        repeats: runs of each program.
        processor: measure processor time, not wall-clock time, for loaded machines.
    """

    quick: bool = False
    repeats: int = 3
    processor: bool = False

    def counts(self, *counts: int) -> tuple[int, ...]:
        """Sizes to measure: all of them, or the first."""
        return counts[:1] if self.quick else counts

    def seconds(self, seconds: float) -> float:
        """Simulated seconds of a run."""
        return min(seconds, 0.5) if self.quick else seconds

    def clock(self, key: str) -> str:
        """The name of a value in the reports of programs, for the selected clock."""
        return f"processor_{key}" if self.processor else key
