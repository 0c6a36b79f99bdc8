"""Cameras that look at a point."""

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from morse.builder import ATRV, DepthCamera, Environment, SemanticCamera, VideoCamera
from morse.mathutils import Euler
from tests.kit.effort import examples

NUMBER = st.floats(-20.0, 20.0)


def axes(camera: VideoCamera) -> np.ndarray:
    """(3, 3): right, down and forward of the image, in rows, in the frame of the robot."""
    return np.array([list(row) for row in Euler(camera.scene_node.rotation_euler).to_matrix()]).T


@pytest.mark.parametrize("kind", [VideoCamera, DepthCamera, SemanticCamera])
def test_straight_ahead_is_as_mounted(kind: type[VideoCamera]) -> None:
    mounted, turned = kind("mounted"), kind("turned")
    turned.translate(x=0.5, z=0.9)
    turned.look_at(3.0, 0.0, 0.9)
    assert axes(turned) == pytest.approx(axes(mounted), abs=1e-9)


@given(st.tuples(NUMBER, NUMBER, NUMBER), st.tuples(NUMBER, NUMBER, NUMBER))
@example((0.0004275207691126407, 0.0, 0.0), (0.0, 0.0, 1.0))
@example((1e-7, 0.0, 0.0), (0.0, 0.0, 1.0))
@settings(max_examples=examples(40), suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_the_point_is_in_the_centre_and_up_is_up(place: tuple[float, ...], point: tuple[float, ...]) -> None:
    way = np.subtract(point, place)
    if np.linalg.norm(way) < 1e-3:
        return
    camera = VideoCamera()
    camera.translate(*place)
    camera.look_at(*point)
    right, down, forward = axes(camera)
    assert forward == pytest.approx(way / np.linalg.norm(way), abs=1e-9)
    assert np.cross(right, down) == pytest.approx(forward, abs=1e-9)
    assert down[2] <= 1e-9
    if np.hypot(*way[:2]) > 1e-2 * np.linalg.norm(way):
        assert abs(right[2]) < 1e-9


def test_it_sees_what_it_looks_at() -> None:
    robot = ATRV()
    camera = VideoCamera()
    camera.translate(z=2.0)
    camera.look_at(0.0, 0.0, 0.0)  # the drone's camera that looks down
    robot.append(camera)
    Environment("empty")
    right, down, forward = axes(camera)
    assert forward == pytest.approx([0, 0, -1], abs=1e-9)
    assert down == pytest.approx([-1, 0, 0], abs=1e-9)  # ahead is at the upper edge of the image
    assert right == pytest.approx([0, -1, 0], abs=1e-9)


def test_wrong_points_are_refused() -> None:
    camera = VideoCamera()
    camera.translate(x=1.0)
    with pytest.raises(ValueError, match="another point"):
        camera.look_at(1.0, 0.0, 0.0)
    with pytest.raises(ValueError, match="finite"):
        camera.look_at(math.nan, 0.0, 0.0)


def test_an_environment_says_what_it_is() -> None:
    assert repr(Environment("empty")) == "<Environment 'empty'>"
