"""The segments of a PA-10 arm, against rotations computed by hand."""

import math

import numpy as np
import pytest
from arms import tip_of

from pymorse import MorseServiceFailed

SCENE = """
robot = FakeRobot()
arm = PA10()
{more}
robot.append(arm)
hand = Pose()
arm.append(hand, 'PA10-6')
"""
#: heights of the joints, m, and the axes of the six segments
HEIGHTS = (0.0, 0.317, 0.767, 1.1, 1.25, 1.34)
AXES = "zyyzyz"


def hand_of(angles):
    """4x4 of the last segment: the product of the rotations, each at its height."""
    result, below = np.eye(4), 0.0
    for height, axis, angle in zip(HEIGHTS, AXES, angles, strict=True):
        step = np.eye(4)
        step[2, 3] = height - below
        c, s = math.cos(angle), math.sin(angle)
        step[:3, :3] = [[c, -s, 0], [s, c, 0], [0, 0, 1]] if axis == "z" else [[c, 0, s], [0, 1, 0], [-s, 0, c]]
        result, below = result @ step, height
    return result


def load(simulate, more=""):
    sim = simulate(SCENE.format(more=more), sockets=False)
    sim.step(2)
    return sim


def assert_hand(sim, angles):
    hand = sim.context.component("robot.arm.hand").bge_object
    wanted = hand_of(angles)
    assert list(hand.worldPosition) == pytest.approx(wanted[:3, 3].tolist(), abs=1e-4)
    assert np.allclose([list(row) for row in hand.worldOrientation], wanted[:3, :3], atol=1e-6)


@pytest.mark.parametrize(
    "angles",
    [
        [0.0] * 6,
        [0.0, math.pi / 2, 0.0, 0.0, 0.0, 0.0],
        [0.5, -0.4, 1.1, -2.0, 0.7, 3.0],
    ],
)
def test_the_hand_is_where_the_segments_put_it(simulate, angles):
    sim = load(simulate)
    assert sim.robot.arm.set_rotation_array(*angles).result() is None
    sim.step(200)
    assert_hand(sim, angles)


def test_each_segment_turns_at_the_speed(simulate):
    sim = load(simulate, "arm.properties(Speed=0.5)")
    sim.robot.arm.publish({"seg1": 1.0, "seg4": 0.25})
    sim.step(61)
    hand = sim.context.component("robot.arm").joint_values
    assert hand[1] == pytest.approx(0.5, abs=0.02)
    assert hand[4] == pytest.approx(0.25)
    sim.step(61)
    assert_hand(sim, [0.0, 1.0, 0.0, 0.0, 0.25, 0.0])


def test_an_angle_within_the_tolerance_turns_nothing(simulate):
    sim = load(simulate)
    sim.robot.arm.publish({"seg0": math.radians(4.0)})
    sim.step(30)
    assert_hand(sim, [0.0] * 6)
    sim.robot.arm.set_property("Tolerance", 0.0).result()
    sim.step(30)
    assert_hand(sim, [math.radians(4.0), 0.0, 0.0, 0.0, 0.0, 0.0])


def test_mistakes_fail(simulate):
    sim = load(simulate)
    with pytest.raises(MorseServiceFailed, match="seg1"):
        sim.robot.arm.set_rotation_array(0.0, "up").result()
    with pytest.raises(ValueError, match="seg2"):
        sim.robot.arm.publish({"seg2": math.nan})
    sim.step(30)
    assert_hand(sim, [0.0] * 6)


def test_saved_restored_and_restarted(simulate):
    sim = load(simulate)
    sim.robot.arm.set_rotation_array(2.0, 1.0).result()
    sim.step(40)
    state = sim.save()
    sim.step(40)
    there = sim.robot.arm.hand.get()
    sim.restore(state)
    sim.step(40)
    assert sim.robot.arm.hand.get() == there
    sim.restart()
    sim.step(2)
    assert_hand(sim, [0.0] * 6)


# -- an arm that is mounted on the tip of another arm: both move its links -------------------------

ARM_ON_ARM_SCENE = """
robot = FakeRobot()
lower = KukaLWR()
robot.append(lower)
upper = KukaLWR()
lower.append(upper)
tip = Pose()
upper.append(tip)
"""


@pytest.mark.parametrize("first", ["lower", "upper"])
def test_the_tip_is_where_both_arms_put_it(simulate, first):
    sim = simulate(ARM_ON_ARM_SCENE, sockets=False)
    arms = {"lower": sim.context.component("robot.lower"), "upper": sim.context.component("robot.lower.upper")}
    angles = {"lower": [0.3, -0.7, 0.2, 0.9, -0.4, 0.5, 0.1], "upper": [-0.5, 0.4, 0.8, -0.6, 0.3, 0.2, -0.9]}
    for name in sorted(arms, key=lambda name: name != first):
        arms[name].local_data.update(zip(arms[name].joints, angles[name], strict=True))
        sim.step(90)
    for _ in range(3):
        # both at once
        for name, arm in arms.items():
            angles[name] = [angle * 0.9 for angle in angles[name]]
            arm.local_data.update(zip(arm.joints, angles[name], strict=True))
        sim.step(20)
    assert arms["upper"].joint_values == pytest.approx(angles["upper"])
    placed = tip_of(angles["lower"]) @ tip_of(angles["upper"])
    tip = sim.context.component("robot.lower.upper.tip").local_data
    assert [tip[axis] for axis in "xyz"] == pytest.approx(placed[:3, 3].tolist(), abs=2e-3)
    assert np.linalg.norm(placed[:3, 3]) > 1.0
