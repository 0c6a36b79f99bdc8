"""Gaussian noise on the vectors of an IMU."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from morse.core.declarations import Option, add_state
from morse.core.modifier import AbstractModifier
from morse.modifiers.earth import deviations

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.object import Object
    from morse.core.values import Options, Value

_AXES = ("x", "y", "z")
_FIELDS = {"gyro_std": "angular_velocity", "accel_std": "linear_acceleration"}


class IMUNoiseModifier(AbstractModifier):
    """Adds Gaussian noise to angular velocities and accelerations.

    Options: ``gyro_std`` (rad/s) and ``accel_std`` (m/s^2), each a number or a dictionary with ``x``, ``y``, ``z``.
    """

    _names = ("IMUNoise", "Noise")
    _components = ("IMU",)

    options: ClassVar[Mapping[str, Option]] = MappingProxyType(
        {
            "gyro_std": Option((float, int, dict), 0.5, "Standard deviation of the angular velocity", unit="rad/s"),
            "accel_std": Option((float, int, dict), 0.5, "Standard deviation of the acceleration", unit="m/s^2"),
        }
    )

    add_state("_random", np.random.Generator, "Noise")

    def __init__(self, component_instance: Object, kwargs: Options) -> None:
        super().__init__(component_instance, kwargs)
        self._deviations = {
            field: list(deviations(option, self.parameter(option, default=0.5), _AXES).values())
            for option, field in _FIELDS.items()
        }
        self.changes = {field: {"stddev": axes} for field, axes in self._deviations.items()}
        self._random = component_instance.context.random(f"{component_instance.name()}/{type(self).__name__}")

    def modify(self) -> None:
        """Add the noise."""
        for field, axes in self._deviations.items():
            if field not in self.data:
                self.key_error(field)
                continue
            value = self.data[field]
            errors = self._random.normal(0.0, 1.0, 3)
            noisy = [float(v) + float(e) * axis for v, e, axis in zip(value, errors, axes, strict=True)]
            self.data[field] = noisy if isinstance(value, list) else _like(value, noisy)


def _like(value: Value, numbers: list[float]) -> object:
    """Return numbers as a vector or array of the same type as ``value``."""
    copy = value.copy()
    copy[:] = numbers
    return copy
