"""Parameters of a study: lists of values, and distributions that values are drawn from."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from zlib import crc32

import numpy as np

from morse.many.values import plain

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence


@dataclass(frozen=True)
class Distribution:
    """Values that are drawn at random, the same ones each time.

    Attributes:
        kind: ``uniform``, ``normal``, ``loguniform`` or ``choice``.
        numbers: its parameters; of ``choice`` the values.
        samples: number of values of a study.
    """

    kind: str
    numbers: tuple[Any, ...]
    samples: int

    def draw(self, rng: np.random.Generator) -> Any:
        """Draw one value."""
        if self.kind == "choice":
            return self.numbers[int(rng.integers(len(self.numbers)))]
        a, b = self.numbers
        if self.kind == "normal":
            return float(rng.normal(a, b))
        if self.kind == "loguniform":
            return math.exp(float(rng.uniform(math.log(a), math.log(b))))
        return float(rng.uniform(a, b))

    def values(self, name: str) -> list[Any]:
        """Return ``samples`` values; they depend on the name of the parameter, so that two parameters differ."""
        rng = np.random.default_rng([crc32(name.encode()), self.samples])
        return [self.draw(rng) for _ in range(self.samples)]


def uniform(low: float, high: float, *, samples: int = 1) -> Distribution:
    """Numbers between ``low`` and ``high``, all equally likely."""
    return Distribution("uniform", _ordered("uniform", low, high), _checked(samples))


def normal(mean: float, deviation: float, *, samples: int = 1) -> Distribution:
    """Numbers of a normal distribution."""
    if not deviation >= 0.0:
        raise ValueError(f"normal: the standard deviation is not negative, unlike {deviation!r}")
    return Distribution("normal", (float(mean), float(deviation)), _checked(samples))


def loguniform(low: float, high: float, *, samples: int = 1) -> Distribution:
    """Positive numbers whose logarithms are all equally likely."""
    if not low > 0.0:
        raise ValueError(f"loguniform: the lower limit is greater than 0, unlike {low!r}")
    return Distribution("loguniform", _ordered("loguniform", low, high), _checked(samples))


def choice(*values: object, samples: int = 1) -> Distribution:
    """One of these values, all equally likely."""
    if not values:
        raise ValueError("choice: there is no value")
    return Distribution("choice", tuple(plain(value, "a value of choice") for value in values), _checked(samples))


def _ordered(kind: str, low: float, high: float) -> tuple[float, float]:
    if not -math.inf < low <= high < math.inf:
        raise ValueError(f"{kind}: two finite limits, the lower one first, not {low!r} and {high!r}")
    return float(low), float(high)


def _checked(samples: int) -> int:
    if isinstance(samples, bool) or int(samples) != samples or samples < 1:
        raise ValueError(f"samples is a number of values, at least 1, not {samples!r}")
    return int(samples)


def axis(name: str, values: object) -> list[Any]:
    """Return the values of a parameter of a study: of a list, a range, a distribution, or a single value.

    Raises:
        ValueError: a list without values.
        TypeError: a value is not plain data.
    """
    if isinstance(values, Distribution):
        return values.values(name)
    if isinstance(values, (str, bytes, dict)) or not hasattr(values, "__iter__"):
        values = [values]
    choices = [plain(value, f"the parameter '{name}'") for value in values]
    if not choices:
        raise ValueError(f"the parameter '{name}' has no values")
    return choices


def combinations(axes: Mapping[str, Sequence[object]], seeds: Iterable[int]) -> Iterator[tuple[dict[str, object], int]]:
    """Each combination of the values of all parameters, with each seed."""
    every = list(seeds)
    for values in itertools.product(*axes.values()):
        for seed in every:
            yield dict(zip(axes, values, strict=True)), seed
