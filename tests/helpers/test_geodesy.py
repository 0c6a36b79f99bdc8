"""Coordinates on the earth against published points, and against pymap3d."""

import math

import pymap3d
import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.helpers.geodesy import (
    GeodesyError,
    LocalPlane,
    ecef_of_geocentric,
    ecef_of_geodetic,
    geocentric_of_ecef,
    geodetic_of_ecef,
)

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
