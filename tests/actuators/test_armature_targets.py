"""Inverse kinematics of an arm: the inverse of forward kinematics."""

import math
import random

import numpy as np
import pytest
from arms import TARGET, TIP, load, place, tip_of, values

from morse.mathutils import Matrix
from pymorse import MorseServiceFailed, MorseServicePreempted

#: a target has its Y axis along the bone and its X axis along -X of the upright arm
BONE = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])


def euler_of(angles):
    return list(Matrix((tip_of(angles)[:3, :3] @ BONE).tolist()).to_euler())


def test_the_last_bone_has_a_target(simulate):
    sim = load(simulate)
    assert sim.robot.arm.list_IK_targets().result() == [TARGET]
    assert TARGET in sim.context.world.objects_by_name


def test_a_target_lays_the_arm_down(simulate):
    sim = load(simulate)
    sim.robot.arm.place_IK_target(TARGET, [0.0, 0.0, 2.0], None, False).result()
    sim.step(60)
    assert values(sim) == pytest.approx([0.0] * 7, abs=0.01)
    sim.robot.arm.place_IK_target(TARGET, [1.0, 0.0, 0.3105], [math.pi / 2, -math.pi / 2, -math.pi], False).result()
    sim.step(60)
    assert values(sim) == pytest.approx([0.0, -math.pi / 2, 0.0, 0.0, 0.0, 0.0, 0.0], abs=0.05)
    assert place(sim) == pytest.approx([1.0, 0.0, 0.3105], abs=1e-3)


def test_targets_within_reach_are_reached(simulate):
    sim = load(simulate)
    draw = random.Random(7)
    for _ in range(12):
        angles = [draw.uniform(-2.0, 2.0) for _ in range(7)]
        wanted = tip_of(angles)
        sim.robot.arm.place_IK_target(TARGET, wanted[:3, 3].tolist(), euler_of(angles), False).result()
        sim.step(200)
        found = values(sim)
        assert place(sim) == pytest.approx(wanted[:3, 3].tolist(), abs=1e-3)
        # forward kinematics of the joint angles gives the target pose
        assert np.allclose(tip_of(found), wanted, atol=2e-3)
        assert all(abs(v) <= math.radians(170 if i % 2 == 0 else 120) + 1e-6 for i, v in enumerate(found))


def test_an_arm_that_is_stretched_finds_its_way_inward(simulate):
    # straight below the tip: a singular configuration
    sim = load(simulate)
    sim.robot.arm.place_IK_target(TARGET, [0.0, 0.0, -0.3]).result()
    sim.step(200)
    assert place(sim) == pytest.approx([0.0, 0.0, TIP - 0.3], abs=1e-3)


def test_out_of_reach_it_points_there_and_rests(simulate):
    sim = load(simulate)
    sim.robot.arm.place_IK_target(TARGET, [3.0, 0.0, 0.3105], [math.pi / 2, -math.pi / 2, -math.pi], False).result()
    sim.step(300)
    assert place(sim) == pytest.approx([1.0, 0.0, 0.3105], abs=0.01)
    here = values(sim)
    sim.step(120)
    assert values(sim) == pytest.approx(here, abs=1e-6)


def test_out_of_reach_it_keeps_the_orientation_of_the_target(simulate):
    # MORSE 1.4 ends here
    sim = load(simulate)
    sim.robot.arm.place_IK_target(TARGET, [1.0, 0.0, 0.3105], None, False).result()
    sim.step(120)
    assert place(sim) == pytest.approx([0.778, 0.0, 0.363], abs=0.02)
    upright = tip_of(values(sim))[:3, 2]
    assert math.asin(upright[0]) == pytest.approx(0.02, abs=0.01)


@pytest.mark.parametrize("angle", [0.0, 1.2, -2.4])
def test_out_of_reach_it_keeps_the_orientation_in_every_direction(simulate, angle):
    sim = load(simulate)
    far = [2.0 * math.cos(angle), 2.0 * math.sin(angle), 0.6]
    sim.robot.arm.place_IK_target(TARGET, far, None, False).result()
    sim.step(300)
    x, y, _ = place(sim)
    assert math.atan2(y, x) == pytest.approx(angle, abs=0.02)
    assert tip_of(values(sim))[2, 2] > math.cos(0.15)


def test_a_target_moves_at_its_speed(simulate):
    sim = load(simulate)
    arm = sim.robot.arm
    arm.set_rotations([0.0, -0.8, 0.0, 1.2, 0.0, 0.5, 0.0]).result()
    start = tip_of([0.0, -0.8, 0.0, 1.2, 0.0, 0.5, 0.0])
    arm.place_IK_target(TARGET, start[:3, 3].tolist(), euler_of([0.0, -0.8, 0.0, 1.2, 0.0, 0.5, 0.0]), False).result()
    sim.step(60)
    before, began = place(sim), sim.time()
    arm.move_IK_target(TARGET, [0.0, 0.1, -0.2], None, True, 0.1).result(10.0)
    assert sim.time() - began == pytest.approx(math.hypot(0.1, 0.2) / 0.1, abs=0.1)
    assert place(sim) == pytest.approx([before[0], before[1] + 0.1, before[2] - 0.2], abs=2e-3)
    began = sim.time()
    arm.move_IK_target(TARGET, [0.0, 0.0, 0.0], [0.0, 0.0, 0.4], True, None, 0.2).result(10.0)
    assert sim.time() - began == pytest.approx(2.0, abs=0.1)


def test_a_joint_that_is_told_where_to_be_ends_the_following(simulate):
    sim = load(simulate)
    sim.robot.arm.place_IK_target(TARGET, [0.5, 0.0, 0.8], None, False).result()
    sim.step(60)
    sim.robot.arm.set_rotations([0.0] * 7).result()
    sim.step(60)
    assert values(sim) == [0.0] * 7
    sim.robot.arm.place_IK_target(TARGET, [0.0, 0.0, 0.01]).result()
    sim.step(5)
    assert values(sim) != [0.0] * 7
    sim.robot.arm.publish(dict.fromkeys((f"kuka_{i}" for i in range(1, 8)), 0.0))
    sim.step(300)
    assert values(sim) == pytest.approx([0.0] * 7)


def test_a_moving_target_is_preempted_and_cancelled(simulate):
    sim = load(simulate)
    first = sim.robot.arm.move_IK_target(TARGET, [0.3, 0.0, -0.5])
    sim.step(10)
    second = sim.robot.arm.move_IK_target(TARGET, [0.0, 0.3, 0.0])
    with pytest.raises(MorseServicePreempted):
        first.result(1.0)
    sim.step(10)
    second.cancel()
    with pytest.raises(MorseServicePreempted):
        second.result(1.0)
    sim.step(200)
    here = values(sim)
    sim.step(60)
    assert values(sim) == pytest.approx(here, abs=1e-6)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["ik_target.robot.arm.kuka_6", [0, 0, 0]], r"no target.*did you mean"),
        ([TARGET, [0, 0]], r"3 numbers"),
        ([TARGET, [math.nan, 0, 0]], r"translation"),
        ([TARGET, [0, 0, 0], [0, 0]], r"3 numbers"),
        ([TARGET, [0, 0, 1e30]], r"translation"),
        ([TARGET, [0, 0, 0], None, "yes"], r"boolean"),
    ],
)
@pytest.mark.parametrize("service", ["place_IK_target", "move_IK_target"])
def test_mistakes_fail(simulate, service, arguments, words):
    sim = load(simulate)
    with pytest.raises(MorseServiceFailed, match=words):
        getattr(sim.robot.arm, service)(*arguments).result(1.0)
    assert values(sim) == [0.0] * 7


def test_the_same_targets_give_the_same_bits(simulate):
    results = []
    for _ in range(2):
        sim = load(simulate)
        sim.robot.arm.place_IK_target(TARGET, [0.3, 0.4, 0.6], [1.0, 0.2, 0.3], False).result()
        sim.step(100)
        results.append((values(sim), sim.state_hash()))
    assert results[0] == results[1]


def test_following_goes_on_after_a_restored_state(simulate):
    sim = load(simulate)
    sim.robot.arm.place_IK_target(TARGET, [0.3, 0.4, 0.6], [1.0, 0.2, 0.3], False).result()
    sim.step(7)
    state = sim.save()
    sim.step(100)
    there = values(sim)
    sim.restore(state)
    sim.step(100)
    assert values(sim) == there
