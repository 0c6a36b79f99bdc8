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
    data = made["robot.pose"].local_data
    return [data[field] for field in ("x", "y", "z", "yaw", "pitch", "roll")]


def test_it_starts_where_the_robot_is(rig):
    made = rig(SCENE)
    made.run(0.5)
    assert pose(made) == pytest.approx([1, 2, 0, 0, 0, 0], abs=1e-6)


def test_the_robot_hovers_at_the_pose_asked_for(rig):
    made = rig(SCENE)
    made.command("robot.teleport", x=-4.0, y=3.0, z=2.5, yaw=1.0, pitch=0.2, roll=-0.1)
    made.run(1.0)
    assert pose(made) == pytest.approx([-4.0, 3.0, 2.5, 1.0, 0.2, -0.1], abs=1e-6)


def test_switched_off_it_lets_the_robot_fall(rig):
    made = rig(SCENE)
    made.command("robot.teleport", z=2.0)
    made.run(0.2)
    made["robot.teleport"].active = False
    made.run(2.0)
    assert pose(made)[2] < 0.1


def test_translate_and_rotate_accumulate(rig):
    made = rig(SCENE)
    teleport = made["robot.teleport"]
    teleport.translate(1.0, 0.5, 1.0)
    teleport.translate(1.0)
    teleport.rotate(0.0, 0.0, 0.5)
    teleport.rotate(0.0, 0.0, 0.25)
    made.run(0.1)
    assert pose(made) == pytest.approx([3.0, 2.5, 1.0, 0.75, 0, 0], abs=1e-6)


def test_a_pose_that_is_no_number_is_ignored(rig):
    made = rig(SCENE)
    made.command("robot.teleport", x=math.nan)
    made.run(0.5)
    assert all(math.isfinite(value) for value in pose(made))
