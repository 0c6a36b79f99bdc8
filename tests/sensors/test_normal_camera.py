"""Normals of a wall that a robot looks at."""

import math

import numpy as np

SCENE = """
robot = FakeRobot("robot")
robot.translate(z=2)
robot.rotate(z=0.3)
eye = NormalCamera("eye")
eye.properties(cam_width=32, cam_height=24, cam_focal=32, cam_near=0.3)
robot.append(eye)
wall = Cube("Wall"); wall.scale = (0.1, 20, 20); wall.location = (5.1, 0, 0)
env = Environment("empty")
"""


def test_normals_are_given_in_the_frame_of_the_camera(simulate):
    simulation = simulate(SCENE, sockets=False)
    simulation.sleep(0.1)
    image = simulation.context.component("robot.eye").local_data["image"]
    assert image.shape == (24, 32, 3)
    # the robot is turned to the left by 0.3 rad; the normal of the wall points along -X of the world
    np.testing.assert_allclose(image[2, 16], (-math.sin(0.3), 0.0, -math.cos(0.3)), atol=1e-5)
