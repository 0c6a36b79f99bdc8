"""Robots without ground contact have their centre of mass at their origin, as in 1.4, where Bullet puts it."""

import math

import pytest

SCENE = """
robot = RMax()
robot.translate(10, 8, 20)
robot._bpy_object.game.damping = 0.5
motion = ForceTorque()
robot.append(motion)
pose = Pose()
robot.append(pose)
"""


def test_neither_force_nor_damping_turns_a_robot_that_is_pushed(simulate):
    sim = simulate(SCENE, sockets=False)
    sim.robot.motion.publish({"force": [2.0, 0.0, 0.0]})
    sim.step(120)
    # 1 kg that loses half of its velocity per second: x'' = 2 - ln(2) x'
    rate = math.log(2.0)
    away = 2.0 / rate * (2.0 - (1.0 - math.exp(-2.0 * rate)) / rate)
    pose = sim.robot.pose.data
    assert pose["x"] == pytest.approx(10.0 + away, abs=0.03)
    assert [pose[name] for name in ("y", "z", "yaw", "pitch", "roll")] == pytest.approx([8.0, 20.0, 0, 0, 0], abs=1e-6)


def test_a_torque_turns_a_robot_on_the_spot(simulate):
    sim = simulate(SCENE, sockets=False)
    sim.robot.motion.publish({"torque": [0.0, 0.0, 0.5]})
    sim.step(60)
    pose = sim.robot.pose.data
    assert pose["yaw"] > 0.1
    assert [pose[name] for name in ("x", "y", "z")] == pytest.approx([10.0, 8.0, 20.0], abs=1e-6)


BARE = """
robot = Robot()
body = Cube("body")
body.scale = (0.5, 0.5, 0.5)
body.translate(x={x}, z=0.3)
robot.append(body)
robot.set_rigid_body()
robot.set_collision_bounds()
body._bpy_object.game.physics_type = "STATIC"
"""


@pytest.mark.parametrize(("x", "centre"), [(0.2, (0.0, 0.0, 0.0)), (2.0, (2.0, 0.0, 0.0))])
def test_an_origin_outside_the_body_is_no_centre_of_mass(simulate, x, centre):
    sim = simulate(BARE.format(x=x), sockets=False)
    found = {name: place for name, _, place in sim.context.world.mass_centres()}["robot"]
    assert found == pytest.approx(centre, abs=1e-6)
