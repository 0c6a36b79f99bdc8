"""Errors of gyroscopes and accelerometers, specified by the quantities of data sheets."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from morse.core.generators import generator_state, set_generator_state

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np

    from morse.core.values import Fields, StateData

#: the largest Allan deviation of a first-order Gauss-Markov process, in units of its standard deviation
_GAUSS_MARKOV_PEAK = 0.6175
#: time between two measurements, s
_SHORTEST = 1e-6


class ErrorTerms(NamedTuple):
    """The error terms of one kind of sensor, for a quantity whose unit is u.

    Attributes:
        density: density of the white noise of each axis, u/√Hz, equal to the Allan deviation at 1 s.
        instability: in-run bias instability, u, the minimum of the Allan deviation as in data sheets.
        random_walk: random walk of the bias, u/√s, its standard deviation after one second.
        correlation_time: correlation time of the bias, s.
    """

    density: tuple[float, float, float]
    instability: float
    random_walk: float
    correlation_time: float

    @property
    def spread(self) -> float:
        """Standard deviation of the bias with a correlation time, u."""
        return self.instability / _GAUSS_MARKOV_PEAK

    def deviations(self, frequency: float) -> Fields:
        """Return the errors of measurements with a frequency, Hz, like `AbstractModifier.changes`."""
        white = [math.hypot(density * math.sqrt(frequency), self.spread) for density in self.density]
        return {"stddev": white, "walk": self.random_walk}


class InertialErrors:
    """Errors of three axes: white noise, a bias with a correlation time, and a bias with a random walk.

    The bias with a correlation time is a first-order Gauss-Markov process. Its Allan deviation has its maximum, which
    equals the bias instability, at 1.89 times the correlation time. See IEEE Std 952-1997, annex C.

    Args:
        random: generator of random numbers.
        terms: magnitudes of the errors.
    """

    def __init__(self, random: np.random.Generator, terms: ErrorTerms) -> None:
        self._random = random
        self.terms = terms
        start = terms.spread
        self._bias = [start * float(x) for x in random.standard_normal(3)] if start else [0.0, 0.0, 0.0]
        self._walk = [0.0, 0.0, 0.0]

    def added(self, truth: Sequence[float], dt: float) -> list[float]:
        """Return the measured values, ``dt`` seconds after the last measurement."""
        dt = max(dt, _SHORTEST)
        white_x, white_y, white_z, *others = self._random.standard_normal(9).tolist()
        wander_x, wander_y, wander_z, walk_x, walk_y, walk_z = others
        terms = self.terms
        # a measurement is the mean over the time since the last measurement
        sigma_x, sigma_y, sigma_z = (density / math.sqrt(dt) for density in terms.density)
        keep = math.exp(-dt / terms.correlation_time)
        push = terms.spread * math.sqrt(1.0 - keep * keep)
        stride = terms.random_walk * math.sqrt(dt)
        (x, y, z), (bias_x, bias_y, bias_z), (drift_x, drift_y, drift_z) = truth, self._bias, self._walk
        bias_x = keep * bias_x + push * wander_x
        bias_y = keep * bias_y + push * wander_y
        bias_z = keep * bias_z + push * wander_z
        drift_x, drift_y, drift_z = drift_x + stride * walk_x, drift_y + stride * walk_y, drift_z + stride * walk_z
        self._bias, self._walk = [bias_x, bias_y, bias_z], [drift_x, drift_y, drift_z]
        return [
            x + bias_x + drift_x + sigma_x * white_x,
            y + bias_y + drift_y + sigma_y * white_y,
            z + bias_z + drift_z + sigma_z * white_z,
        ]

    def get_state(self) -> StateData:
        """Return the state that determines the future errors."""
        return {"random": generator_state(self._random), "bias": list(self._bias), "walk": list(self._walk)}

    def set_state(self, state: StateData) -> None:
        """Restore a state that `get_state` returned."""
        set_generator_state(self._random, state["random"])
        self._bias, self._walk = list(state["bias"]), list(state["walk"])
