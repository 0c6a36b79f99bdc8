"""The sensors of MORSE, for scene scripts: one class for each component of `morse.sensors`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.builder import creator, lasers
from morse.builder.creator import SensorCreator

_derived = creator.derived_classes("morse.sensors", SensorCreator, __name__)
_derived |= {name: getattr(lasers, name) for name in lasers.__all__}
globals().update(_derived)

__all__ = ["SensorCreator", *_derived]

if TYPE_CHECKING:

    def __getattr__(name: str) -> Any: ...
