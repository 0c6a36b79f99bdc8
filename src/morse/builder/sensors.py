"""The sensors of MORSE, for scene scripts: one class for each component of `morse.sensors`."""

from __future__ import annotations

from morse.builder.components.sensors import LaserSensorWithArc  # noqa: F401 (scripts of 1.4 import it here)
from morse.builder.creator import SensorCreator
from morse.builder.derive import derived_classes

_derived = derived_classes("morse.sensors", __name__)
globals().update(_derived)

__all__ = ["SensorCreator", *_derived]
