"""Declarations of component classes, and what is derived from them."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.core.declarations import Option, add_data, add_level, add_property, data_fields, levels, properties
from morse.core.exceptions import MorseDeclarationError
from morse.core.units import UnitError, conversion, known_units, unit


class Base:
    add_data("a", 1, "int", "first", unit="m")
    add_property("_p", 2.0, "P", "float", "a number")


class Derived(Base):
    add_data("b", "x", "string", "second", level=["raw"])
    add_data("a", 5, "int", "overridden")
    add_property("_q", True, "Q", "bool", "a switch")
    add_level("raw", None, "as it is", default=True)


def test_fields_of_bases_come_first_and_may_be_overridden():
    fields = data_fields(Derived)
    assert list(fields) == ["a", "b"]
    assert fields["a"].default == 5
    assert fields["b"].level == ("raw",)
    assert data_fields(Base)["a"].unit == "m"


def test_properties_and_levels():
    assert {p.name: p.default for p in properties(Derived).values()} == {"P": 2.0, "Q": True}
    assert levels(Derived)["raw"].default


def test_declarations_belong_in_a_class():
    with pytest.raises(SyntaxError, match="in the body of a component class"):
        add_data("lost", 0)


# -- options that contradict themselves are refused where they are declared ------------------------


@pytest.mark.parametrize(
    ("declared", "text"),
    [
        ({"low": 10.0, "high": 1.0}, "low=10 is greater than high=1"),
        ({"unit": "furlong"}, "the unit 'furlong' is unknown"),
        ({"low": 10.0}, "the default 5.0 is outside 10..inf"),
        ({"high": float("nan")}, "high is a number, not nan"),
        ({"choices": (1.0, 2.0)}, "the default 5.0 is not one of the choices"),
        ({"choices": [5.0]}, "choices are given in a tuple"),
        ({"allow": ("ninf",)}, "did you mean"),
        ({"type": "float"}, "type is a class such as float"),
    ],
)
def test_contradictions(declared: dict[str, Any], text: str) -> None:
    with pytest.raises(MorseDeclarationError, match="option 'how much'") as caught:
        Option(**{"type": float, "default": 5.0, "doc": "how much", **declared})
    assert text in str(caught.value)
    assert str(caught.value).startswith(f"{__file__}:")


def test_a_valid_option() -> None:
    option = Option(float, 5.0, "how much", low=0.0, high=10.0, unit="m")
    assert option.default == 5.0
    assert option._replace(default=6.0).high == 10.0


# -- units against the definitions of the SI (BIPM, 9th edition) and of the international yard -----

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
