"""Errors of gyroscopes and accelerometers in the terms of their data sheets."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

from morse.core.generators import generator_state, set_generator_state

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np

#: the largest Allan deviation of a first-order Gauss-Markov process, in units of its standard deviation
_GAUSS_MARKOV_PEAK = 0.6175
#: between two measurements, s
_SHORTEST = 1e-6


class ErrorTerms(NamedTuple):
    """The terms of one kind of sensor, for a quantity whose unit is u.

    Attributes:
        density: of the white noise, u/√Hz: the Allan deviation at 1 s.
        instability: in-run bias instability, u: the Allan deviation where it is least, as data sheets give it.
        random_walk: of the bias, u/√s: it gathers that much within a second.
        correlation_time: of the bias, s.
    """

    density: float
    instability: float
    random_walk: float
    correlation_time: float


class InertialErrors:
    """Errors of three axes: white noise, a bias that wanders about zero, and one that walks away.

    The wandering bias is a first-order Gauss-Markov process, whose Allan deviation is greatest, and equal to the bias
    instability, at 1.89 times its correlation time. See IEEE Std 952-1997, annex C.

    Args:
        random: draws the numbers.
        terms: how large the errors are.
    """

    def __init__(self, random: np.random.Generator, terms: ErrorTerms) -> None:
        self._random = random
        self.terms = terms
        start = self._spread
        self._bias = [start * float(x) for x in random.standard_normal(3)] if start else [0.0, 0.0, 0.0]
        self._walk = [0.0, 0.0, 0.0]

    @property
    def _spread(self) -> float:
        return self.terms.instability / _GAUSS_MARKOV_PEAK

    def added(self, truth: Sequence[float], passed: float) -> list[float]:
        """What is measured, ``passed`` seconds after the last measurement."""
        passed = max(passed, _SHORTEST)
        white, wander, walk = self._random.standard_normal((3, 3)).tolist()
        terms = self.terms
        # a measurement is the mean over the time since the last one
        sigma = terms.density / math.sqrt(passed)
        keep = math.exp(-passed / terms.correlation_time)
        push = self._spread * math.sqrt(1.0 - keep * keep)
        stride = terms.random_walk * math.sqrt(passed)
        measured = []
        for axis in range(3):
            self._bias[axis] = keep * self._bias[axis] + push * wander[axis]
            self._walk[axis] += stride * walk[axis]
            measured.append(truth[axis] + self._bias[axis] + self._walk[axis] + sigma * white[axis])
        return measured

    def get_state(self) -> dict[str, Any]:
        """What determines the errors to come."""
        return {"random": generator_state(self._random), "bias": list(self._bias), "walk": list(self._walk)}

    def set_state(self, state: dict[str, Any]) -> None:
        """Go on from a state that `get_state` gave."""
        set_generator_state(self._random, state["random"])
        self._bias, self._walk = list(state["bias"]), list(state["walk"])
