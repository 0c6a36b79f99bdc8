"""Declarations of noise and delay of sensors."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields


def _checked(name: str, value: object, unit: str) -> None:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise TypeError(f"{name} takes a number{unit}, got {value!r}")
    if not 0.0 <= value < math.inf:
        raise ValueError(f"{name} takes a number{unit} of at least 0, got {value!r}")


@dataclass(frozen=True, slots=True)
class NoiseModel:
    """The errors of a field.

    Attributes:
        gaussian: standard deviation of white noise, in the unit of the field.
        bias_walk: standard deviation of the bias after one second, in the unit of the field. The bias is a random walk
            from 0, which grows with the square root of time.
        quantization: step of the values, in the unit of the field.
        dropout: probability that a value is lost, 0..1.

    Raises:
        TypeError: a value is not a number.
        ValueError: a number is negative or not finite, or a probability is above 1.
    """

    gaussian: float = 0.0
    bias_walk: float = 0.0
    quantization: float = 0.0
    dropout: float = 0.0

    def __post_init__(self) -> None:
        for item in fields(self):
            _checked(item.name, getattr(self, item.name), "")
        if self.dropout > 1.0:
            raise ValueError(f"dropout takes a probability from 0 to 1, got {self.dropout!r}")


@dataclass(frozen=True, slots=True)
class RealismModel:
    """The phase, delay and noise of a sensor.

    Attributes:
        phase: time of the first measurement after the start, s.
        delay: time from a measurement until its data are published, s.
        noise: field to its noise; the empty name stands for all fields that can have noise.

    Raises:
        TypeError: a value is not a number.
        ValueError: a number is negative or not finite.
    """

    phase: float = 0.0
    delay: float = 0.0
    noise: dict[str, NoiseModel] = field(default_factory=dict)

    def __post_init__(self) -> None:
        _checked("phase", self.phase, " of seconds")
        _checked("delay", self.delay, " of seconds")


def is_numeric(value: object) -> bool:
    """Whether noise can be added: to numbers, and to vectors and lists of numbers, but not to booleans or strings."""
    if isinstance(value, (bool, str, bytes, dict)) or value is None:
        return False
    if isinstance(value, (int, float)):
        return True
    return hasattr(value, "__iter__") and all(is_numeric(item) for item in value)
