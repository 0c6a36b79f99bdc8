"""Where the sun is: its direction at a time and a place.

The algorithm is that of J. Meeus, Astronomical Algorithms, 2nd edition (1998), chapters 12, 13, 22, 25 and 40, whose
solar longitude is right within 0.01° from 1900 to 2100; refraction by I. Reda and A. Andreas, Solar Position Algorithm
for Solar Radiation Applications, NREL/TP-560-34302 (2003), equation 42.
"""

from __future__ import annotations

import math
from datetime import UTC, datetime
from typing import NamedTuple

#: Julian date of 1970-01-01
_UNIX = 2440587.5
#: s between the time of clocks and that of the motion of planets, 1970 to 2050 within 20 s: 0.0002° of the sun
_DELTA_T = 65.0
#: °: half of the disc and the refraction at the horizon
RISES = -0.833
EARLIEST, LATEST = datetime(1900, 1, 1, tzinfo=UTC), datetime(2100, 1, 1, tzinfo=UTC)


class Position(NamedTuple):
    """Direction to the sun.

    Attributes:
        azimuth: rad, from north through east.
        elevation: rad, above the horizon, with refraction.
    """

    azimuth: float
    elevation: float


class Equatorial(NamedTuple):
    """Apparent coordinates of the sun, seen from the centre of the earth.

    Attributes:
        longitude: along the ecliptic, °.
        ascension, declination: right ascension and declination, °.
        distance: astronomical units.
        sidereal: apparent sidereal time at Greenwich, °.
    """

    longitude: float
    ascension: float
    declination: float
    distance: float
    sidereal: float


def equatorial(unix: float) -> Equatorial:
    """Return the apparent coordinates of the sun.

    Args:
        unix: seconds since 1970-01-01 UTC.
    """
    days = unix / 86400.0 + _UNIX - 2451545.0
    t = (days + _DELTA_T / 86400.0) / 36525.0
    mean = 280.46646 + t * (36000.76983 + t * 0.0003032)
    anomaly = math.radians(357.52911 + t * (35999.05029 - t * 0.0001537))
    eccentricity = 0.016708634 - t * (0.000042037 + t * 0.0000001267)
    centre = (
        (1.914602 - t * (0.004817 + t * 0.000014)) * math.sin(anomaly)
        + (0.019993 - 0.000101 * t) * math.sin(2.0 * anomaly)
        + 0.000289 * math.sin(3.0 * anomaly)
    )
    distance = 1.000001018 * (1.0 - eccentricity**2) / (1.0 + eccentricity * math.cos(anomaly + math.radians(centre)))
    node = math.radians(125.04452 - 1934.136261 * t)
    sun, moon = math.radians(2.0 * (280.4665 + 36000.7698 * t)), math.radians(2.0 * (218.3165 + 481267.8813 * t))
    # nutation, and aberration
    psi = (
        -17.20 * math.sin(node) - 1.32 * math.sin(sun) - 0.23 * math.sin(moon) + 0.21 * math.sin(2.0 * node)
    ) / 3600.0
    tilt = (9.20 * math.cos(node) + 0.57 * math.cos(sun) + 0.10 * math.cos(moon) - 0.09 * math.cos(2.0 * node)) / 3600.0
    longitude = mean + centre + psi - 20.4898 / 3600.0 / distance
    obliquity = math.radians(23.4392911 - t * (46.8150 + t * (0.00059 - t * 0.001813)) / 3600.0 + tilt)
    around = math.radians(longitude)
    ascension = math.degrees(math.atan2(math.cos(obliquity) * math.sin(around), math.cos(around)))
    declination = math.degrees(math.asin(math.sin(obliquity) * math.sin(around)))
    sidereal = 280.46061837 + 360.98564736629 * days + 0.000387933 * (days / 36525.0) ** 2
    sidereal += psi * math.cos(obliquity)
    return Equatorial(longitude % 360.0, ascension % 360.0, declination, distance, sidereal % 360.0)


def position(
    unix: float,
    latitude: float,
    longitude: float,
    altitude: float = 0.0,
    pressure: float | None = None,
    celsius: float = 12.0,
) -> Position:
    """Return the direction to the sun.

    Args:
        unix: seconds since 1970-01-01 UTC.
        latitude, longitude: °, north and east positive.
        altitude: m.
        pressure: of the air, hPa; None for that of the altitude.
        celsius: temperature of the air, °C.
    """
    seen = equatorial(unix)
    hour, delta = math.radians(seen.sidereal + longitude - seen.ascension), math.radians(seen.declination)
    phi = math.radians(latitude)
    # parallax: the place is not the centre of the earth
    flat = math.atan(0.99664719 * math.tan(phi))
    x = math.cos(flat) + altitude / 6378140.0 * math.cos(phi)
    y = 0.99664719 * math.sin(flat) + altitude / 6378140.0 * math.sin(phi)
    parallax = math.sin(math.radians(8.794 / 3600.0 / seen.distance))
    shift = math.atan2(-x * parallax * math.sin(hour), math.cos(delta) - x * parallax * math.cos(hour))
    delta = math.atan2(
        (math.sin(delta) - y * parallax) * math.cos(shift), math.cos(delta) - x * parallax * math.cos(hour)
    )
    hour -= shift
    azimuth = math.atan2(math.sin(hour), math.cos(hour) * math.sin(phi) - math.tan(delta) * math.cos(phi)) + math.pi
    elevation = math.degrees(
        math.asin(math.sin(phi) * math.sin(delta) + math.cos(phi) * math.cos(delta) * math.cos(hour))
    )
    hectopascal = 1013.25 * math.exp(-altitude / 8434.0) if pressure is None else pressure
    if elevation >= RISES:
        bend = 1.02 / (60.0 * math.tan(math.radians(elevation + 10.3 / (elevation + 5.11))))
        elevation += hectopascal / 1010.0 * 283.0 / (273.0 + celsius) * bend
    return Position(azimuth % (2.0 * math.pi), math.radians(elevation))
