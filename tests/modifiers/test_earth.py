"""Modifiers for geographic coordinates, against published points and by inversion."""

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import morse
from morse.builder import Environment, FakeRobot, Pose, Teleport
from morse.core.exceptions import MorseError
from tests.kit.effort import examples

NAMES = ("ECEF", "geodetic", "geocentric")


def scene(modifier: str, command: str | None = None, place: Any = (0.0, 0.0, 0.0), **where: float) -> Any:
    """A robot with a pose sensor, and optionally a teleport, with geographic coordinates."""

    def build() -> None:
        robot = FakeRobot()
        robot.translate(*place)
        pose = Pose()
        pose.alter(modifier)
        robot.append(pose)
        if command is not None:
            there = Teleport()
            there.alter(command)
            robot.append(there)
        env = Environment("empty", fastmode=True)
        env.properties(**where)

    return build


def measured(modifier: str, place: Any = (0.0, 0.0, 0.0), **where: float) -> tuple[float, float, float]:
    with morse.load(scene(modifier, None, place, **where)) as sim:
        data = sim.robot.pose.get()
    return data["x"], data["y"], data["z"]


@pytest.mark.parametrize(
    ("where", "expected"),
    [
        ({"longitude": 0.0, "latitude": 0.0, "altitude": 0.0}, (6378137.0, 0.0, 0.0)),
        ({"longitude": 90.0, "latitude": 0.0, "altitude": 1000.0}, (0.0, 6379137.0, 0.0)),
        ({"longitude": 17.0, "latitude": 90.0, "altitude": 0.0}, (0.0, 0.0, 6356752.314245)),
    ],
)
def test_earth_centred_coordinates_of_the_origin(where: dict[str, float], expected: tuple[float, ...]) -> None:
    # semi-axes of WGS84, NIMA TR8350.2
    assert measured("ECEF", **where) == pytest.approx(expected, abs=1e-5)


def test_north_is_along_y_of_the_world_unless_it_is_turned() -> None:
    where = {"longitude": 2.0, "latitude": 45.0, "altitude": 0.0}
    radius = 6367381.816  # of the meridian in 45 degrees, m
    _, latitude, _ = measured("geodetic", (0.0, 1000.0, 0.0), **where)
    assert math.radians(latitude - 45.0) * radius == pytest.approx(1000.0, abs=0.1)
    _, latitude, _ = measured("geodetic", (1000.0, 0.0, 0.0), angle_against_north=math.pi / 2, **where)
    assert math.radians(latitude - 45.0) * radius == pytest.approx(1000.0, abs=0.1)


def test_height_is_along_z() -> None:
    longitude, latitude, altitude = measured(
        "geodetic", (0.0, 0.0, 250.0), longitude=1.43, latitude=43.6, altitude=135.0
    )
    assert (longitude, latitude, altitude) == pytest.approx((1.43, 43.6, 385.0), abs=1e-8)


def test_the_geocentric_latitude_is_nearer_to_the_equator() -> None:
    longitude, latitude, distance = measured("geocentric", longitude=10.0, latitude=45.0, altitude=0.0)
    # tan of the geocentric latitude is (1 - e^2) times that of the geodetic one
    expected = math.degrees(math.atan((1.0 - 0.00669437999014) * math.tan(math.radians(45.0))))
    assert (longitude, latitude) == pytest.approx((10.0, expected), abs=1e-9)
    assert distance == pytest.approx(6367489.5, abs=0.1)


@settings(max_examples=examples(10))
@given(st.sampled_from(NAMES), st.tuples(*[st.floats(-1e5, 1e5)] * 3), st.floats(-3.0, 3.0))
def test_a_command_of_what_was_measured_changes_nothing(name: str, place: Any, angle: float) -> None:
    where = {"longitude": -67.29, "latitude": -55.98, "altitude": 425.0, "angle_against_north": angle}
    with morse.load(scene(name, name, place, **where)) as sim:
        sim.step()
        before = sim.robot.pose.data
        sim.robot.there.publish({axis: before[axis] for axis in "xyz"})
        sim.step(2)
        obj = sim.robot.component.bge_object
        assert list(obj.worldPosition) == pytest.approx(list(place), abs=1e-4)


def test_a_command_on_the_other_side_of_the_earth_is_refused_and_the_next_one_is_obeyed(
    caplog: pytest.LogCaptureFixture,
) -> None:
    where = {"longitude": 1.43, "latitude": 43.6, "altitude": 135.0}
    with morse.load(scene("ECEF", "ECEF", (3.0, 2.0, 0.0), **where)) as sim:
        sim.step()
        before = sim.robot.pose.data
        # 11,400 km below the robot in world axes, where nothing can be placed
        sim.robot.there.publish({"x": -7e6, "y": 0.3, "z": 0.3})
        sim.step(2)
        assert "robot.there: a command is refused" in caplog.text
        sim.robot.there.publish({axis: before[axis] for axis in "xyz"})
        sim.step(2)
        assert sim.context.failed == set()
        place = list(sim.robot.component.bge_object.worldPosition)
    assert place == pytest.approx([3.0, 2.0, 0.0], abs=1e-4)


def test_middlewares_get_the_orientation_in_earth_centred_axes() -> None:
    from morse.core.kinds import bind

    # on the equator at longitude 0, the world's east, north and up are Y, Z and X of the earth
    with morse.load(scene("ECEF", longitude=0.0, latitude=0.0, altitude=0.0)) as sim:
        sim.step()
        (pose,) = bind(sim.robot.pose.component)
        message = pose.gather()
    assert list(message.position) == pytest.approx([6378137.0, 0.0, 0.0])
    w, x, y, z = message.orientation
    # the rotation that takes (X, Y, Z) to (Y, Z, X): a third of a turn about (1, 1, 1)
    assert [w, x, y, z] == pytest.approx([0.5, 0.5, 0.5, 0.5]) or [w, x, y, z] == pytest.approx([-0.5] * 4)


@pytest.mark.parametrize("name", NAMES)
def test_an_environment_that_is_nowhere_is_refused(name: str) -> None:
    with pytest.raises(MorseError, match="longitude and latitude and altitude missing"):
        morse.load(scene(name))
