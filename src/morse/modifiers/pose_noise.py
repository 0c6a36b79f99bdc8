"""Gaussian noise on positions and angles."""

from __future__ import annotations

import math
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from morse.core.declarations import Option, add_state
from morse.core.modifier import AbstractModifier
from morse.modifiers.earth import deviations

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.object import Object
    from morse.core.values import Options

_POSITION, _ANGLES = ("x", "y", "z"), ("roll", "pitch", "yaw")
_FLAT = ("x", "y", "yaw")
_FULL_TURN = 2.0 * math.pi


class NoiseModifier(AbstractModifier):
    """Adds Gaussian noise to the fields of a measurement.

    Options: ``pos_std`` and ``rot_std``, standard deviations in metres and radians, each a number or a dictionary by
    axis (``x``, ``y``, ``z``; ``roll``, ``pitch``, ``yaw``); ``_2D`` for noise in x, y and yaw only.
    """

    options: ClassVar[Mapping[str, Option]] = MappingProxyType(
        {
            "pos_std": Option((float, int, dict), 0.05, "Standard deviation of the position", unit="m"),
            "rot_std": Option((float, int, dict), math.radians(5.0), "Standard deviation of the angles", unit="rad"),
            "_2D": Option(bool, False, "Noise in x, y and yaw only"),
        }
    )
    _noisy: ClassVar[tuple[str, ...]] = (*_POSITION, *_ANGLES)

    add_state("_random", np.random.Generator, "Noise")

    def __init__(self, component_instance: Object, kwargs: Options) -> None:
        super().__init__(component_instance, kwargs)
        position_deviations = deviations("pos_std", self.parameter("pos_std", default=0.05), _POSITION)
        position_deviations.update(deviations("rot_std", self.parameter("rot_std", default=math.radians(5.0)), _ANGLES))
        flat = self.parameter("_2D", default=False)
        self._deviations = {
            name: position_deviations[name]
            for name in self._noisy
            if position_deviations[name] > 0.0 and (not flat or name in _FLAT)
        }
        self.changes = {name: {"stddev": deviation} for name, deviation in self._deviations.items()}
        self._random = component_instance.context.random(f"{component_instance.name()}/{type(self).__name__}")

    def modify(self) -> None:
        """Add the noise; angles stay within (-pi, pi]."""
        data = self.data
        for name, deviation in self._deviations.items():
            if name not in data:
                self.key_error(name)
                continue
            value = data[name] + self._random.normal(0.0, deviation)
            data[name] = math.remainder(value, _FULL_TURN) if name in _ANGLES else value


class PoseNoiseModifier(NoiseModifier):
    """Adds Gaussian noise to position and angles."""

    _names = ("PoseNoise", "Noise")
    _components = ("Odometry", "Pose")


class PositionNoiseModifier(NoiseModifier):
    """Adds Gaussian noise to a position."""

    _names = ("PoseNoise", "Noise")
    _components = ("GPS",)
    _noisy: ClassVar[tuple[str, ...]] = _POSITION


class OrientationNoiseModifier(NoiseModifier):
    """Adds Gaussian noise to angles."""

    _names = ("PoseNoise", "Noise")
    _components = ("Gyroscope",)
    _noisy: ClassVar[tuple[str, ...]] = _ANGLES
