"""The actuators of MORSE, for scene scripts: one class for each component of `morse.actuators`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.builder import creator
from morse.builder.creator import ActuatorCreator

_derived = creator.derived_classes("morse.actuators", ActuatorCreator, __name__)
globals().update(_derived)

__all__ = ["ActuatorCreator", *_derived]

if TYPE_CHECKING:

    def __getattr__(name: str) -> Any: ...
