"""Angles of a pan-tilt unit after commands."""

import math

import pytest

from morse.core.kinds import bind

SCRIPT = """
from morse.builder import *
robot = ATRV()
robot.rotate(0, 0, 0.7)
ptu = PTU()
ptu.translate(0.2, 0.0, 0.9)
robot.append(ptu)
{before}
posture = PTUPosture()
{carrier}.append(posture)
{more}
env = Environment("empty", fastmode=True)
"""


@pytest.fixture
def load(load):
    return lambda carrier="ptu", before="", more="": load(SCRIPT.format(carrier=carrier, before=before, more=more))


def test_the_angles_that_it_was_told(load):
    simulation = load()
    simulation.robot.ptu.publish({"pan": 0.5, "tilt": -0.25})
    simulation.step(15)
    # a quarter of a second at 1 rad/s
    assert simulation.robot.ptu.posture.data["pan"] == pytest.approx(0.25, abs=0.02)
    simulation.step(60)
    posture = simulation.robot.ptu.posture.data
    assert (posture["pan"], posture["tilt"]) == pytest.approx((0.5, -0.25), abs=1e-6)
    message = bind(simulation.context.components["robot.ptu.posture"])[0].gather()
    assert message.names == ("pan", "tilt")
    assert message.position == pytest.approx([0.5, -0.25], abs=1e-6)


def test_angles_stay_within_half_a_turn(load):
    simulation = load()
    simulation.robot.ptu.publish({"pan": 3.0, "tilt": 0.0})
    simulation.step(200)
    simulation.robot.ptu.publish({"pan": 3.5, "tilt": 0.0})
    simulation.step(60)
    assert simulation.robot.ptu.posture.data["pan"] == pytest.approx(3.5 - 2 * math.pi, abs=1e-6)


def test_on_something_that_the_unit_carries(load):
    simulation = load("eye", before="eye = Pose()", more="ptu.append(eye)")
    simulation.robot.ptu.publish({"pan": 0.2, "tilt": 0.1})
    simulation.step(60)
    data = simulation.context.components["robot.ptu.eye.posture"].local_data
    assert (data["pan"], data["tilt"]) == pytest.approx((0.2, 0.1), abs=1e-6)


def test_without_a_unit(load):
    with pytest.raises(Exception, match="it measures a pan-tilt unit: append it to a pan-tilt unit"):
        load("robot")
