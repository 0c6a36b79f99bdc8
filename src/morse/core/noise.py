"""Errors of measurement."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.scene.realism import NoiseModel


class Noise:
    """The errors of one field of one sensor, one measurement after the other.

    Args:
        random: draws all of them.
    """

    def __init__(self, model: NoiseModel, random: np.random.Generator) -> None:
        self.model = model
        self._random = random
        self._bias: NDArray[np.float64] | float = 0.0
        self._step = 0.0

    def pass_time(self, seconds: float) -> None:
        """The next measurement comes that long after the last one."""
        self._step = math.sqrt(seconds) * self.model.bias_walk

    def errors(self, truth: NDArray[np.float64], *, common: bool = False) -> NDArray[np.float64]:
        """The truth, any shape, as it is measured.

        Args:
            common: all values have the same bias, as the beams of one scanner.
        """
        model, measured = self.model, truth
        if model.bias_walk > 0.0:
            self._bias = self._bias + self._random.normal(0.0, 1.0, () if common else truth.shape) * self._step
            measured = measured + self._bias
        if model.gaussian > 0.0:
            measured = measured + self._random.normal(0.0, model.gaussian, truth.shape)
        if model.quantization > 0.0:
            measured = np.round(measured / model.quantization) * model.quantization
        return measured

    def lost(self, count: int = 1) -> NDArray[np.bool_]:
        """(N,) which values do not arrive."""
        if self.model.dropout == 0.0:
            return np.zeros(count, dtype=bool)
        return self._random.random(count) < self.model.dropout


def measured(value: Any, noise: Noise) -> Any:
    """A number, vector or list of numbers with errors, of the type that it had."""
    truth = np.array(value, dtype=np.float64)
    if truth.size == 0:
        return value
    result = noise.errors(truth)
    if isinstance(value, np.ndarray):
        return result
    if isinstance(value, (int, float, list)):
        return result.tolist()
    return type(value)(result.tolist())
