"""The actuators of MORSE, for scene scripts: one class for each component of `morse.actuators`."""

from __future__ import annotations

from morse.builder.creator import ActuatorCreator
from morse.builder.derive import derived_classes

_derived = derived_classes("morse.actuators", __name__)
globals().update(_derived)

__all__ = ["ActuatorCreator", *_derived]
