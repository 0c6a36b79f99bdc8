"""Frames with X north, Y east, Z down, as aircraft use them.

In the world of a scene, X points east, Y north and Z up. The coordinates (x, y, z) become (y, x, -z). The axes of a
body are forward, right, down instead of forward, left, up. Its roll is unchanged, its pitch changes sign, and its yaw
is measured clockwise from north: yaw becomes pi/2 - yaw. MORSE 1.4 also exchanged roll and yaw, which was wrong.
"""

from __future__ import annotations

import math
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar

from morse.core.modifier import AbstractModifier

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.declarations import Option

_COORDINATES, _ANGLES = ("x", "y", "z"), ("yaw", "pitch")
_FULL_TURN = 2.0 * math.pi


class AbstractNED(AbstractModifier):
    """Converts coordinates and angles; the conversion is its own inverse."""

    options: ClassVar[Mapping[str, Option]] = MappingProxyType({})
    changes: Mapping[str, Mapping[str, object]] = MappingProxyType(
        {name: {"frame": "ned"} for name in (*_COORDINATES, "roll", *_ANGLES)}
    )

    def exchange_coordinates(self) -> None:
        """Convert (x, y, z) to (y, x, -z)."""
        data = self.data
        try:
            data["x"], data["y"], data["z"] = data["y"], data["x"], -data["z"]
        except KeyError as missing:
            self.key_error(missing)

    def exchange_angles(self) -> None:
        """Measure the yaw from north, clockwise, and the pitch positive with the nose up; the roll does not change."""
        data = self.data
        try:
            yaw, pitch = math.remainder(0.5 * math.pi - data["yaw"], _FULL_TURN), -data["pitch"]
        except KeyError as missing:
            self.key_error(missing)
        else:
            data["yaw"], data["pitch"] = yaw, pitch


class CoordinatesToNED(AbstractNED):
    """Converts a pose to the north-east-down frame."""

    _names = ("NED",)
    _components = ("Pose", "Teleport")

    def modify(self) -> None:
        """Convert the coordinates and the angles."""
        self.exchange_coordinates()
        self.exchange_angles()


class PositionToNED(AbstractNED):
    """Converts a position to or from the north-east-down frame."""

    _names = ("NED",)
    _components = ("GPS", "Destination", "Waypoint")

    def modify(self) -> None:
        """Convert the coordinates."""
        self.exchange_coordinates()


class AnglesToNED(AbstractNED):
    """Converts angles to or from the north-east-down frame."""

    _names = ("NED",)
    _components = ("Gyroscope", "Orientation")

    def modify(self) -> None:
        """Convert the angles."""
        self.exchange_angles()


# class paths of 1.4 for conversions of commands; each conversion is its own inverse
CoordinatesFromNED = PositionToNED
AnglesFromNED = AnglesToNED
