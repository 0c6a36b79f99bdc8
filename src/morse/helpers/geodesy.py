"""Conversions between world, earth-centred and geodetic coordinates.

The ellipsoid is WGS84 (NIMA TR8350.2). The origin of a world has a longitude, a latitude and an altitude. At the origin
X points east, Y north and Z up, rotated counter-clockwise by ``angle_against_north`` about Z.

The functions use plain floats, because they are called for single positions in every tick; a call takes two
microseconds.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from morse.mathutils.rotations import product, turn, turn_back

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from morse.mathutils.rotations import Rotation9, Triple

#: semi-major axis, m
SEMI_MAJOR = 6378137.0
FLATTENING = 1.0 / 298.257223563
#: square of the eccentricity
E2 = FLATTENING * (2.0 - FLATTENING)
_E4 = E2 * E2
_NEEDED = ("longitude", "latitude", "altitude")


def ecef_of_geodetic(longitude: float, latitude: float, altitude: float) -> Triple:
    """Return the earth-centred, earth-fixed coordinates of a position, m.

    Args:
        longitude, latitude: degrees.
        altitude: altitude above the ellipsoid, m.
    """
    lon, lat = math.radians(longitude), math.radians(latitude)
    sine = math.sin(lat)
    normal = SEMI_MAJOR / math.sqrt(1.0 - E2 * sine * sine)
    out = (normal + altitude) * math.cos(lat)
    return out * math.cos(lon), out * math.sin(lon), (normal * (1.0 - E2) + altitude) * sine


def geodetic_of_ecef(x: float, y: float, z: float) -> Triple:
    """Return longitude and latitude (degrees) and altitude above the ellipsoid (m) of earth-centred coordinates (m).

    H. Vermeille, "Direct transformation from geocentric coordinates to geodetic coordinates", Journal of Geodesy 76
    (2002). Within 43 km of the centre of the earth, where the nearest point of the ellipsoid is not unique, the
    latitude is geocentric and the altitude is measured from the equator.
    """
    flat2 = x * x + y * y
    flat = math.sqrt(flat2)
    longitude = math.degrees(math.atan2(y, x))
    p = flat2 / SEMI_MAJOR**2
    q = (1.0 - E2) / SEMI_MAJOR**2 * z * z
    r = (p + q - _E4) / 6.0
    if r <= 0.0:
        return longitude, math.degrees(math.atan2(z, flat)), math.hypot(flat, z) - SEMI_MAJOR
    s = _E4 * p * q / (4.0 * r**3)
    t = math.cbrt(1.0 + s + math.sqrt(s * (2.0 + s)))
    u = r * (1.0 + t + 1.0 / t)
    v = math.sqrt(u * u + _E4 * q)
    w = E2 * (u + v - q) / (2.0 * v)
    k = math.sqrt(u + v + w * w) - w
    d = k * flat / (k + E2)
    far = math.hypot(d, z)
    return longitude, math.degrees(2.0 * math.atan2(z, d + far)), (k + E2 - 1.0) / k * far


def geocentric_of_ecef(x: float, y: float, z: float) -> Triple:
    """Return longitude and geocentric latitude (degrees) and distance from the centre of the earth (m)."""
    flat = math.hypot(x, y)
    return math.degrees(math.atan2(y, x)), math.degrees(math.atan2(z, flat)), math.hypot(flat, z)


def ecef_of_geocentric(longitude: float, latitude: float, radius: float) -> Triple:
    """Inverse of `geocentric_of_ecef`."""
    lon, lat = math.radians(longitude), math.radians(latitude)
    flat = radius * math.cos(lat)
    return flat * math.cos(lon), flat * math.sin(lon), radius * math.sin(lat)


class GeodesyError(ValueError):
    """The environment does not declare its position on the earth."""


class LocalPlane:
    """The tangent plane of the earth at the origin of the world.

    Args:
        longitude, latitude: position of the origin, degrees.
        altitude: altitude of the origin above the ellipsoid, m.
        angle_against_north: rotation of the axes of the world about Z, relative to east and north, rad.
    """

    def __init__(self, longitude: float, latitude: float, altitude: float, angle_against_north: float = 0.0) -> None:
        self._origin = ecef_of_geodetic(longitude, latitude, altitude)
        lon, lat = math.radians(longitude), math.radians(latitude)
        so, co, sa, ca = math.sin(lon), math.cos(lon), math.sin(lat), math.cos(lat)
        # columns: east, north and up in earth-centred axes
        east_north_up: Rotation9 = (-so, -sa * co, ca * co, co, -sa * so, ca * so, 0.0, ca, sa)
        c, s = math.cos(angle_against_north), math.sin(angle_against_north)
        #: rotation from the axes of the world to east, north and up
        self._turned: Rotation9 = (c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
        self._axes = product(east_north_up, self._turned)

    @classmethod
    def of(cls, properties: Mapping[str, object]) -> LocalPlane:
        """Create the plane of an environment from its properties.

        Raises:
            GeodesyError: the properties do not contain the position.
        """
        absent = [name for name in _NEEDED if name not in properties]
        if absent:
            raise GeodesyError(
                f"the environment does not declare its position on the earth: {' and '.join(absent)} missing; use "
                "env.properties(longitude=..., latitude=..., altitude=...), in degrees and metres"
            )
        longitude, latitude, altitude = (_number(properties, name) for name in _NEEDED)
        if not -90.0 <= latitude <= 90.0 or not -360.0 <= longitude <= 360.0:
            raise GeodesyError(
                f"env.properties(longitude={longitude:g}, latitude={latitude:g}): "
                "expected a longitude from -360 to 360 and a latitude from -90 to 90, in degrees"
            )
        return cls(longitude, latitude, altitude, angle_against_north(properties))

    def enu_of(self, vector: Sequence[float]) -> Triple:
        """Convert a vector or a position in the world into east, north and up."""
        return turn(self._turned, vector)

    def world_of_enu(self, vector: Sequence[float]) -> Triple:
        """Inverse of `enu_of`."""
        return turn_back(self._turned, vector)

    def ecef_of(self, position: Sequence[float]) -> Triple:
        """Convert a position in the world, m, into earth-centred coordinates, m."""
        (x, y, z), (ox, oy, oz) = turn(self._axes, position), self._origin
        return ox + x, oy + y, oz + z

    def world_of_ecef(self, position: Sequence[float]) -> Triple:
        """Inverse of `ecef_of`."""
        (x, y, z), (ox, oy, oz) = position, self._origin
        return turn_back(self._axes, (x - ox, y - oy, z - oz))

    def pose_of_earth(self) -> tuple[Triple, Rotation9]:
        """Return the centre of the earth in the world, m, and the rotation from earth-centred axes to the world."""
        a, b, c, d, e, f, g, h, i = self._axes
        return self.world_of_ecef((0.0, 0.0, 0.0)), (a, d, g, b, e, h, c, f, i)

    def geodetic_of(self, position: Sequence[float]) -> Triple:
        """Return longitude and latitude (degrees) and altitude above the ellipsoid (m) of a world position (m)."""
        return geodetic_of_ecef(*self.ecef_of(position))

    def world_of_geodetic(self, longitude: float, latitude: float, altitude: float) -> Triple:
        """Inverse of `geodetic_of`."""
        return self.world_of_ecef(ecef_of_geodetic(longitude, latitude, altitude))


def angle_against_north(properties: Mapping[str, object]) -> float:
    """Return the counter-clockwise rotation of a world about Z relative to east and north, rad; 0 if it is not set.

    Raises:
        GeodesyError: the property is not a number.
    """
    return _number(properties, "angle_against_north") if "angle_against_north" in properties else 0.0


def has_place(properties: Mapping[str, object]) -> bool:
    """Whether an environment declares its position on the earth."""
    return all(name in properties for name in _NEEDED)


def _number(properties: Mapping[str, Any], name: str) -> float:
    value = properties[name]
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise GeodesyError(f"env.properties({name}={value!r}): expected a number")
    return number
