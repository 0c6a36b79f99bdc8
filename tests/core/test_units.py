"""Units against the definitions of the SI (BIPM, 9th edition) and of the international yard."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.core.units import UnitError, conversion, known_units, unit

DEFINED = [
    ("deg", "rad", 180.0, math.pi),
    ("°", "deg", 30.0, 30.0),
    ("ft", "m", 1.0, 0.3048),
    ("%", "1", 100.0, 1.0),
    ("nT", "T", 1e9, 1.0),
    ("T", "gauss", 1.0, 1e4),
    ("km/h", "m/s", 36.0, 10.0),
    ("kn", "m/s", 3600.0, 1852.0),
    ("hPa", "Pa", 1013.25, 101325.0),
    ("°C", "K", 25.0, 298.15),
    ("°F", "°C", 212.0, 100.0),
    ("°F", "°C", -40.0, -40.0),
    ("rpm", "rad/s", 60.0, 2.0 * math.pi),
    ("Wh", "J", 1.0, 3600.0),
    ("N·m", "kg·m^2/s^2", 3.0, 3.0),
    ("m/s²", "m/s/s", 9.81, 9.81),
    ("s⁻¹", "Hz", 5.0, 5.0),
    ("g", "kg", 1.0, 1e-3),
    ("V*A", "W", 2.0, 2.0),
    ("uSv/h", "Sv/s", 3.6e9, 1.0),
    ("kBq", "Bq", 3.0, 3000.0),
    ("keV", "J", 1.0, 1.602176634e-16),
    ("MPa", "bar", 1.0, 10.0),
    ("cd", "mcd", 1.0, 1000.0),
]


@pytest.mark.parametrize(("given_in", "wanted", "value", "expected"), DEFINED)
def test_units_convert_as_they_are_defined(given_in, wanted, value, expected):
    factor, offset = conversion(given_in, wanted)
    assert factor * value + offset == pytest.approx(expected, rel=1e-12)


@given(st.sampled_from(known_units()), st.sampled_from(known_units()), st.floats(-1e6, 1e6))
def test_a_conversion_and_its_inverse_cancel(one, other, value):
    if unit(one).dimension != unit(other).dimension:
        with pytest.raises(UnitError, match="cannot be converted"):
            conversion(one, other)
        return
    a, b = conversion(one, other)
    c, d = conversion(other, one)
    # a temperature near 0 K is the difference of two large numbers
    assert c * (a * value + b) + d == pytest.approx(value, rel=1e-9, abs=1e-9 + 1e-12 * abs(b * c))


@pytest.mark.parametrize(
    ("name", "hint"), [("ra", "did you mean 'rad'"), ("", "known: m, kg"), ("m//s", "unknown"), ("m^x", "unknown")]
)
def test_unknown_units_are_refused(name, hint):
    with pytest.raises(UnitError, match=hint):
        unit(name)


def test_what_cannot_be_converted_names_what_could():
    with pytest.raises(UnitError, match="'W' cannot be converted into '°C'; known: K, degC, °F"):
        conversion("W", "°C")
