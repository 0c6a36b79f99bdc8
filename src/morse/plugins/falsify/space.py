"""The space of the parameters of a scenario: each is an axis from 0 to 1, and has a default."""

from __future__ import annotations

import math
from bisect import bisect_left
from itertools import product
from statistics import NormalDist
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.many import Distribution

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

#: standard deviations of a normal distribution within which values are tried
_DEVIATIONS = 4.0
#: greatest number of cases of a space that is tried completely
_MOST_CASES = 10_000


class Axis:
    """A parameter.

    Attributes:
        name: its name.
        values: the values of a parameter that has a list of them, else empty.
        is_ordered: whether a value between two others is between them in effect, too.
        default: the value that is nothing special.

    Args:
        given: a `morse.many.Distribution`, a list of values, or a single value.
        default: the value that is nothing special; ... for the middle, or the first value of a list.

    Raises:
        ValueError: there are no values, or the default is none of them.
    """

    def __init__(self, name: str, given: object, default: object = ..., *, is_seed: bool = False) -> None:
        self.name = name
        self._kind: str = "choice"
        self._numbers: tuple[float, ...] = ()
        self.values: Sequence[Any] = ()
        if isinstance(given, Distribution) and given.kind != "choice" and given.numbers[0] != given.numbers[-1]:
            self._kind, self._numbers = given.kind, given.numbers
        elif isinstance(given, Distribution):
            self.values = given.numbers if given.kind == "choice" else given.numbers[:1]
        elif isinstance(given, range):
            self.values = given
        elif isinstance(given, (str, bytes, dict)) or not hasattr(given, "__iter__"):
            self.values = (given,)
        else:
            self.values = [*given]
        if self._kind == "choice" and not len(self.values):
            raise ValueError(f"the parameter '{name}' has no values")
        numbers = [value for value in self.values[:1000] if isinstance(value, (int, float)) and value is not True]
        self.is_ordered = not is_seed and (
            bool(self._numbers) or (len(numbers) == len(self.values[:1000]) and list(numbers) == sorted(numbers))
        )
        self.default = self._checked(self._middle() if default is ... else default)

    def _middle(self) -> Any:
        return self.values[0] if len(self.values) else self.value(0.5)

    def _checked(self, default: Any) -> Any:
        if len(self.values):
            if default not in self.values:
                raise ValueError(f"the default {default!r:.80} of '{self.name}' is none of its values")
            return default
        low, high = self.limits
        if isinstance(default, bool) or not isinstance(default, (int, float)) or not low <= default <= high:
            raise ValueError(f"the default {default!r:.80} of '{self.name}' is not from {low:g} to {high:g}")
        return float(default)

    @property
    def limits(self) -> tuple[float, float]:
        """The least and the greatest number; of a list the first and the last index."""
        if len(self.values):
            return 0.0, len(self.values) - 1.0
        a, b = self._numbers
        return (a - _DEVIATIONS * b, a + _DEVIATIONS * b) if self._kind == "normal" else (a, b)

    @property
    def is_constant(self) -> bool:
        """Whether there is one value alone."""
        return len(self.values) == 1

    def value(self, place: float) -> Any:
        """Return the value at a place from 0 to 1."""
        if len(self.values):
            return self.values[min(len(self.values) - 1, int(place * len(self.values)))]
        low, high = self.limits
        if self._kind == "loguniform":
            return min(high, max(low, low * (high / low) ** place))
        if self._kind == "normal":
            mean, deviation = self._numbers
            inner = NormalDist(mean, deviation).inv_cdf(min(1.0 - 1e-5, max(1e-5, place)))
            return min(high, max(low, inner))
        return min(high, max(low, low + (high - low) * place))

    def place(self, value: Any) -> float:
        """Return the place of a value."""
        if len(self.values):
            return (self._index(value) + 0.5) / len(self.values)
        low, high = self.limits
        if self._kind == "loguniform":
            return math.log(value / low) / math.log(high / low)
        if self._kind == "normal":
            return NormalDist(*self._numbers).cdf(value)
        return (float(value) - low) / (high - low)

    def _index(self, value: Any) -> int:
        if isinstance(self.values, range):
            return self.values.index(value)
        if self.is_ordered:
            index = bisect_left(self.values, value)
            if index < len(self.values) and self.values[index] == value:
                return index
        return list(self.values).index(value)

    def between(self, passes: Any, fails: Any) -> Any:
        """Return a value between two; ``fails`` if there is none."""
        if not len(self.values):
            a, b = self.place(passes), self.place(fails)
            return fails if abs(b - a) < 1e-12 else self.value(0.5 * (a + b))
        first, last = self._index(passes), self._index(fails)
        return self.values[(first + last) // 2] if abs(first - last) > 1 else fails

    def distance(self, a: Any, b: Any) -> float:
        """The distance of two values, from 0 to 1."""
        return abs(self.place(a) - self.place(b))

    def rounded(self, value: Any, away_from: Any) -> Iterator[Any]:
        """Numbers of few digits near a value, on the other side of ``away_from``; the shortest first."""
        if len(self.values):
            return
        low, high = self.limits
        for digits in (1, 2, 3):
            step = 10.0 ** (math.floor(math.log10(max(abs(value), 1e-12))) - digits + 1)
            number = math.ceil(value / step) if value >= away_from else math.floor(value / step)
            short = float(f"{number * step:.{digits + 1}g}")
            if low <= short <= high and abs(short - value) <= 0.01 * (high - low):
                yield short


class Space:
    """All parameters together.

    Args:
        parameters: as for `Axis`; a parameter ``seed`` is that of the simulation.
        defaults: of those that have one.
    """

    def __init__(self, parameters: Mapping[str, object], defaults: Mapping[str, object]) -> None:
        self.axes = [
            Axis(name, given, defaults.get(name, ...), is_seed=name == "seed") for name, given in parameters.items()
        ]
        #: those that have several values
        self.free = [axis for axis in self.axes if not axis.is_constant]

    @property
    def defaults(self) -> dict[str, Any]:
        """The default of each parameter."""
        return {axis.name: axis.default for axis in self.axes}

    def point(self, places: NDArray[np.float64]) -> dict[str, Any]:
        """Return the values at a point of the unit cube of the free parameters."""
        return self.defaults | {axis.name: axis.value(place) for axis, place in zip(self.free, places, strict=True)}

    def places(self, point: Mapping[str, Any]) -> NDArray[np.float64]:
        """Return the point of the unit cube."""
        return np.array([axis.place(point[axis.name]) for axis in self.free])

    def all_cases(self) -> list[dict[str, Any]] | None:
        """All points, if they are few enough to be tried."""
        count = 1
        for axis in self.free:
            count *= len(axis.values) or _MOST_CASES + 1
            if count > _MOST_CASES:
                return None
        names = [axis.name for axis in self.free]
        combinations = product(*(axis.values for axis in self.free))
        return [self.defaults | dict(zip(names, values, strict=True)) for values in combinations]


_PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71)


def halton(number: int, dimensions: int) -> NDArray[np.float64]:
    """Return a point of Halton's sequence in the unit cube, rotated so that it does not begin at a corner.

    Source: Halton (1960); beyond twenty dimensions, where it is no better than chance, numbers at random.
    """
    if dimensions > len(_PRIMES):
        return np.random.default_rng(number).random(dimensions)
    point = []
    for base in _PRIMES[:dimensions]:
        rest, factor, total = number + 1, 1.0, 0.0
        while rest:
            rest, digit = divmod(rest, base)
            factor /= base
            total += factor * digit
        point.append((total + 0.5 / base) % 1.0)
    return np.array(point)
