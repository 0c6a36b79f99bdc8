"""Exposure and read-out times of cameras on robots that move."""

import numpy as np
import pytest

SCENE = """
robot = FakeRobot("robot")
robot.translate(z=2)
motion = MotionXYW("motion"); motion.properties(ControlType="Position")
robot.append(motion)
for name, options in dict(sharp={}, blurred=dict(exposure_time=0.05), rolling=dict(readout_time=0.05)).items():
    eye = VideoCamera(name)
    eye.properties(cam_width=64, cam_height=48, cam_focal=32, cam_near=0.3, motion_steps=6, **options)
    eye.frequency(10)
    robot.append(eye)
post = Cube("Post"); post.scale = (0.1, 0.1, 20); post.location = (4, 0, 0)
env = Environment("empty")
"""


@pytest.fixture
def moving(simulate):
    return simulate(SCENE, sockets=False)


def images(simulation):
    return [
        simulation.context.component(f"robot.{name}").local_data["image"].astype(int)
        for name in ("sharp", "blurred", "rolling")
    ]


def test_only_images_of_moving_cameras_are_blurred(moving):
    moving.sleep(0.3)
    sharp, blurred, rolling = images(moving)
    assert np.abs(sharp - blurred).max() <= 1
    assert np.abs(sharp - rolling).max() <= 1
    moving.context.component("robot.motion").local_data["y"] = 2.0
    moving.sleep(0.5)
    sharp, blurred, rolling = images(moving)
    # the upper rows, which are read first, differ most
    assert np.abs(sharp - blurred)[5:20].max() > 20
    assert np.abs(sharp - rolling)[:8].max() > 20
    assert np.abs(sharp - rolling)[46:].mean() < np.abs(sharp - rolling)[:8].mean()


def test_a_restored_run_blurs_the_same(moving):
    moving.context.component("robot.motion").local_data["y"] = 1.0
    moving.sleep(0.3)
    state = moving.save()
    moving.sleep(0.3)
    first = images(moving)
    moving.restore(state)
    moving.sleep(0.3)
    for one, other in zip(first, images(moving), strict=True):
        np.testing.assert_array_equal(one, other)
