"""Fog, rain, snow, dust and wind: ``env.weather(fog=50.0, rain=12.0)``."""

from __future__ import annotations

import math
from numbers import Real
from typing import TYPE_CHECKING, TypeGuard

import numpy as np

from morse.builder import workspace
from morse.core.exceptions import MorseBuilderError
from morse.core.reports.quoting import closest

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

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
}
_FASTEST = 150.0
#: latest time of a schedule, s
_LATEST = 1e12
#: coefficient of friction on dry ground, and its shares: rubber on wet asphalt, and on packed snow (J. Y. Wong, Theory
#: of Ground Vehicles, table 1.4)
_DRY, _ON_WET, _ON_SNOW = 0.7, 0.5, 0.3
#: horizontal turbulence as a share of the wind, at an altitude of 60 feet: 0.1 / (0.177 + 0.000823 h)^0.4
#: (MIL-F-8785C, section 3.7.3)
_DRYDEN = 0.181


def checked(values: Mapping[str, object], fail: Callable[[str], Exception]) -> dict[str, object]:
    """Return values of the weather as numbers: ``fog``, ``rain``, ``snow``, ``dust``, ``wind``, ``gusts``, ``wet``.

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
            if not _is_number(value) or not low <= value <= high:
                raise fail(f"{name}={value!r:.60}: expected {low:g} to {high:g} ({unit})")
            numbers[name] = float(value)
    return numbers


def _is_number(value: object) -> TypeGuard[float]:
    # an integer of more bits is greater than all floats
    is_huge = isinstance(value, int) and value.bit_length() > 1000
    return isinstance(value, Real) and not isinstance(value, bool) and not is_huge


def _wind(value: object, fail: Callable[[str], Exception]) -> tuple[float, float, float]:
    parts = list(value) if isinstance(value, (list, tuple, np.ndarray)) else []
    right = len(parts) in (2, 3) and all(_is_number(part) and abs(part) <= _FASTEST for part in parts)
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
    schedule: Mapping[float, Mapping[str, object]] | None = None,
) -> None:
    """Set the weather of a scene: ``env.weather(...)``.

    Args:
        fog: meteorological range, m: at that distance, 5 % of the contrast are left. None for no fog.
        rain: mm/h: 2 drizzle, 12 rain, 50 a cloudburst.
        snow: mm/h of melted snow.
        dust: g/m^3: 0.001 haze, 0.1 a dust storm.
        wind: mean velocity in the world, (x, y) or (x, y, z), m/s.
        gusts: ``"dryden"`` for the turbulence of that wind near the ground, or its horizontal standard deviation, m/s.
        wet: how wet the ground is, from 0 to 1: friction falls to a half, and in snow to 0.3 of that of dry ground.
        schedule: other values at later times, by simulated seconds: ``{60.0: {"rain": 30.0}, 120.0: {"rain": 0.0}}``;
            they change linearly in between.

    Raises:
        MorseBuilderError: a value is not valid.
    """

    def fail(text: str) -> MorseBuilderError:
        return MorseBuilderError(f"env.weather: {text}")

    if gusts == "dryden":
        gusts = _DRYDEN * math.hypot(*_wind(wind, fail))
    elif isinstance(gusts, str):
        raise fail(f"gusts={gusts!r:.60}: expected 'dryden' or a standard deviation in m/s")
    given = {"fog": fog, "rain": rain, "snow": snow, "dust": dust, "wind": wind, "gusts": gusts, "wet": wet}
    first = checked(given, fail)
    later = []
    for time, values in sorted(_items(schedule, fail)):
        later.append((time, checked(values, fail)))
    if PROPERTY in environment.environment_properties:
        raise fail("the weather was set before; change it with schedule={seconds: {...}}")
    environment.alter("Weather")
    _moisten(float(first["wet"]), float(first["snow"]))  # type: ignore[arg-type]
    environment.properties(**{PROPERTY: {"first": first, "later": later}})


def _moisten(wet: float, snow: float) -> None:
    """Lower the friction of all that stands still, and that which the script has set."""
    share = min(1.0 - (1.0 - _ON_WET) * wet, _ON_SNOW if snow else 1.0)
    for node in workspace.current().nodes() if share < 1.0 else ():
        body = node.body
        if body.collides and (body.friction is not None or not body.moves):
            body.friction = share * (_DRY if body.friction is None else body.friction)


def _items(schedule: object, fail: Callable[[str], Exception]) -> list[tuple[float, Mapping[str, object]]]:
    items: list[tuple[float, Mapping[str, object]]] = []
    for time, values in (schedule or {}).items() if isinstance(schedule, dict) or schedule is None else [(None, None)]:
        if not _is_number(time) or not 0.0 <= time <= _LATEST or not isinstance(values, dict):
            raise fail("schedule: expected {seconds: {'rain': 30.0, ...}, ...}")
        if "wet" in values:
            raise fail("schedule: 'wet' does not change in a run, nor does friction: write env.weather(wet=...)")
        items.append((float(time), values))
    return items
