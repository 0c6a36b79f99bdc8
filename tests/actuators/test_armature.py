"""Joints of an arm: forward kinematics from the lengths of its links, speeds, limits, services."""

import math

import numpy as np
import pytest
from arms import SCENE, TIP, load, place, tip_of, values

from pymorse import MorseServiceFailed, MorseServicePreempted

NAMES = [f"kuka_{i}" for i in range(1, 8)]


@pytest.mark.parametrize(
    "angles",
    [
        [0.0, -math.pi / 2, 0.0, 0.0, 0.0, 0.0, 0.0],
        [math.pi / 2, -math.pi / 2, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 1.2, 0.0, 0.0, 0.0],
        [0.3, -0.5, 0.7, 1.1, -0.9, 0.4, 2.0],
        [-2.9, 2.0, 2.5, -1.7, 1.3, -2.0, -1.0],
    ],
)
def test_the_tip_is_where_the_links_put_it(simulate, angles):
    sim = load(simulate)
    assert sim.robot.arm.set_rotations(angles).result() is None
    sim.step(2)
    assert values(sim) == pytest.approx(angles)
    data = sim.robot.arm.tip.get()
    wanted = tip_of(angles)
    assert [data["x"], data["y"], data["z"]] == pytest.approx(wanted[:3, 3].tolist(), abs=2e-5)
    tip = sim.context.component("robot.arm.tip").bge_object
    assert np.allclose([list(row) for row in tip.worldOrientation], wanted[:3, :3], atol=1e-4)


def test_a_joint_lays_the_arm_down(simulate):
    # the values that scripts rely on: 1 m ahead at the height of the second joint
    sim = load(simulate)
    assert place(sim) == pytest.approx([0.0, 0.0, TIP], abs=1e-4)
    sim.robot.arm.set_rotation("kuka_2", -math.pi / 2).result()
    assert place(sim) == pytest.approx([1.0, 0.0, 0.3105], abs=1e-4)


def test_what_is_appended_keeps_its_place_on_the_stretched_arm(simulate):
    sim = load(simulate, more="hand = Pose('hand')\nhand.translate(x=0.1, z=1.28)\narm.append(hand)")
    sim.robot.arm.set_rotation("kuka_2", -math.pi / 2).result()
    sim.step(3)
    data = sim.robot.arm.hand.get()
    # 1.28 m up and 0.1 m ahead become 1.28 - 0.3105 ahead of the second joint, and 0.1 down
    assert [data["x"], data["z"]] == pytest.approx([0.9695, 0.2105], abs=1e-4)


def test_an_arm_on_a_turned_robot_that_moves(simulate):
    before = "robot.translate(2.0, 3.0, 0.5)\nrobot.rotate(z=1.5707963)\nport = Teleport()\nrobot.append(port)"
    sim = load(simulate, before=before, more="arm.translate(x=0.2)")
    sim.robot.arm.set_rotation("kuka_2", -math.pi / 2).result()
    assert place(sim) == pytest.approx([2.0, 3.0 + 0.2 + 1.0, 0.8105], abs=1e-4)
    sim.robot.port.publish({"x": -1.0, "y": 0.0, "z": 0.0, "yaw": 0.0})
    assert place(sim) == pytest.approx([0.2, 0.0, 0.3105], abs=1e-4)


def test_joints_step_at_their_speed(simulate):
    sim = load(simulate, more="arm.properties(RotationSpeed=0.5)")
    sim.robot.arm.publish({"kuka_2": 1.0, "kuka_4": -0.25})
    sim.step(60)
    angles = values(sim)
    assert angles[1] == pytest.approx(0.5, abs=0.03)
    assert angles[3] == pytest.approx(-0.25)
    sim.step(70)
    assert values(sim) == pytest.approx([0.0, 1.0, 0.0, -0.25, 0.0, 0.0, 0.0])


def test_limits_are_kept(simulate):
    sim = load(simulate)
    arm = sim.robot.arm
    assert arm.get_IK_limits("kuka_1").result() == pytest.approx([-math.radians(170), math.radians(170)], abs=1e-4)
    assert arm.get_IK_limits("kuka_2").result() == pytest.approx([-math.radians(120), math.radians(120)], abs=1e-4)
    arm.set_rotation("kuka_2", 3.0).result()
    assert values(sim)[1] == pytest.approx(math.radians(120), abs=1e-4)
    # a service with a target beyond the limit ends at the limit
    arm.rotate("kuka_1", -5.0, 10.0).result(5.0)
    assert values(sim)[0] == pytest.approx(-math.radians(170), abs=1e-4)
    arm.publish({"kuka_4": 100.0})
    sim.step(300)
    assert values(sim)[3] == pytest.approx(math.radians(120), abs=1e-4)


def test_what_it_says_of_its_joints(simulate):
    sim = load(simulate)
    arm, joints = sim.robot.arm, sim.robot.arm.joints
    assert arm.get_joints().result() == NAMES == joints.get_joints().result()
    assert arm.get_dofs().result() == {
        name: [0, 1, 0] if number % 2 else [0, 0, 1] for number, name in enumerate(NAMES, 1)
    }
    lengths = [0.3105, 0.2, 0.2, 0.2, 0.19, 0.078, 0.132]
    assert joints.get_joints_length().result() == pytest.approx(dict(zip(NAMES, lengths, strict=True)), abs=1e-6)
    arm.set_rotations([0.1, 0.2, 0.3]).result()
    sim.step(2)
    assert joints.get_state().result() == pytest.approx(
        dict(zip(NAMES, [0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 0.0], strict=True))
    )
    assert joints.get_joint("kuka_3").result() == pytest.approx(0.3)
    assert list(joints.get()) == ["timestamp", *NAMES]


def test_a_rotation_takes_its_time(simulate):
    sim = load(simulate)
    began = sim.time()
    sim.robot.arm.rotate("kuka_2", 0.8).result(5.0)
    # 0.8 rad at 0.8 rad/s; it ends within the tolerance of 0.01 rad
    assert sim.time() - began == pytest.approx(1.0, abs=0.05)
    assert values(sim)[1] == pytest.approx(0.8)
    began = sim.time()
    sim.robot.arm.rotate_joints({"kuka_1": 1.0, "kuka_2": -0.2}, 2.0).result(5.0)
    assert sim.time() - began == pytest.approx(0.5, abs=0.05)
    assert values(sim)[:2] == pytest.approx([1.0, -0.2])


def test_no_joint_at_all_is_done_at_once(simulate):
    sim = load(simulate)
    assert sim.robot.arm.rotate_joints({}).result(1.0) is None


def test_a_new_call_preempts_and_a_cancelled_one_stays(simulate):
    sim = load(simulate)
    first = sim.robot.arm.rotate("kuka_1", 2.0)
    sim.step(30)
    second = sim.robot.arm.rotate("kuka_2", 1.0)
    with pytest.raises(MorseServicePreempted):
        first.result(1.0)
    sim.step(15)
    second.cancel()
    with pytest.raises(MorseServicePreempted):
        second.result(1.0)
    here = values(sim)
    sim.step(60)
    assert values(sim) == pytest.approx(here)
    assert 0.3 < here[0] < 0.5
    assert 0.1 < here[1] < 0.3


def test_a_joint_that_is_put_somewhere_preempts_what_turns_it(simulate):
    sim = load(simulate)
    turning = sim.robot.arm.rotate("kuka_1", 2.0)
    sim.step(10)
    sim.robot.arm.set_rotation("kuka_3", 0.5).result()
    sim.step(10)
    assert not turning.done()
    sim.robot.arm.set_rotation("kuka_1", 0.5).result()
    with pytest.raises(MorseServicePreempted):
        turning.result(1.0)
    assert values(sim)[::2] == pytest.approx([0.5, 0.5, 0.0, 0.0])


@pytest.mark.parametrize(
    ("service", "arguments", "words"),
    [
        ("set_rotation", ["kuka_9", 0.0], r"no joint 'kuka_9'"),
        ("set_translation", ["kuka_1", 0.0], r"'kuka_1' is a revolute joint"),
        ("set_translations", [[0.1]], r"revolute"),
        ("rotate", ["elbow", 0.0], r"no joint 'elbow'.*kuka_1"),
        ("translate", ["kuka_1", 0.1], r"revolute"),
        ("translate_joints", [{"kuka_1": 0.1}], r"revolute"),
        ("rotate_joints", [{"kuka_1": "far"}], r"rotation of 'kuka_1'"),
        ("rotate_joints", [{"kuka_1": math.nan}], r"rotation"),
        ("rotate_joints", [[0.1]], r"object"),
        ("rotate", ["kuka_1", math.inf], r"rotation"),
        ("rotate", ["kuka_1", 1.0, -1.0], r"from 0"),
        ("get_IK_limits", ["shoulder"], r"no joint 'shoulder'"),
        ("set_rotations", [["a"]], r"rotations"),
    ],
)
def test_mistakes_fail_and_move_nothing(simulate, service, arguments, words):
    sim = load(simulate)
    with pytest.raises(MorseServiceFailed, match=words):
        getattr(sim.robot.arm, service)(*arguments).result(1.0)
    assert values(sim) == [0.0] * 7


def test_an_unknown_joint_of_the_pose_fails(simulate):
    sim = load(simulate)
    with pytest.raises(MorseServiceFailed, match=r"no joint 'kuka_8'"):
        sim.robot.arm.joints.get_joint("kuka_8").result()


def test_commands_that_are_no_numbers_are_refused(simulate):
    sim = load(simulate)
    for wrong in ({"kuka_2": "up"}, {"kuka_2": math.nan}, {"kuka_2": None}, {"kuka_2": 1e300}):
        with pytest.raises(ValueError, match="kuka_2"):
            sim.robot.arm.publish(wrong)
    sim.step(60)
    assert values(sim) == [0.0] * 7


def test_more_numbers_than_joints_are_left_out(simulate):
    sim = load(simulate)
    sim.robot.arm.set_rotations([0.1] * 12).result()
    assert values(sim) == pytest.approx([0.1] * 7)


def test_saved_restored_and_restarted(simulate):
    sim = load(simulate)
    sim.robot.arm.publish({"kuka_1": 2.0, "kuka_2": 0.5})
    sim.step(30)
    state = sim.save()
    sim.step(30)
    later, there = values(sim), place(sim)
    sim.restore(state)
    sim.step(30)
    assert values(sim) == later
    assert place(sim) == there
    sim.restart()
    assert values(sim) == [0.0] * 7
    assert place(sim) == pytest.approx([0.0, 0.0, TIP], abs=1e-4)


def test_two_arms_on_one_robot_move_by_themselves(simulate):
    sim = load(
        simulate,
        more="other = KukaLWR('other')\nother.translate(y=1.0)\nrobot.append(other)\ne = Pose('e')\nother.append(e)",
    )
    sim.robot.other.set_rotation("kuka_2", -math.pi / 2).result()
    assert values(sim) == [0.0] * 7
    assert place(sim) == pytest.approx([0.0, 0.0, TIP], abs=1e-4)
    data = sim.robot.other.e.get()
    assert [data["x"], data["y"], data["z"]] == pytest.approx([1.0, 1.0, 0.3105], abs=1e-4)
    assert sim.robot.other.list_IK_targets().result() == ["ik_target.robot.other.kuka_7"]


# -- arms of Blender files with masses, and arms of URDF files without: the script decides ---------

MASSES = "arm.properties(Dynamic=True)"


def test_an_arm_of_a_blender_file_holds_its_pose_by_its_motors(simulate) -> None:
    sim = simulate(SCENE.format(before="", more=MASSES), sockets=False)
    sim.step(60)
    assert values(sim) == pytest.approx([0.0] * 7, abs=5e-3)
    efforts = sim.robot.arm.joints.get_efforts().result()
    assert len(efforts) == 7
    upright = place(sim)
    sim.robot.arm.set_rotation("kuka_2", math.pi / 2).result()
    sim.step(180)
    assert values(sim)[1] == pytest.approx(math.pi / 2, abs=5e-3)
    # stretched out, gravity pulls at the second joint
    assert abs(sim.robot.arm.joints.get_efforts().result()["kuka_2"]) > 10.0
    assert math.dist(place(sim), upright) > 0.5


def test_an_arm_of_a_blender_file_has_no_masses_otherwise(simulate) -> None:
    sim = simulate(SCENE.format(before="", more=""), sockets=False)
    sim.step(2)
    assert sim.robot.arm.joints.get_efforts().result() == {}
    assert sim.robot.arm.get_controls().result() == {}


def test_a_free_arm_falls(simulate) -> None:
    sim = simulate(SCENE.format(before="", more="arm.properties(Dynamic=True, Control='effort')"), sockets=False)
    sim.robot.arm.publish({f"kuka_{i}": (0.5 if i == 2 else 0.0) for i in range(1, 8)})
    sim.step(10)
    sim.robot.arm.publish({f"kuka_{i}": 0.0 for i in range(1, 8)})
    sim.step(240)
    assert place(sim)[2] < 0.9, "it does not stay upright"
    assert set(sim.robot.arm.get_controls().result().values()) == {"effort"}


@pytest.mark.parametrize("line", ["arm.control('torque')", "arm.control('effort', ['kuka_99'])"])
def test_mistakes_are_named(simulate, line: str) -> None:
    with pytest.raises(Exception, match=r"torque|no joint 'kuka_99'"):
        simulate(SCENE.format(before="", more=line), sockets=False)


# -- an arm in the physics: it pushes obstacles, and does not affect other objects -----------------

ARMATURE_CONTACTS_SCENE = """
robot = {robot}
arm = KukaLWR()
arm.translate(z={height})
robot.append(arm)
pose = Pose()
robot.append(pose)
box = Cube('box')
box.scale = (0.2, 0.2, 0.15)
box.location = (0.75, {y}, 0.15)
box._bpy_object.game.physics_type = 'RIGID_BODY'
box._bpy_object.game.use_collision_bounds = True
box._bpy_object.game.collision_bounds_type = 'BOX'
{more}
"""
ROBOTS = {"FakeRobot()": 0.0, "ATRV()": -0.1}


def armature_contacts_place(sim, name="box"):
    return list(sim.context.world.objects_by_name[name].worldPosition)


@pytest.mark.parametrize("robot", ROBOTS)
def test_an_arm_pushes_a_box_that_sleeps(simulate, robot):
    sim = simulate(ARMATURE_CONTACTS_SCENE.format(robot=robot, height=ROBOTS[robot], y=0.6, more=""), sockets=False)
    sim.robot.arm.set_rotation("kuka_2", -math.pi / 2 - 0.1).result()
    sim.step(120)
    assert armature_contacts_place(sim) == pytest.approx([0.75, 0.6, 0.15], abs=0.01)
    # at 1.1 rad the arm has passed the initial position of the box: atan(0.6 / 0.75) = 0.67
    sim.robot.arm.rotate("kuka_1", 1.1, 0.4).result(10.0)
    x, y, _ = armature_contacts_place(sim)
    # it was pushed to the left and out of reach of the arm, at a moderate speed
    assert math.atan2(y, x) > math.atan2(0.6, 0.75) + 0.1
    assert 0.15 < math.hypot(x - 0.75, y - 0.6) < 0.8


def test_a_robot_with_an_arm_at_rest_rests(simulate):
    sim = simulate(ARMATURE_CONTACTS_SCENE.format(robot="ATRV()", height=0.5, y=3.0, more=""), sockets=False)
    sim.robot.arm.set_rotations([0.3, -1.0, 0.0, 0.8]).result()
    sim.step(120)
    before = sim.robot.pose.get()
    sim.step(300)
    after = sim.robot.pose.get()
    for field in ("x", "y", "z", "yaw", "pitch", "roll"):
        assert after[field] == pytest.approx(before[field], abs=1e-6)


def test_an_arm_that_is_laid_down_shortens_the_reach_of_a_scanner_behind_it(simulate):
    scanner = "eye = FakeRobot()\neye.translate(x=-1.0, z=0.4)\nscan = Sick()\neye.append(scan)"
    sim = simulate(ARMATURE_CONTACTS_SCENE.format(robot="FakeRobot()", height=0.0, y=30.0, more=scanner), sockets=False)
    sim.step(10)
    ahead = sim.eye.scan.get()["range_list"][90]
    assert ahead == pytest.approx(1.0 - 0.06, abs=0.03), "the upright arm"
    sim.robot.arm.set_rotation("kuka_2", math.pi / 2).result()
    sim.step(10)
    # the arm is on the ray, 0.3105 m up and 0.12 m thick: the ray passes above its upper side
    assert sim.eye.scan.get()["range_list"][90] == pytest.approx(30.0)


def test_what_a_gripper_on_the_arm_holds_goes_along(simulate):
    more = """
box.properties(Graspable=True)
hand = Gripper()
hand.translate(z=1.31)
hand.properties(Distance=2.0, Angle=360.0)
arm.append(hand)
"""
    sim = simulate(ARMATURE_CONTACTS_SCENE.format(robot="FakeRobot()", height=0.0, y=0.0, more=more), sockets=False)
    sim.robot.arm.set_rotations([0.0, -1.2, 0.0, 0.7]).result()
    sim.step(120)
    assert sim.robot.arm.hand.grab().result() == "box"
    hand = sim.context.component("robot.arm.hand").bge_object
    offset = math.dist(hand.worldPosition, armature_contacts_place(sim))
    before = armature_contacts_place(sim)
    sim.robot.arm.rotate_joints({"kuka_1": 1.0, "kuka_2": -0.6}, 1.0).result(10.0)
    sim.step(2)
    x, y, z = armature_contacts_place(sim)
    assert z > 0.4
    assert math.atan2(y, x) - math.atan2(before[1], before[0]) == pytest.approx(1.0, abs=1e-3)
    assert math.dist(hand.worldPosition, (x, y, z)) == pytest.approx(offset, abs=1e-3)


def test_a_saved_state_goes_on_with_the_same_contacts(simulate):
    sim = simulate(ARMATURE_CONTACTS_SCENE.format(robot="ATRV()", height=-0.1, y=0.6, more=""), sockets=False)
    sim.robot.arm.set_rotation("kuka_2", -math.pi / 2 - 0.1).result()
    sim.step(60)
    sim.robot.arm.publish({"kuka_1": 1.1})
    sim.step(50)
    state = sim.save()
    sim.step(60)
    there, code = armature_contacts_place(sim), sim.state_hash()
    sim.restore(state)
    sim.step(60)
    assert armature_contacts_place(sim) == there
    assert sim.state_hash() == code
    sim.restart()
    sim.robot.arm.set_rotation("kuka_2", -math.pi / 2 - 0.1).result()
    sim.step(60)
    sim.robot.arm.publish({"kuka_1": 1.1})
    sim.step(110)
    assert armature_contacts_place(sim) == there
