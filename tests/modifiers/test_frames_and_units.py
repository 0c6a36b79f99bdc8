"""Modifiers for other frames and units: known points, and inversion."""

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import morse
from morse.builder import Environment, FakeRobot, Pose, Teleport
from morse.core.exceptions import MorseError
from tests.kit.effort import examples

_angles = st.floats(-3.1, 3.1)


def pose_of(
    *modifiers: str, place: tuple[float, ...] = (10.0, 8.0, 1.0), turned: Any = (0, 0, 0), **options: Any
) -> Any:
    """The measurement of a pose sensor with a modifier."""

    def scene() -> None:
        robot = FakeRobot()
        robot.translate(*place)
        robot.rotate(*turned)
        pose = Pose()
        for name in modifiers:
            pose.alter(name, **options)
        robot.append(pose)
        env = Environment("empty", fastmode=True)
        env.properties(UTMXOffset="-20000000.0", UTMYOffset=-1000.0)

    with morse.load(scene) as sim:
        return sim.robot.pose.get()


def test_north_east_down_of_a_body_that_looks_east() -> None:
    data = pose_of("NED")
    assert (data["x"], data["y"], data["z"]) == (8.0, 10.0, -1.0)
    assert data["yaw"] == pytest.approx(math.pi / 2)
    assert (data["roll"], data["pitch"]) == pytest.approx((0.0, 0.0))


def test_north_east_down_of_a_body_that_looks_north_and_up_and_leans_right() -> None:
    # nose up is a negative pitch about the left axis, and a positive one about the right axis
    data = pose_of("NED", turned=(0.2, -0.3, math.pi / 2))
    assert data["yaw"] == pytest.approx(0.0, abs=1e-12)
    assert data["pitch"] == pytest.approx(0.3)
    assert data["roll"] == pytest.approx(0.2)


@settings(max_examples=examples(10))
@given(_angles, st.floats(-1.4, 1.4), _angles)
def test_north_east_down_turns_vectors_as_the_exchange_of_axes_does(roll: float, pitch: float, yaw: float) -> None:
    from morse.core.mathutils import Euler, Matrix

    data = pose_of("NED", turned=(roll, pitch, yaw))
    world = Matrix(((0, 1, 0), (1, 0, 0), (0, 0, -1)))
    body = Matrix(((1, 0, 0), (0, -1, 0), (0, 0, -1)))
    wanted = world @ Euler((roll, pitch, yaw)).to_matrix() @ body
    got = Euler((data["roll"], data["pitch"], data["yaw"])).to_matrix()
    for row, other in zip(wanted, got, strict=True):
        assert list(row) == pytest.approx(list(other), abs=1e-9)


def test_the_grid_is_the_world_shifted() -> None:
    data = pose_of("UTM")
    assert (data["x"], data["y"], data["z"]) == (10.0 - 20000000.0, 8.0 - 1000.0, 1.0)
    data = pose_of("UTM", x_offset=123456789.0, z_offset="2.5")
    assert (data["x"], data["y"], data["z"]) == (123456799.0, 8.0 - 1000.0, 3.5)


def test_an_offset_that_is_no_number_is_refused() -> None:
    with pytest.raises(MorseError, match="x_offset, is a number of metres, not 'here'"):
        pose_of("UTM", x_offset="here")


def test_feet() -> None:
    # one foot is 0.3048 m by definition; the factor of 1.4 agrees in eight digits
    data = pose_of("feet", place=(0.3048, 3.048, -0.6096))
    assert (data["x"], data["y"], data["z"]) == pytest.approx((1.0, 10.0, -2.0), abs=1e-6)


@pytest.mark.parametrize(
    ("modifier", "sent"),
    [
        ("feet", {"x": 10.0 * 3.2808399, "y": 8.0 * 3.2808399, "z": 1.0 * 3.2808399}),
        ("NED", {"x": 8.0, "y": 10.0, "z": -1.0}),
    ],
)
def test_commands_are_turned_back(modifier: str, sent: dict[str, float]) -> None:
    def scene() -> None:
        robot = FakeRobot()
        there = Teleport()
        there.alter(modifier)
        robot.append(there)
        pose = Pose()
        robot.append(pose)
        Environment("empty", fastmode=True)

    with morse.load(scene) as sim:
        sim.robot.there.publish(sent)
        sim.step(2)
        data = sim.robot.pose.data
        assert (data["x"], data["y"], data["z"]) == pytest.approx((10.0, 8.0, 1.0))


def test_modifiers_work_in_the_order_of_the_script() -> None:
    data = pose_of("NED", "feet")
    assert (data["x"], data["z"]) == pytest.approx((8.0 * 3.2808399, -3.2808399))
