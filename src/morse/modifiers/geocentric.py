"""Longitude, geocentric latitude and distance from the centre of the earth."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from morse.helpers.geodesy import ecef_of_geocentric, geocentric_of_ecef
from morse.modifiers.earth import EarthModifier

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.mathutils.rotations import Triple

_CHANGES = MappingProxyType(
    {
        "x": {"unit": "deg", "frame": "geocentric"},
        "y": {"unit": "deg", "frame": "geocentric"},
        "z": {"unit": "m", "frame": "geocentric"},
    }
)


class CoordinatesToGeocentric(EarthModifier):
    """Converts a position to longitude, geocentric latitude (x, y, degrees) and distance from the centre (z, m)."""

    _names = ("geocentric",)
    _components = ("Pose", "GPS")
    changes: Mapping[str, Mapping[str, object]] = _CHANGES

    def converted(self, place: Triple) -> Triple:
        """Convert world coordinates, m, to longitude, latitude, distance."""
        return geocentric_of_ecef(*self.plane.ecef_of(place))


class CoordinatesFromGeocentric(EarthModifier):
    """Converts longitude, geocentric latitude and distance from the centre (x, y, z) of a command to a position."""

    _names = ("geocentric",)
    _components = ("Destination", "Waypoint", "Teleport")
    changes: Mapping[str, Mapping[str, object]] = _CHANGES

    def converted(self, place: Triple) -> Triple:
        """Convert longitude, latitude, distance to world coordinates, m."""
        return self.plane.world_of_ecef(ecef_of_geocentric(*place))
