"""The teleport actuator."""

import math

import pytest

SCENE = """
robot = Morsy()
robot.translate(1, 2, 0)
teleport = Teleport()
robot.append(teleport)
pose = Pose()
robot.append(pose)
env = Environment("empty")
"""


def pose(made):
    data = made.context.component("robot.pose").local_data
    return [data[field] for field in ("x", "y", "z", "yaw", "pitch", "roll")]


def test_it_starts_where_the_robot_is(simulate):
    made = simulate(SCENE, sockets=False)
    made.sleep(0.5)
    assert pose(made) == pytest.approx([1, 2, 0, 0, 0, 0], abs=1e-6)


def test_the_robot_hovers_at_the_pose_asked_for(simulate):
    made = simulate(SCENE, sockets=False)
    made.robot.teleport.publish({"x": -4.0, "y": 3.0, "z": 2.5, "yaw": 1.0, "pitch": 0.2, "roll": -0.1})
    made.sleep(1.0)
    assert pose(made) == pytest.approx([-4.0, 3.0, 2.5, 1.0, 0.2, -0.1], abs=1e-6)


def test_switched_off_it_lets_the_robot_fall(simulate):
    made = simulate(SCENE, sockets=False)
    made.robot.teleport.publish({"z": 2.0})
    made.sleep(0.2)
    made.context.component("robot.teleport").active = False
    made.sleep(2.0)
    assert pose(made)[2] < 0.1


def test_translate_and_rotate_accumulate(simulate):
    made = simulate(SCENE, sockets=False)
    teleport = made.context.component("robot.teleport")
    teleport.translate(1.0, 0.5, 1.0)
    teleport.translate(1.0)
    teleport.rotate(0.0, 0.0, 0.5)
    teleport.rotate(0.0, 0.0, 0.25)
    made.sleep(0.1)
    assert pose(made) == pytest.approx([3.0, 2.5, 1.0, 0.75, 0, 0], abs=1e-6)


def test_a_pose_that_is_no_number_is_ignored(simulate):
    made = simulate(SCENE, sockets=False)
    made.context.component("robot.teleport").local_data["x"] = math.nan
    made.sleep(0.5)
    assert all(math.isfinite(value) for value in pose(made))
