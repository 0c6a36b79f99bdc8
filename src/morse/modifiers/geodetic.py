"""Longitude, latitude and altitude."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from morse.modifiers.earth import EarthModifier

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.mathutils.rotations import Triple

_CHANGES = MappingProxyType(
    {
        "x": {"unit": "deg", "frame": "wgs84"},
        "y": {"unit": "deg", "frame": "wgs84"},
        "z": {"unit": "m", "frame": "wgs84"},
    }
)


class CoordinatesToGeodetic(EarthModifier):
    """Converts a position to longitude and latitude (x, y, degrees, WGS84) and altitude above the ellipsoid (z, m)."""

    _names = ("geodetic",)
    _components = ("Pose", "GPS")
    changes: Mapping[str, Mapping[str, object]] = _CHANGES

    def converted(self, place: Triple) -> Triple:
        """Convert world coordinates, m, to longitude, latitude, altitude."""
        return self.plane.geodetic_of(place)


class CoordinatesFromGeodetic(EarthModifier):
    """Converts longitude, latitude and altitude (x, y, z) of a command to a position."""

    _names = ("geodetic",)
    _components = ("Destination", "Waypoint", "Teleport")
    changes: Mapping[str, Mapping[str, object]] = _CHANGES

    def converted(self, place: Triple) -> Triple:
        """Convert longitude, latitude, altitude to world coordinates, m."""
        return self.plane.world_of_geodetic(*place)
