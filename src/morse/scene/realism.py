"""How the data of a sensor differs from the truth."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Any


def _checked(name: str, value: object, unit: str) -> None:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise TypeError(f"{name} takes a number{unit}, got {value!r}")
    if not 0.0 <= value < math.inf:
        raise ValueError(f"{name} takes a number{unit} from 0 upward, got {value!r}")


@dataclass(frozen=True, slots=True)
class NoiseModel:
    """The errors of a field.

    Attributes:
        gaussian: standard deviation of white noise, in the unit of the field.
        bias_walk: standard deviation that the bias gathers within a second, in that unit: the bias is a random
            walk from 0, and grows with the square root of time.
        quantization: the value is a multiple of that, in that unit.
        dropout: probability that a value is lost, 0..1.

    Raises:
        TypeError: a value is not a number.
        ValueError: numbers that are negative or not finite, probabilities above 1.
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
    """When a sensor measures, when its data can be seen, and with what errors.

    Attributes:
        phase: seconds after the start at which it measures first.
        delay: seconds from a measurement until its data can be seen.
        noise: field to its errors; the empty name stands for all fields that are fit for noise.

    Raises:
        TypeError: a value is not a number.
        ValueError: numbers that are negative or not finite.
    """

    phase: float = 0.0
    delay: float = 0.0
    noise: dict[str, NoiseModel] = field(default_factory=dict)

    def __post_init__(self) -> None:
        _checked("phase", self.phase, " of seconds")
        _checked("delay", self.delay, " of seconds")


def is_numeric(value: Any) -> bool:
    """Whether noise can be added: to numbers, and to vectors and lists of them, but not to booleans or strings."""
    if isinstance(value, (bool, str, bytes, dict)) or value is None:
        return False
    if isinstance(value, (int, float)):
        return True
    return hasattr(value, "__iter__") and all(is_numeric(item) for item in value)
