"""Rotating depth cameras, and aggregated ones: walls at known distances."""

import math

import numpy as np
import pytest

#: walls whose near faces are 3 m ahead of the origin and 5 m to the left of it
SCENE = """
from morse.builder import *
robot = FakeRobot()
robot.translate(z=4.0)
{body}
for name, place, half in (("ahead", (3.5, 0, 1), (0.5, 9, 9)), ("left", (0, 5.5, 1), (9, 0.5, 9))):
    wall = Cube(name)
    wall.location, wall.scale = place, half
env = Environment("empty")
"""
CAMERA = """
camera = {name}()
camera.properties(cam_width=32, cam_height=24, cam_near=0.1, cam_far=20.0{more})
camera.frequency(60)
robot.append(camera)
"""


@pytest.fixture
def load(load):
    return lambda body: load(SCENE.format(body=body))


def test_a_camera_that_turns_a_quarter_sees_the_wall_on_the_left(load):
    simulation = load(CAMERA.format(name="DepthCameraRotationZ", more=f", rotation={math.pi / 2}"))
    simulation.step()
    assert np.median(simulation.robot.camera.data["points"][:, 2]) == pytest.approx(3.0, abs=1e-3)
    simulation.step()
    assert np.median(simulation.robot.camera.data["points"][:, 2]) == pytest.approx(5.0, abs=1e-3)


@pytest.mark.parametrize("name", ["Velodyne", "VelodyneZB"])
def test_velodynes_go_round_in_their_steps(load, name):
    simulation = load(CAMERA.format(name=name, more=""))
    camera = simulation.context.component("robot.camera")

    def heading():
        """Along the optical axis, which is Z of the camera."""
        rotation = camera.bge_object.world_pose()[1]
        return math.atan2(rotation[5], rotation[2])

    before = heading()
    simulation.step(3)
    # the step of the script of 1.4: 0.8578 rad after each image, to the left
    assert math.remainder(heading() - before - 3 * 0.8578, math.tau) == pytest.approx(0.0, abs=1e-6)


def test_clouds_are_joined_in_the_frame_of_the_master(load):
    cameras = "".join(
        f"""
{name} = DepthCamera()
{name}.properties(cam_width=32, cam_height=24, cam_near=0.1, cam_far=20.0)
{name}.frequency(60)
{name}.rotate(x={turn})
whole.append({name})
"""
        for name, turn in (("front", 0.0), ("side", math.pi / 2))
    )
    body = f"""
whole = DepthCameraAggregator()
whole.properties(master_camera="front")
whole.frequency(60)
robot.append(whole)
{cameras}
"""
    simulation = load(body)
    simulation.step(2)
    data = simulation.robot.whole.data
    points = np.asarray(data["points"]).reshape(-1, 3)
    assert data["nb_points"] == len(points) == 2 * 32 * 24
    ahead, left = points[:768], points[768:]
    # Z forward: the wall ahead; X to the right: the wall on the left
    assert ahead[:, 2] == pytest.approx(3.0, abs=1e-3)
    assert left[:, 0] == pytest.approx(-5.0, abs=1e-3)
