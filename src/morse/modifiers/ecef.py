"""Earth-centred, earth-fixed coordinates."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from morse.modifiers.earth import EarthModifier

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.mathutils.rotations import Triple

_CHANGES = MappingProxyType({name: {"frame": "earth"} for name in "xyz"})


class CoordinatesToECEF(EarthModifier):
    """Converts the position of a measurement to earth-centred coordinates, m; angles are not changed."""

    _names = ("ECEF",)
    _components = ("Pose", "GPS")
    changes: Mapping[str, Mapping[str, object]] = _CHANGES

    def converted(self, place: Triple) -> Triple:
        """World to earth-centred coordinates, m."""
        return self.plane.ecef_of(place)


class CoordinatesFromECEF(EarthModifier):
    """Converts the position of a command from earth-centred coordinates, m."""

    _names = ("ECEF",)
    _components = ("Destination", "Waypoint", "Teleport")
    changes: Mapping[str, Mapping[str, object]] = _CHANGES

    def converted(self, place: Triple) -> Triple:
        """Earth-centred to world coordinates, m."""
        return self.plane.world_of_ecef(place)
