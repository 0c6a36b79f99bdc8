"""Feet instead of metres."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar

from morse.core.modifier import AbstractModifier

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.declarations import Option

#: feet per metre, as in MORSE 1.4 (the international foot is 0.3048 m)
FEET = 3.2808399
_COORDINATES = ("x", "y", "z")


class _Feet(AbstractModifier):
    """The common part of both directions."""

    options: ClassVar[Mapping[str, Option]] = MappingProxyType({})
    changes: Mapping[str, Mapping[str, object]] = MappingProxyType({name: {"unit": "ft"} for name in _COORDINATES})
    _factor = 1.0

    def modify(self) -> None:
        """Convert the coordinates."""
        for name in _COORDINATES:
            try:
                self.data[name] *= self._factor
            except KeyError as missing:
                self.key_error(missing)


class MeterToFeet(_Feet):
    """Converts the coordinates of a measurement from metres to feet."""

    _names = ("feet",)
    _components = ("Pose", "GPS")
    _factor = FEET


class FeetToMeter(_Feet):
    """Converts the coordinates of a command from feet to metres."""

    _names = ("feet",)
    _components = ("Destination", "Waypoint", "Teleport")
    _factor = 1.0 / FEET
