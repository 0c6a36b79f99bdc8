"""Links that are brought to poses: where the physics has them, not where the setpoints are."""

import math
from pathlib import Path

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from morse.helpers.inverse_kinematics import Target, reach
from pymorse import MorseServiceFailed
from tests.kit.effort import examples

PICKER = Path(__file__).parents[2] / "examples" / "joints" / "picker.urdf"
SCENE = f"""
from morse.builder import *
picker = Robot(r"{PICKER}")
picker.rotate(z=0.5)
picker.translate(1.0, 2.0, 0.0)
arm = Armature("arm", armature_name="picker_joints")
arm.properties(RotationSpeed=2.0)
picker.append(arm)
env = Environment("empty")
"""
DOWN = [math.pi, 0.0, 0.0]


@pytest.fixture
def sim(simulation):
    """The arm, turned and away from the origin."""
    return simulation


def link(sim, name):
    """The pose of a link."""
    return next(one for one in sim.world.objects() if one.node.plain_name == name).world_pose()


@pytest.mark.parametrize(
    ("position", "orientation"),
    [
        ((1.4, 2.3, 0.3), DOWN),
        ((0.8, 1.6, 0.2), DOWN),
        ((1.2, 1.5, 0.6), [0.0, math.pi / 2, 0.3]),
        ((1.3, 2.4, 0.5), None),
    ],
)
def test_a_link_reaches_a_pose_and_stays_there(sim, position, orientation):
    sim.picker.arm.reach("hand", list(position), orientation).result(30.0)
    for _ in range(2):
        place, rotation = link(sim, "hand")
        assert math.dist(place, position) < 1e-3
        if orientation == DOWN:
            # its Z axis points down
            assert (rotation[2], rotation[5], rotation[8]) == pytest.approx((0.0, 0.0, -1.0), abs=5e-3)
        sim.step(300)


def test_a_point_of_a_link_in_the_frame_of_the_robot(sim):
    sideways = [math.pi, 0.0, 0.5]  # a hand that points straight ahead would be beyond a limit
    sim.picker.arm.reach("hand", [0.4, 0.0, 0.2], sideways, None, [0.0, 0.0, 0.09], "robot").result(30.0)
    place = link(sim, "hand")[0]
    # the point is 9 cm below the hand; the robot is turned by 0.5 rad
    wanted = (1.0 + 0.4 * math.cos(0.5), 2.0 + 0.4 * math.sin(0.5), 0.29)
    assert place == pytest.approx(wanted, abs=1.2e-3)


def test_joint_values_of_a_pose_are_those_of_the_motion(sim):
    goal = [1.4, 2.3, 0.3]
    values = sim.picker.arm.inverse_kinematics("hand", goal, DOWN).result()
    assert set(values) == {"turn", "shoulder", "elbow", "roll", "pitch", "spin"}
    sim.picker.arm.rotate_joints(values).result(30.0)
    assert math.dist(link(sim, "hand")[0], goal) < 0.01


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        # the arm is 0.26 m + 0.36 m + ... high: its hand is at most 0.79 m from the shoulder
        ((["hand", [3.0, 2.0, 0.26]]), r"'hand' cannot reach that pose: the nearest one is 1\.2\d* m away"),
        ((["hand", [1.4, 2.0, 0.3], None, None, None, "robot"]), "cannot reach"),
        ((["hands", [1.4, 2.0, 0.3]]), "there is no link 'hands'; did you mean 'hand'"),
        ((["hand", [1.4, 2.0]]), "position"),
        ((["hand", [1.4, 2.0, 0.3], None, None, None, "tool"]), "frame"),
    ],
)
def test_what_cannot_be_reached_is_refused_and_nothing_moves(sim, arguments, message):
    before = link(sim, "hand")[0]
    with pytest.raises(MorseServiceFailed, match=message):
        sim.picker.arm.reach(*arguments).result(1.0)
    sim.step(30)
    assert math.dist(link(sim, "hand")[0], before) < 1e-3


def test_a_motion_that_the_ground_stops_fails(sim):
    # the fingers are 11 cm long
    with pytest.raises(MorseServiceFailed, match=r"GOAL_TOLERANCE_VIOLATED: the link is 0\.0\d+ m away"):
        sim.picker.arm.reach("hand", [1.4, 2.2, 0.08], DOWN).result(60.0)


def test_fingers_keep_their_commands_while_the_arm_moves(sim):
    sim.picker.arm.publish({"left": 0.02, "right": 0.03})
    sim.picker.arm.reach("hand", [1.4, 2.3, 0.3]).result(30.0)
    values = sim.context.component("picker.arm").joint_values
    assert values[6:] == pytest.approx([0.02, 0.03], abs=1e-3)


def test_another_command_preempts_it_and_the_arm_stops(sim):
    from pymorse import MorseServicePreempted

    motion = sim.picker.arm.reach("hand", [0.8, 1.6, 0.2], DOWN)
    sim.step(20)
    sim.picker.arm.rotate("spin", 0.1)
    with pytest.raises(MorseServicePreempted):
        motion.result(1.0)
    sim.step(120)
    before = link(sim, "hand")[0]
    sim.step(60)
    assert math.dist(link(sim, "hand")[0], before) < 1e-3


def test_an_arm_without_masses_reaches_a_pose(simulate):
    sim = simulate("robot = FakeRobot()\narm = KukaLWR()\nrobot.append(arm)", sockets=False)
    sim.step(2)
    names = sim.robot.arm.get_links().result()
    sim.robot.arm.reach(names[-1], [0.4, 0.3, 0.6]).result(30.0)
    assert math.dist(link(sim, names[-1])[0], (0.4, 0.3, 0.6)) < 1e-3


@pytest.mark.long
@given(shares=st.lists(st.floats(0.0, 1.0), min_size=6, max_size=6))
@example(shares=[0.0, 0.0, 0.0, 0.0, 1.0, 0.0])  # all joints at their limits
@settings(max_examples=examples(60), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_every_pose_of_the_hand_is_found(loaded, shares):
    chain = loaded.context.component("picker.arm").chain
    values = [low + share * (high - low) for share, (_, low, high) in zip(shares, chain.limits[:6], strict=True)]
    bone = chain.index("spin")
    position, rotation = chain.frames([*values, 0.0, 0.0])[bone]
    target = Target(bone, (position, rotation), 0.3, ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)))
    nearby = reach(chain, target, [0.02] * 8)
    place, _ = chain.frames(nearby.values)[bone]
    assert math.dist(place, position) <= 1e-4
    assert all(low <= value <= high for value, (_, low, high) in zip(nearby.values, chain.limits, strict=True))
