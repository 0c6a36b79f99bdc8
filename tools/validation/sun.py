"""The position of the sun beside published values."""

from __future__ import annotations

import math
from datetime import datetime
from typing import TYPE_CHECKING

from figures import Figure

from morse.plugins.sun.almanac import equatorial, position

if TYPE_CHECKING:
    from collections.abc import Iterator

_EVENTS = (
    ("equinox of March 2025", "2025-03-20T09:01:00+00:00", 0.0),
    ("solstice of June 2024", "2024-06-20T20:51:00+00:00", 90.0),
    ("equinox of September 2024", "2024-09-22T12:44:00+00:00", 180.0),
    ("solstice of December 2024", "2024-12-21T09:21:00+00:00", 270.0),
)


def figures() -> Iterator[Figure]:
    """Compute all figures."""
    place = position(_unix("2003-10-17T12:30:30-07:00"), 39.742476, -105.1786, 1830.14, 820.0, 11.0)
    source = "Reda and Andreas, NREL/TP-560-34302, table A5.1"
    name = "sun in Golden, 17 October 2003, 12:30:30"
    yield Figure(name, "zenith, °", 50.11162, 90.0 - math.degrees(place.elevation), 0.01, source)
    yield Figure(name, "azimuth, °", 194.34024, math.degrees(place.azimuth), 0.01, source)
    for name, date, longitude in _EVENTS:
        measured = longitude + math.remainder(equatorial(_unix(date)).longitude - longitude, 360.0)
        yield Figure(name, "longitude of the sun, °", longitude, measured, 0.01, "Astronomical Almanac, to the minute")


def _unix(date: str) -> float:
    return datetime.fromisoformat(date).timestamp()
