"""The magnetic field against the test values that NOAA publishes with the model."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morse.helpers.geodesy import LocalPlane
from morse.sensors.magnetometer import MagneticField, model_of
from tests.kit.effort import examples

#: "The US/UK World Magnetic Model for 2015-2020" and "... for 2020-2025": year, height (km), latitude, longitude,
#: north, east and down component (nT)
PUBLISHED = [
    (2015.0, 0, 80, 0, 6627.1, -445.9, 54432.3),
    (2015.0, 0, 0, 120, 39518.2, 392.9, -11252.4),
    (2015.0, 0, -80, 240, 5797.3, 15761.1, -52919.1),
    (2015.0, 100, 80, 0, 6314.3, -471.6, 52269.8),
    (2015.0, 100, 0, 120, 37535.6, 364.4, -10773.4),
    (2015.0, 100, -80, 240, 5613.1, 14791.5, -50378.6),
    (2017.5, 0, 80, 0, 6599.4, -317.1, 54459.2),
    (2017.5, 0, 0, 120, 39571.4, 222.5, -11030.1),
    (2017.5, 0, -80, 240, 5873.8, 15781.4, -52687.9),
    (2020.0, 0, 80, 0, 6570.4, -146.3, 54606.0),
    (2020.0, 0, 0, 120, 39624.3, 109.9, -10932.5),
    (2020.0, 0, -80, 240, 5940.6, 15772.1, -52480.8),
]


@pytest.mark.parametrize(("year", "height", "latitude", "longitude", "north", "east", "down"), PUBLISHED)
def test_published_values(year, height, latitude, longitude, north, east, down):
    field = MagneticField(LocalPlane(longitude, latitude, height * 1000.0), year)
    # the table is rounded to 0.1 nT
    assert field.at((0.0, 0.0, 0.0)) == pytest.approx((east, north, -down), abs=0.06)
    turned = MagneticField(LocalPlane(longitude, latitude, height * 1000.0, math.pi / 2), year)
    assert turned.at((0.0, 0.0, 0.0)) == pytest.approx((north, -east, -down), abs=0.06)


@settings(max_examples=examples(25), deadline=None)
@given(st.floats(-3e3, 3e3), st.floats(-3e3, 3e3), st.floats(-100.0, 3e3))
def test_anywhere_in_the_world_as_at_that_place(x, y, z):
    plane = LocalPlane(1.4, 43.6, 135.0)
    there = MagneticField(LocalPlane(*plane.geodetic_of((x, y, z))), 2022.5)
    assert MagneticField(plane, 2022.5).at((x, y, z)) == pytest.approx(there.at((0.0, 0.0, 0.0)), abs=1e-2)


@pytest.mark.parametrize(
    ("year", "model"),
    [
        (2000.0, "WMM2010"),
        (2014.99, "WMM2010"),
        (2015.0, "WMM2015"),
        (2019.9, "WMM2015"),
        (2020.0, "WMM2020"),
        (2025.0, "WMM2025"),
        (2031.0, "WMM2025"),
    ],
)
def test_the_model_of_a_year(year, model):
    assert model_of(year) == model


def test_the_revised_model_of_2015_differs():
    plane = LocalPlane(0.0, 80.0, 0.0)
    # NOAA revised it, since the north pole moved faster: D 2015.0 changes by 0.04 degrees there
    before, after = (MagneticField(plane, 2018.0, name).at((0.0, 0.0, 0.0)) for name in ("WMM2015", "WMM2015v2"))
    assert max(abs(a - b) for a, b in zip(before, after, strict=True)) > 5.0
