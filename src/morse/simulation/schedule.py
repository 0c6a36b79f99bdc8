"""Which components act in which tick."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar

if TYPE_CHECKING:
    from collections.abc import Iterable


class _Periodic(Protocol):
    frequency: float


_C = TypeVar("_C", bound=_Periodic)


class Schedule(Generic[_C]):
    """Components by their rates, in their order.

    A component of rate ``f`` in a simulation of rate ``b`` acts in tick ``k`` (from 0) if
    ``floor(k f/b)`` differs from ``floor((k-1) f/b)``: as evenly as ticks allow, exactly ``f``
    times a second on average, and from integers alone, so that it never drifts.
    """

    def __init__(self, components: Iterable[_C], frequency: float) -> None:
        self._entries: list[tuple[_C, int, int]] = []
        for component in components:
            ratio = Fraction(component.frequency).limit_denominator(10**6) / Fraction(frequency).limit_denominator(
                10**6
            )
            self._entries.append((component, ratio.numerator, ratio.denominator))
        self._always = all(n >= d for _, n, d in self._entries)
        self._all = [component for component, _, _ in self._entries]

    def due(self, tick: int) -> list[_C]:
        """The components that act in a tick, counted from 0."""
        if self._always:
            return self._all
        return [c for c, n, d in self._entries if n >= d or tick * n // d != (tick - 1) * n // d]
