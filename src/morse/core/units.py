"""Units of measurement: their dimensions, and conversions between them.

A unit is written as names, ``·`` or ``*``, ``/``, powers and roots: ``m/s``, ``rad/s^2``, ``N·m``, ``V/√Hz``.
"""

from __future__ import annotations

import math
import re
from fractions import Fraction
from functools import lru_cache
from typing import NamedTuple

from morse.core.exceptions import MorseDeclarationError
from morse.core.reports.quoting import nearest


class Unit(NamedTuple):
    """A unit in terms of base units: ``base = factor * value + offset``.

    Attributes:
        factor: size in base units.
        offset: offset of the zero point, in base units; 0 except for °C and °F.
        dimension: base unit and power, sorted. ``rad`` and ``px`` count as base units.
    """

    factor: float
    offset: float
    dimension: tuple[tuple[str, int | Fraction], ...]


_BASE = ("m", "kg", "s", "A", "K", "rad", "px", "cd", "mol", "dB")
#: name to factor and the unit that the factor refers to
_DERIVED: dict[str, tuple[float, str]] = {
    "ft": (0.3048, "m"), "in": (0.0254, "m"), "mi": (1609.344, "m"), "nmi": (1852.0, "m"),
    "g": (1e-3, "kg"), "t": (1e3, "kg"), "min": (60.0, "s"), "h": (3600.0, "s"),
    "deg": (math.pi / 180.0, "rad"), "°": (math.pi / 180.0, "rad"), "rev": (2.0 * math.pi, "rad"),
    "rpm": (math.pi / 30.0, "rad/s"), "sr": (1.0, "rad^2"), "kn": (1852.0 / 3600.0, "m/s"), "gee": (9.80665, "m/s^2"),
    "Hz": (1.0, "s^-1"), "Bq": (1.0, "s^-1"), "N": (1.0, "kg·m/s^2"),
    "J": (1.0, "N·m"), "Wh": (3600.0, "N·m"), "eV": (1.602176634e-19, "J"), "W": (1.0, "J/s"),
    "Pa": (1.0, "N/m^2"), "bar": (1e5, "N/m^2"), "psi": (6894.757293168, "N/m^2"),
    "C": (1.0, "A·s"), "Ah": (3600.0, "A·s"), "V": (1.0, "W/A"), "ohm": (1.0, "V/A"), "Ω": (1.0, "V/A"),
    "F": (1.0, "C/V"), "S": (1.0, "A/V"), "Wb": (1.0, "V·s"), "H": (1.0, "Wb/A"),
    "T": (1.0, "V·s/m^2"), "gauss": (1e-4, "T"), "lm": (1.0, "cd"), "lx": (1.0, "cd/m^2"),
    "l": (1e-3, "m^3"), "L": (1e-3, "m^3"), "Sv": (1.0, "J/kg"), "Gy": (1.0, "J/kg"),
    "1": (1.0, ""), "%": (1e-2, ""), "ppm": (1e-6, ""), "ppb": (1e-9, ""), "pH": (1.0, ""), "bit": (1.0, ""),
    "byte": (8.0, ""),
}  # fmt: skip
_PREFIXES = {
    "T": 1e12, "G": 1e9, "M": 1e6, "k": 1e3, "h": 1e2, "d": 1e-1, "c": 1e-2, "m": 1e-3, "u": 1e-6, "µ": 1e-6, "n": 1e-9,
    "p": 1e-12,
}  # fmt: skip
#: units that take prefixes; a name that is that of a unit already, such as ``pH`` or ``cd``, is not composed
_WITH_PREFIXES = (
    "m", "g", "s", "A", "K", "rad", "cd", "mol", "Hz", "Bq", "N", "J", "Wh", "eV", "W", "Pa", "bar", "C", "Ah", "V",
    "ohm", "Ω", "F", "S", "Wb", "H", "T", "lm", "lx", "l", "L", "Sv", "Gy", "bit", "byte",
)  # fmt: skip
_PREFIXED = {
    prefix + name: (size, name)
    for name in _WITH_PREFIXES
    for prefix, size in _PREFIXES.items()
    if prefix + name not in _BASE and prefix + name not in _DERIVED
}
#: temperature scales with an offset: size of a degree and zero point, K
_ZERO_POINTS = {"°C": (1.0, 273.15), "degC": (1.0, 273.15), "°F": (5.0 / 9.0, 459.67 * 5.0 / 9.0)}
_POWERS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
_TERM = re.compile(r"([^\d^*·/\s⁻⁰¹²³⁴⁵⁶⁷⁸⁹-]+|1)(?:(?:\^|\*\*)?(-?\d+)|([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?")
_SEPARATOR = re.compile(r"(/|·|(?<!\*)\*(?!\*))")


class UnitError(MorseDeclarationError):
    """A unit is unknown, or cannot be converted into another."""


@lru_cache(maxsize=1024)
def unit(text: str) -> Unit:
    """The unit of that name.

    Raises:
        UnitError: the unit is unknown.
    """
    if text in _ZERO_POINTS:
        factor, offset = _ZERO_POINTS[text]
        return Unit(factor, offset, (("K", 1),))
    if text in _BASE:
        return Unit(1.0, 0.0, ((text, 1),))
    factor, powers = 1.0, dict[str, int | Fraction]()
    sign = 1
    for index, part in enumerate(_SEPARATOR.split(text)):
        if index % 2:
            sign = -1 if part == "/" else 1
            continue
        scale, dimension = _term(part.strip(), text)
        factor *= scale**sign
        for name, power in dimension:
            powers[name] = powers.get(name, 0) + sign * power
    return Unit(factor, 0.0, tuple(sorted((name, power) for name, power in powers.items() if power)))


def _term(part: str, text: str) -> tuple[float, tuple[tuple[str, int | Fraction], ...]]:
    match = _TERM.fullmatch(part)
    if match is None:
        raise UnitError(f"the unit {text!r} is unknown{nearest(text, known_units())}")
    name = match[1].removeprefix("√")
    power: int | Fraction = int(match[2] or (match[3] or "1").translate(_POWERS))
    if name != match[1]:
        power = Fraction(power, 2)
    if name in _BASE:
        return 1.0, ((name, power),)
    derived = _DERIVED.get(name) or _PREFIXED.get(name)
    if derived is None:
        where = "" if name == text else f" in {text!r}"
        raise UnitError(f"the unit {name!r}{where} is unknown{nearest(name, [*known_units(), *_PREFIXED])}")
    size, of = derived
    base = unit(of) if of else Unit(1.0, 0.0, ())
    scale = (size * base.factor) ** (power if isinstance(power, int) else float(power))
    return scale, tuple((one, p * power) for one, p in base.dimension)


def known_units() -> list[str]:
    """Return the names from which units are composed, without those that have prefixes."""
    return [*_BASE, *_DERIVED, *_ZERO_POINTS]


@lru_cache(maxsize=1024)
def conversion(source: str, target: str) -> tuple[float, float]:
    """Factor and offset: ``value in wanted = factor * value in given + offset``.

    Raises:
        UnitError: the dimensions differ, or a unit is unknown.
    """
    if source == target:
        return 1.0, 0.0
    a, b = unit(source), unit(target)
    if a.dimension != b.dimension:
        alike = [name for name in known_units() if unit(name).dimension == b.dimension and name != target]
        hint = f"; known: {', '.join(alike)}" if alike else ""
        raise UnitError(f"{source!r} cannot be converted into {target!r}{hint}")
    return a.factor / b.factor, (a.offset - b.offset) / b.factor
