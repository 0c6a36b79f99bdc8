"""Optical flow of cameras on robots that move."""

import numpy as np
import pytest

SCENE = """
robot = FakeRobot("robot")
robot.translate(z=2)
motion = MotionXYW("motion"); motion.properties(ControlType="Position")
robot.append(motion)
eye = OpticalFlowCamera("eye")
eye.properties(cam_width=96, cam_height=72, cam_focal=32, cam_near=0.3)
eye.frequency(10)
robot.append(eye)
wall = Cube("Wall"); wall.scale = (0.1, 20, 20); wall.location = (5.1, 0, 0)
env = Environment("empty")
"""


@pytest.fixture
def moving(simulate):
    simulation = simulate(SCENE, sockets=False)
    simulation.context.component("robot.motion").local_data["y"] = 1.0
    return simulation


def upper(eye):
    """Above the ground, away from the border."""
    return eye.local_data["image"][5:40, 10:86]


def test_the_wall_moves_as_the_robot_does(moving):
    eye = moving.context.component("robot.eye")
    moving.sleep(1.0)
    assert eye.local_data["image"].shape == (72, 96, 2)
    # 1 m/s to the left, ten images per second, 5 m to the wall, f = 96 px
    np.testing.assert_allclose(upper(eye)[..., 0], 96 * 0.1 / 5, rtol=0.02)
    np.testing.assert_allclose(upper(eye)[..., 1], 0.0, atol=0.02)


def test_the_first_picture_has_no_flow(simulate):
    simulation = simulate(SCENE, sockets=False)
    simulation.sleep(0.05)
    assert np.abs(upper(simulation.context.component("robot.eye"))).max() < 1e-3


def test_a_restored_run_measures_the_same(moving):
    moving.sleep(0.5)
    state = moving.save()
    moving.sleep(0.3)
    first = moving.context.component("robot.eye").local_data["image"].copy()
    moving.restore(state)
    moving.sleep(0.3)
    np.testing.assert_array_equal(first, moving.context.component("robot.eye").local_data["image"])
    assert np.abs(upper(moving.context.component("robot.eye"))[..., 0]).min() > 0.5
