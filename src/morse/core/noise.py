"""Measurement noise."""

from __future__ import annotations

import copy
import math
from typing import TYPE_CHECKING

import numpy as np

from morse.core.generators import generator_state, set_generator_state
from morse.core.units import conversion
from morse.mathutils.portable import norm

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.declarations import DataField
    from morse.core.values import StateData, Value
    from morse.scene.realism import NoiseModel


class Noise:
    """The sequence of measurement errors of one field of one sensor.

    Args:
        random: generator of all random numbers.
        field: the declaration of the field, or None; values are kept within its range.
    """

    def __init__(self, model: NoiseModel, random: np.random.Generator, field: DataField | None = None) -> None:
        self.model = model
        self._field = field
        self._random = random
        self._bias: NDArray[np.float64] | float = 0.0
        self._step = 0.0

    def pass_time(self, seconds: float) -> None:
        """Advance the errors by the time between two measurements, s."""
        self._step = math.sqrt(seconds) * self.model.bias_walk

    def errors(self, truth: NDArray[np.float64], *, common: bool = False) -> NDArray[np.float64]:
        """Return the true values with errors, same shape.

        Args:
            common: all values share one bias, like the beams of one scanner.
        """
        model, value = self.model, truth
        if model.bias_walk > 0.0:
            shape = () if common else self._shape_of_bias(truth)
            if np.shape(self._bias) not in ((), shape):
                self._bias = 0.0  # the number of values has changed
            self._bias = self._bias + self._random.normal(0.0, 1.0, shape) * self._step
            value = value + self._bias
        if model.gaussian > 0.0:
            value = value + self._random.normal(0.0, model.gaussian, truth.shape)
        if model.quantization > 0.0:
            value = np.round(value / model.quantization) * model.quantization
        return value

    def _shape_of_bias(self, truth: NDArray[np.float64]) -> tuple[int, ...]:
        """One bias for each value, but a common one for the pixels of an image and the points of a cloud."""
        shape = None if self._field is None else self._field.shape
        if shape is None or len(shape) < 2 or None not in shape:
            return truth.shape
        free = len(shape) - shape[::-1].index(None)
        return truth.shape[free:]

    def possible(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the nearest values that the field can contain.

        Angles are wrapped to (-pi, pi], or (-180, 180] degrees; quaternions have the length 1; numbers are clipped to
        low..high.
        """
        field = self._field
        if field is None:
            return values
        if field.angle:
            turn = 2.0 * math.pi * conversion("rad", field.unit)[0]
            # the remainder is in [0, turn), so that the result is in (-turn/2, turn/2]
            values = turn / 2.0 - np.mod(turn / 2.0 - values, turn)
        if field.quaternion:
            length = float(norm(values))
            values = values / length if length > 0.0 else np.array([1.0, 0.0, 0.0, 0.0])
        if field.low is not None or field.high is not None:
            in_range = np.clip(values, field.low, field.high)
            values = np.where(np.isfinite(values), in_range, values)
        return values

    def get_state(self) -> StateData:
        """Return the state that determines the future errors, as plain data."""
        return {"random": generator_state(self._random), "bias": copy.copy(self._bias)}

    def set_state(self, state: StateData) -> None:
        """Restore a state that `get_state` returned."""
        set_generator_state(self._random, state["random"])
        self._bias = copy.copy(state["bias"])

    def lost(self, count: int = 1) -> NDArray[np.bool_]:
        """Return (N,) booleans: which values are lost."""
        if self.model.dropout == 0.0:
            return np.zeros(count, dtype=bool)
        return self._random.random(count) < self.model.dropout


def measured(value: Value, noise: Noise) -> Value:
    """Return a number, vector or list of numbers with errors, of the same type."""
    truth = np.array(value, dtype=np.float64)
    if truth.size == 0:
        return value
    result = noise.possible(noise.errors(truth))
    if isinstance(value, np.ndarray):
        return (np.rint(result) if value.dtype.kind in "iu" else result).astype(value.dtype)
    if isinstance(value, (int, float, list)):
        return result.tolist()
    return type(value)(result.tolist())
