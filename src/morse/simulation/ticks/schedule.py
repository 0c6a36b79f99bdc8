"""Determines which components act in which tick."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator


class _Periodic(Protocol):
    frequency: float


_C = TypeVar("_C", bound=_Periodic)

#: maximum length of cached patterns, ticks
_LONGEST_PATTERN = 3600


class Schedule(Generic[_C]):
    """Schedules components by frequency; components keep their order within a tick.

    A component of rate ``f`` and phase ``p`` (s) in a simulation of rate ``b`` acts in tick ``k`` (from 0, not before
    ``b p``) if ``floor((k - b p) f/b)`` differs from ``floor((k - 1 - b p) f/b)``: as evenly as ticks allow, and
    exactly ``f`` times per second on average. The ticks are computed from integers, so that the schedule never drifts.

    Args:
        frequency: frequency of the simulation, Hz.
        phase: function that returns the phase of a component, s; None if all phases are 0.
    """

    def __init__(self, components: Iterable[_C], frequency: float, phase: Callable[[_C], float] | None = None) -> None:
        base = _fraction(frequency)
        self._entries: list[tuple[_C, int, int, int]] = []
        self._first, pattern = 0, 1
        for component in components:
            rate, late = (
                _fraction(component.frequency) / base,
                _fraction(phase(component) if phase is not None else 0.0) * base,
            )
            # over a common denominator: floor((k n - s) / d)
            shift = late * rate
            common = math.lcm(rate.denominator, shift.denominator)
            n, s = rate * common, shift * common
            self._entries.append((component, int(n), int(s), common))
            self._first = max(self._first, math.ceil(late))
            pattern = math.lcm(pattern, rate.denominator)
        self._pattern = pattern if pattern <= _LONGEST_PATTERN else 0
        self._known: dict[int, list[_C]] = {}

    def __iter__(self) -> Iterator[_C]:
        return (entry[0] for entry in self._entries)

    def place(self, tick: int) -> int | None:
        """Return a number that is equal for ticks in which, and after which, the same components act; or None."""
        return tick % self._pattern if self._pattern and tick >= self._first else None

    def due(self, tick: int) -> list[_C]:
        """Return the components that act in a tick, counted from 0. The list must not be modified."""
        if not self._pattern or tick < self._first:
            return self._due(tick)
        place = tick % self._pattern
        entries = self._known.get(place)
        if entries is None:
            entries = self._known[place] = self._due(tick)
        return entries

    def _due(self, tick: int) -> list[_C]:
        return [c for c, n, s, d in self._entries if tick * n >= s and (tick * n - s) // d != ((tick - 1) * n - s) // d]


def _fraction(value: float) -> Fraction:
    return Fraction(value).limit_denominator(10**6)
