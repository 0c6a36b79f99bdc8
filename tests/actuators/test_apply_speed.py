"""Actuators of users drive their robot by ``apply_speed``, as those of 1.4 do."""

import math

import pytest

SCENE = """
robot = ATRV()
robot.rotate(z=1.5707963267948966)
own = Light()
robot.append(own)
pose = Pose()
robot.append(pose)
"""


@pytest.mark.parametrize("kind", ["Position", "Velocity"])
def test_an_actuator_drives_its_robot_along_the_axes_of_the_robot(simulate, kind):
    sim = simulate(SCENE, sockets=False)
    actuator = sim.context.component("robot.own")
    for _ in range(60):
        actuator.apply_speed(kind, [0.5, 0.0, 0.0], [0.0, 0.0, 0.2])
        sim.step()
    pose = sim.robot.pose.data
    # an arc of 0.5 m with a radius of 2.5 m, to the left of a robot that faces Y
    assert [pose["x"], pose["y"]] == pytest.approx([-2.5 * (1 - math.cos(0.2)), 2.5 * math.sin(0.2)], abs=0.01)
    assert pose["yaw"] == pytest.approx(math.pi / 2 + 0.2, abs=0.01)
