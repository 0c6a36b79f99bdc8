"""The sun by date and place: ``env.sun("2026-06-21T18:00:00+02:00", latitude=43.6, longitude=1.4)``."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from morse.builder import workspace
from morse.builder.errors import checks
from morse.core.exceptions import MorseBuilderError
from morse.helpers.geodesy import GeodesyError, angle_against_north, has_place
from morse.plugins.sun.almanac import EARLIEST, LATEST, Position, position
from morse.scene import Light, Node, NodeKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.builder.environment import Environment

#: the property of the environment with what the script says of the sun
PROPERTY = "sun"
#: elevation of the sun, °, and brightness of the sky, as eyes adapt to it: 1 for day; -6 is the end of civil twilight
_SKY = ((-18.0, 0.01), (-12.0, 0.02), (-6.0, 0.1), (0.0, 0.45), (10.0, 0.8), (25.0, 1.0))
#: optical depth of a clear atmosphere for red, green and blue light
_DEPTH = (0.07, 0.11, 0.22)
#: energy of the lamp in full daylight
_FULL = 0.95


class Look(NamedTuple):
    """How the sun and the sky look.

    Attributes:
        sky: brightness of the sky, 0 to 1.
        energy: of the lamp that stands for the sun.
        color: of its light.
    """

    sky: float
    energy: float
    color: tuple[float, float, float]


def look(elevation: float) -> Look:
    """Return how the sun and the sky look on a clear day.

    Args:
        elevation: of the sun, rad.
    """
    degrees = math.degrees(elevation)
    sky = _SKY[0][1]
    for (low, dark), (high, bright) in pairwise(_SKY):
        if degrees > low:
            sky = dark + (bright - dark) * min((degrees - low) / (high - low), 1.0)
    if degrees <= -0.5:
        return Look(sky, 0.0, (1.0, 0.5, 0.25))
    # the relative air mass of F. Kasten and A. Young, Applied Optics 28 (1989)
    up = max(degrees, 0.0)
    mass = 1.0 / (math.sin(math.radians(up)) + 0.50572 * (up + 6.07995) ** -1.6364)
    red, green, blue = (math.exp(-depth * (mass - 1.0)) for depth in _DEPTH)
    shown = min((degrees + 0.5) / 1.0, 1.0)
    return Look(sky, _FULL * red**0.5 * shown, (1.0, green / red, blue / red))


def axes(place: Position, north: float) -> tuple[float, float, float, float, float, float, float, float, float]:
    """Return the rotation (9, row by row) of a lamp that shines from the sun: its Z axis is the direction to the sun.

    Args:
        north: counter-clockwise rotation of the axes of the world relative to east and north, rad.
    """
    # counter-clockwise from the X axis of the world
    angle = 0.5 * math.pi - place.azimuth - north
    c, s, flat, up = math.cos(angle), math.sin(angle), math.cos(place.elevation), math.sin(place.elevation)
    return (-s, -c * up, c * flat, c, -s * up, s * flat, 0.0, flat, up)


def sun(
    environment: Environment,
    date: str,
    latitude: float | None = None,
    longitude: float | None = None,
    *,
    speed: float = 1.0,
) -> None:
    """Set the time of day of a scene: ``env.sun(...)``.

    The X axis of the world points east and its Y axis north, unless ``angle_against_north`` of the environment says
    something else.

    Args:
        date: at the start of the simulation, in ISO 8601 format; UTC unless it has another time zone:
            ``"2026-06-21T18:00:00+02:00"``.
        latitude, longitude: °, north and east positive; None for those of ``env.properties``.
        speed: how fast the day passes: 60 for a minute in each simulated second; 0 for a sun that stands still.

    Raises:
        MorseBuilderError: the sun was set before, or there is no place.
        TypeError, ValueError: an argument is not valid.
    """
    what = "env.sun"
    properties = environment.environment_properties
    if PROPERTY in properties:
        raise MorseBuilderError(f"{what}: the sun was set before")
    if (latitude is None) != (longitude is None):
        raise MorseBuilderError(f"{what} takes latitude and longitude, or none of them")
    if latitude is None and not has_place(properties):
        raise MorseBuilderError(
            f"{what} takes a place: env.sun({date!r:.40}, latitude=43.6, longitude=1.4), or write before it "
            "env.properties(longitude=1.4, latitude=43.6, altitude=150.0)"
        )
    start = checks.date(date, f"{what}(date)")
    if not EARLIEST.timestamp() <= start <= LATEST.timestamp():
        raise ValueError(f"{what}(date) takes a date from 1900 to 2099, got {date!r:.40}")
    values = {
        "start": start,
        "latitude": checks.number(
            properties["latitude"] if latitude is None else latitude, f"{what}(latitude)", minimum=-90.0, maximum=90.0
        ),
        "longitude": checks.number(
            properties["longitude"] if longitude is None else longitude,
            f"{what}(longitude)",
            minimum=-180.0,
            maximum=180.0,
        ),
        "speed": checks.number(speed, f"{what}(speed)", minimum=0.0, maximum=1e5),
    }
    try:
        north = angle_against_north(properties)
    except GeodesyError as error:
        raise MorseBuilderError(f"{what}: {error}") from None
    scene = workspace.current()
    node = next((one for one in scene.nodes() if one.light is not None and one.light.type == "SUN"), None)
    if node is None:
        node = Node("Sun", NodeKind.LIGHT, light=Light("SUN"))
        scene.add(node)
    place = position(start, values["latitude"], values["longitude"])
    seen = look(place.elevation)
    assert node.light is not None
    node.light.energy, node.light.color = seen.energy, seen.color
    node.rotation_euler = list(_angles(axes(place, north)))
    node.parent_inverse = None
    environment.settings.view.daylight = seen.sky
    environment.properties(**{PROPERTY: {**values, "lamp": node.name}})


def _angles(turn: Sequence[float]) -> tuple[float, float, float]:
    """Return the angles of a rotation about X, then Y, then Z, rad."""
    return math.atan2(turn[7], turn[8]), math.asin(max(-1.0, min(1.0, -turn[6]))), math.atan2(turn[3], turn[0])
