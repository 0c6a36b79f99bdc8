"""Coordinates on the earth against published points, and against pymap3d."""

import math

import numpy as np
import pymap3d
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morse.helpers.geodesy import (
    GeodesyError,
    LocalPlane,
    ecef_of_geocentric,
    ecef_of_geodetic,
    geocentric_of_ecef,
    geodetic_of_ecef,
)
from morse.sensors.imu import ErrorTerms, InertialErrors
from morse.sensors.magnetometer import MagneticField, model_of
from tests.kit.effort import examples

LONGITUDE = st.floats(-180.0, 180.0)
LATITUDE = st.floats(-90.0, 90.0)
ALTITUDE = st.floats(-1e4, 1e6)
NEAR = st.floats(-5e3, 5e3)
#: EPSG Guidance Note 7-2, the example of method 9602: 53°48'33.820"N, 2°07'46.380"E, 73 m
EPSG_PLACE = (2 + 7 / 60 + 46.380 / 3600, 53 + 48 / 60 + 33.820 / 3600, 73.0)
EPSG_ECEF = (3771793.968, 140253.342, 5124304.349)
#: NIMA TR8350.2
SEMI_MINOR = 6356752.3142


def test_published_points():
    assert ecef_of_geodetic(*EPSG_PLACE) == pytest.approx(EPSG_ECEF, abs=1e-3)
    longitude, latitude, altitude = geodetic_of_ecef(*EPSG_ECEF)
    assert (longitude, latitude) == pytest.approx(EPSG_PLACE[:2], abs=1e-8)
    assert altitude == pytest.approx(73.0, abs=1e-3)
    assert ecef_of_geodetic(0.0, 0.0, 0.0) == pytest.approx((6378137.0, 0.0, 0.0), abs=1e-6)
    assert ecef_of_geodetic(0.0, 90.0, 0.0) == pytest.approx((0.0, 0.0, SEMI_MINOR), abs=1e-4)
    assert geodetic_of_ecef(0.0, 0.0, -SEMI_MINOR - 100.0)[1:] == pytest.approx((-90.0, 100.0), abs=1e-4)


@given(LONGITUDE, LATITUDE, ALTITUDE)
def test_as_pymap3d_has_it(longitude, latitude, altitude):
    there = ecef_of_geodetic(longitude, latitude, altitude)
    assert there == pytest.approx(pymap3d.geodetic2ecef(latitude, longitude, altitude), abs=1e-6)
    found = geodetic_of_ecef(*there)
    expected = pymap3d.ecef2geodetic(*there)
    assert found[1:] == pytest.approx([float(expected[0]), float(expected[2])], abs=1e-6)
    assert ecef_of_geodetic(*found) == pytest.approx(there, abs=1e-6)


@given(LONGITUDE, st.floats(-89.0, 89.0), st.floats(-500.0, 9e3), NEAR, NEAR, NEAR)
def test_a_world_as_pymap3d_has_it(longitude, latitude, altitude, east, north, up):
    plane = LocalPlane(longitude, latitude, altitude)
    lon, lat, alt = plane.geodetic_of((east, north, up))
    expected = pymap3d.enu2geodetic(east, north, up, latitude, longitude, altitude)
    assert lat == pytest.approx(float(expected[0]), abs=1e-9)
    assert math.remainder(lon - float(expected[1]), 360.0) == pytest.approx(0.0, abs=1e-9)
    assert alt == pytest.approx(float(expected[2]), abs=1e-5)
    assert plane.world_of_geodetic(lon, lat, alt) == pytest.approx((east, north, up), abs=1e-6)


@given(LONGITUDE, LATITUDE, st.floats(1.0, 1e8))
def test_geocentric_and_back(longitude, latitude, radius):
    there = ecef_of_geocentric(longitude, latitude, radius)
    assert math.hypot(*there) == pytest.approx(radius)
    assert ecef_of_geocentric(*geocentric_of_ecef(*there)) == pytest.approx(there, abs=1e-6)


def test_geocentric_latitude_by_the_ellipsoid():
    # on the ellipsoid the tangents of the two latitudes are as b^2 to a^2
    _, geocentric, _ = geocentric_of_ecef(*ecef_of_geodetic(10.0, 45.0, 0.0))
    assert math.tan(math.radians(geocentric)) == pytest.approx((SEMI_MINOR / 6378137.0) ** 2, abs=1e-9)


@given(st.floats(-1e7, 1e7), st.floats(-1e7, 1e7), st.floats(-1e7, 1e7))
def test_a_place_wherever_one_is_teleported(x, y, z):
    assert all(map(math.isfinite, geodetic_of_ecef(x, y, z)))
    assert all(map(math.isfinite, LocalPlane(1.4, 43.6, 135.0).geodetic_of((x, y, z))))


@pytest.mark.parametrize("place", [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 5.0)])
def test_the_centre_of_the_earth(place):
    assert geodetic_of_ecef(*place)[2] == pytest.approx(-6378137.0, abs=10.0)


def test_a_world_turned_against_north():
    # X points north, so Y points west
    plane = LocalPlane(0.0, 0.0, 0.0, math.pi / 2)
    assert plane.ecef_of((0.0, 0.0, 7.0)) == pytest.approx((6378144.0, 0.0, 0.0))
    assert plane.ecef_of((3.0, 0.0, 0.0)) == pytest.approx((6378137.0, 0.0, 3.0))
    assert plane.ecef_of((0.0, 3.0, 0.0)) == pytest.approx((6378137.0, -3.0, 0.0))
    assert plane.enu_of((1.0, 2.0, 3.0)) == pytest.approx((-2.0, 1.0, 3.0))
    assert plane.world_of_enu((-2.0, 1.0, 3.0)) == pytest.approx((1.0, 2.0, 3.0))


GIVEN = {"longitude": 1.4, "latitude": 43.6, "altitude": 135.0}


def test_properties_may_be_strings():
    plane = LocalPlane.of({name: str(value) for name, value in GIVEN.items()})
    assert plane.geodetic_of((0.0, 0.0, 0.0)) == pytest.approx((1.4, 43.6, 135.0))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"latitude": 91.0}, "a latitude from -90 to 90"),
        ({"longitude": 400.0}, "a longitude from -360 to 360"),
        ({"altitude": "high"}, r"env.properties\(altitude='high'\): expected a number"),
        ({"longitude": math.nan}, "expected a number"),
        ({"angle_against_north": None}, "expected a number"),
    ],
)
def test_places_that_are_none(change, said):
    with pytest.raises(GeodesyError, match=said):
        LocalPlane.of(GIVEN | change)


def test_what_is_missing_is_named():
    with pytest.raises(GeodesyError, match="latitude and altitude missing"):
        LocalPlane.of({"longitude": 1.0})


# -- the magnetic field against the test values that NOAA publishes with the model -----------------

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


# -- the errors of inertial sensors against the Allan deviations of their terms (IEEE Std 952-1997)


def record(terms, count, step, seed=5):
    """(N, 3) measurements at rest."""
    errors = InertialErrors(np.random.default_rng(seed), terms)
    return np.array([errors.added((0.0, 0.0, 0.0), step) for _ in range(count)])


def allan_deviation(values, step, tau):
    """Overlapping, of all axes together."""
    length = round(tau / step)
    sums = np.cumsum(np.vstack([np.zeros((1, values.shape[1])), values]), axis=0) * step
    second = sums[2 * length :] - 2.0 * sums[length:-length] + sums[: -2 * length]
    return math.sqrt(float((second**2).mean()) / (2.0 * tau**2))


@pytest.mark.parametrize("step", [0.01, 0.02])
def test_white_noise_is_the_density_at_a_second_whatever_the_rate(step):
    values = record(ErrorTerms((2e-3,) * 3, 0.0, 0.0, 100.0), 40_000, step)
    for tau in (0.1, 1.0):
        # Allan deviation of white noise: N / sqrt(tau)
        assert allan_deviation(values, step, tau) == pytest.approx(2e-3 / math.sqrt(tau), rel=0.06)


def test_bias_instability_is_the_largest_allan_deviation_of_the_bias():
    step, time = 0.1, 1.0
    values = record(ErrorTerms((0.0,) * 3, 3e-4, 0.0, time), 120_000, step)
    found = {tau: allan_deviation(values, step, tau) for tau in (0.2, 1.0, 1.9, 4.0, 20.0)}
    assert max(found, key=found.get) == 1.9
    assert found[1.9] == pytest.approx(3e-4, rel=0.06)


def test_random_walk_of_the_bias():
    values = record(ErrorTerms((0.0,) * 3, 0.0, 1e-3, 100.0), 60_000, 0.1)
    for tau in (1.0, 10.0):
        # Allan deviation of a random walk: K sqrt(tau / 3)
        assert allan_deviation(values, 0.1, tau) == pytest.approx(1e-3 * math.sqrt(tau / 3.0), rel=0.08)


def test_they_go_on_from_a_state():
    terms = ErrorTerms((1e-3,) * 3, 1e-3, 1e-3, 10.0)
    one, other = (InertialErrors(np.random.Generator(np.random.PCG64(seed)), terms) for seed in (1, 2))
    one.added((0.0, 0.0, 0.0), 0.1)
    other.set_state(one.get_state())
    assert one.added((1.0, 2.0, 3.0), 0.1) == other.added((1.0, 2.0, 3.0), 0.1)
