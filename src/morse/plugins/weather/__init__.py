"""Fog, rain, snow, dust and wind: ``env.weather(fog=50.0, rain=12.0)``."""

from __future__ import annotations

import math
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from morse.builder import workspace
from morse.core.exceptions import MorseBuilderError
from morse.core.reports.quoting import closest
from morse.plugins.weather.zones import checked_zone, is_number

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from morse.builder.environment import Environment

#: the property of the environment with the weather of the script
PROPERTY = "weather"
#: smallest and largest values: more than was ever measured
_LIMITS = {
    "fog": (1.0, math.inf, "m, the meteorological range"),
    "rain": (0.0, 2000.0, "mm/h"),
    "snow": (0.0, 200.0, "mm/h of melted snow"),
    "dust": (0.0, 100.0, "g/m^3"),
    "gusts": (0.0, 50.0, "m/s"),
    "wet": (0.0, 1.0, "0 for dry, 1 for wet"),
    "snow_cover": (0.0, 1.0, "0 for none, 1 for all of the ground"),
    "ice": (0.0, 1.0, "0 for none, 1 for smooth ice"),
    "lens_drops": (0.0, 200.0, "drops on each lens"),
}
#: what a zone has of its own
IN_ZONES = ("fog", "rain", "snow", "dust")
#: what stays as the script says, because friction does not change in a run
FIXED = ("wet", "snow_cover", "ice")
_FASTEST = 150.0
#: latest time of a schedule, s
_LATEST = 1e12
#: coefficient of friction on dry ground, and its shares: rubber on wet asphalt, on packed snow, and on ice (J. Y. Wong,
#: Theory of Ground Vehicles, table 1.4)
_DRY, _ON_WET, _ON_SNOW, _ON_ICE = 0.7, 0.5, 0.3, 0.14
#: horizontal turbulence as a share of the wind, at an altitude of 60 feet: 0.1 / (0.177 + 0.000823 h)^0.4
#: (MIL-F-8785C, section 3.7.3)
_DRYDEN = 0.181


def checked(values: Mapping[str, object], fail: Callable[[str], Exception]) -> dict[str, object]:
    """Return values of the weather as numbers, by their names: those of the arguments of `weather`.

    Raises:
        Exception: the result of ``fail``, for a message: a name is unknown, or a value is not valid.
    """
    numbers: dict[str, object] = {}
    names = (*_LIMITS, "wind")
    for name, value in values.items():
        if name not in names:
            near = closest(str(name), names)
            hint = f"; did you mean '{near}'?" if near else f"; there are {', '.join(names)}"
            raise fail(f"the weather has no '{name}'{hint}")
        if name == "wind":
            numbers[name] = _wind(value, fail)
        elif name == "fog" and value is None:
            numbers[name] = math.inf
        else:
            low, high, unit = _LIMITS[name]
            if not is_number(value) or not low <= value <= high:
                raise fail(f"{name}={value!r:.60}: expected {low:g} to {high:g} ({unit})")
            numbers[name] = float(value)
    return numbers


def _wind(value: object, fail: Callable[[str], Exception]) -> tuple[float, float, float]:
    parts = list(value) if isinstance(value, (list, tuple, np.ndarray)) else []
    right = len(parts) in (2, 3) and all(is_number(part) and abs(part) <= _FASTEST for part in parts)
    if not right:
        raise fail(f"wind={value!r:.60}: expected (x, y) or (x, y, z) in m/s, each at most {_FASTEST:g}")
    x, y, z = [*map(float, parts), 0.0][:3]
    return x, y, z


def weather(
    environment: Environment,
    fog: float | None = None,
    rain: float = 0.0,
    snow: float = 0.0,
    dust: float = 0.0,
    wind: tuple[float, ...] = (0.0, 0.0),
    gusts: str | float = 0.0,
    wet: float = 0.0,
    snow_cover: float = 0.0,
    ice: float = 0.0,
    lens_drops: float = 0.0,
    ground_effect: bool = False,
    schedule: Mapping[float, Mapping[str, object]] | None = None,
    zone: str | None = None,
    area: Sequence[Sequence[float]] | None = None,
    height: float | None = None,
) -> None:
    """Set the weather of a scene: ``env.weather(...)``.

    Args:
        fog: meteorological range, m: at that distance, 5 % of the contrast are left. None for no fog.
        rain: mm/h: 2 drizzle, 12 rain, 50 a cloudburst.
        snow: mm/h of melted snow.
        dust: g/m^3: 0.001 haze, 0.1 a dust storm.
        wind: mean velocity in the world, (x, y) or (x, y, z), m/s.
        gusts: ``"dryden"`` for the turbulence of that wind near the ground, or its horizontal standard deviation, m/s.
        wet: how wet the ground is, from 0 to 1: friction falls to a half, and cameras see reflections in it.
        snow_cover: share of the ground with snow, from 0 to 1; at 1, friction falls to 0.3, as while snow falls.
        ice: from 0 to 1; at 1, friction falls to 0.14.
        lens_drops: mean number of drops on the lens of each camera.
        ground_effect: whether rotors have more thrust near the ground.
        schedule: other values at later times, by simulated seconds: ``{60.0: {"rain": 30.0}, 120.0: {"rain": 0.0}}``;
            they change linearly in between.
        zone: a name; fog, rain, snow and dust of this call then hold only in ``area``. Zones do not overlap.
        area: two opposite corners (x, y) of a rectangle, or the corners of a convex polygon, m in the world.
        height: upper end of the zone, m in the world; None for none.

    Raises:
        MorseBuilderError: a value is not valid.
    """

    def fail(text: str) -> MorseBuilderError:
        return MorseBuilderError(f"env.weather: {text}")

    if gusts == "dryden":
        gusts = _DRYDEN * math.hypot(*_wind(wind, fail))
    elif isinstance(gusts, str):
        raise fail(f"gusts={gusts!r:.60}: expected 'dryden' or a standard deviation in m/s")
    given = {
        "fog": fog, "rain": rain, "snow": snow, "dust": dust, "wind": wind, "gusts": gusts, "wet": wet,
        "snow_cover": snow_cover, "ice": ice, "lens_drops": lens_drops,
    }  # fmt: skip
    first = checked(given, fail)
    if not isinstance(ground_effect, bool):
        raise fail(f"ground_effect={ground_effect!r:.60}: expected True or False")
    later = [(time, checked(values, fail)) for time, values in sorted(_items(schedule, fail), key=itemgetter(0))]
    known: dict = environment.environment_properties.get(PROPERTY, {"zones": []})  # type: ignore[assignment, type-arg]
    plan: dict[str, object] = {"first": first, "later": later}
    if zone is not None:
        for values in (first, *(values for _, values in later)):
            for name in values:
                if name not in IN_ZONES and values[name] != _CALM.get(name):
                    raise fail(f"{name} is that of the whole world: a zone has {', '.join(IN_ZONES)} of its own")
        place = checked_zone({"zone": zone, "area": area, "height": height}, [one for one, _ in known["zones"]], fail)
        plan = {"zones": [*known["zones"], (place, plan)]}
    elif area is not None or height is not None:
        raise fail("area and height are those of a zone: write env.weather(zone='bank', area=..., ...)")
    elif "first" in known:
        raise fail("the weather was set before; change it with schedule={seconds: {...}}")
    else:
        plan["ground_effect"] = ground_effect
        _moisten(*(float(first[name]) for name in ("wet", "snow_cover", "snow", "ice")))  # type: ignore[arg-type]
    if not known.get("altered"):
        environment.alter("Weather")
    environment.properties(**{PROPERTY: {**known, **plan, "altered": True}})


#: what a zone may not change
_CALM = {"wind": (0.0, 0.0, 0.0), "gusts": 0.0, "wet": 0.0, "snow_cover": 0.0, "ice": 0.0, "lens_drops": 0.0}


def _moisten(wet: float, cover: float, snow: float, ice: float) -> None:
    """Lower the friction of all that stands still, and that which the script has set."""
    shares = ((_ON_WET, wet), (_ON_SNOW, 1.0 if snow else cover), (_ON_ICE, ice))
    share = min(1.0 - (1.0 - least) * amount for least, amount in shares)
    for node in workspace.current().nodes() if share < 1.0 else ():
        body = node.body
        if body.collides and (body.friction is not None or not body.moves):
            body.friction = share * (_DRY if body.friction is None else body.friction)


def _items(schedule: object, fail: Callable[[str], Exception]) -> list[tuple[float, Mapping[str, object]]]:
    items: list[tuple[float, Mapping[str, object]]] = []
    for time, values in (schedule or {}).items() if isinstance(schedule, dict) or schedule is None else [(None, None)]:
        if not is_number(time) or not 0.0 <= time <= _LATEST or not isinstance(values, dict):
            raise fail("schedule: expected {seconds: {'rain': 30.0, ...}, ...}")
        for name in FIXED:
            if name in values:
                raise fail(f"schedule: '{name}' does not change in a run, nor does friction: env.weather({name}=...)")
        items.append((float(time), values))
    return items
