"""Other armatures: prismatic joints, armatures in the model of a robot, streams and journals."""

import math
from pathlib import Path

import pytest
from arms import load, place, values

import morse
from morse.core.kinds import bind
from pymorse import MorseServiceFailed, MorseServicePreempted

#: the first bone of the arm as a lift: it slides along itself, upward, by up to 0.3 m
LIFT = """
from dataclasses import replace
from morse.scene import JointKind
first, *others = arm.scene_node.bones
lift = replace(first, kind=JointKind.PRISMATIC, axis=1, free=(False, False, False), low=0.0, high=0.3)
arm.scene_node.bones = (lift, *others)
"""
OWN = """
from morse.builder import workspace
robot = FakeRobot()
(model,) = robot.append_meshes(['kuka_armature'], {model!r})
model.node.location = [0.0, 0.0, 0.5]
workspace.current().attach(robot.scene_node, model.node)
arm = Armature(armature_name='kuka_armature')
robot.append(arm)
joints = ArmaturePose()
arm.append(joints)
tip = Pose()
arm.append(tip, 'kuka_7')
"""


def test_a_joint_slides_at_its_speed(simulate):
    sim = load(simulate, more=LIFT)
    arm = sim.robot.arm
    assert arm.get_dofs().result()["kuka_1"] == [0, 0, 0]
    assert arm.get_IK_limits("kuka_1").result() == [0.0, 0.3]
    began = sim.time()
    arm.translate("kuka_1", 0.1).result(10.0)
    # 0.1 m at 0.05 m/s; it ends within the tolerance of 5 mm
    assert sim.time() - began == pytest.approx(1.9, abs=0.06)
    assert sim.robot.arm.tip.get()["z"] == pytest.approx(1.3105 + 0.095, abs=2e-3)
    sim.step(10)
    assert values(sim)[0] == pytest.approx(0.1)
    arm.translate_joints({"kuka_1": 0.3}, 0.2).result(10.0)
    assert place(sim)[2] == pytest.approx(1.6105, abs=1e-3)
    assert sim.robot.arm.joints.get_joint("kuka_1").result() == pytest.approx(0.3, abs=1e-3)


def test_a_sliding_joint_keeps_its_limits_and_its_kind(simulate):
    sim = load(simulate, more=LIFT)
    arm = sim.robot.arm
    arm.set_translation("kuka_1", 5.0).result()
    assert values(sim)[0] == 0.3
    arm.set_translations([0.2]).result()
    assert values(sim)[0] == 0.2
    for service, arguments in (
        ("set_rotation", ["kuka_1", 0.1]),
        ("rotate", ["kuka_1", 0.1]),
        ("set_translations", [[0.1, 0.1]]),
        ("set_rotations", [[0.1]]),
    ):
        with pytest.raises(MorseServiceFailed, match="joint and has no"):
            getattr(arm, service)(*arguments).result(1.0)
    assert values(sim)[0] == 0.2
    arm.rotate("kuka_2", -math.pi / 2, 10.0).result(5.0)
    sim.step(2)
    assert place(sim) == pytest.approx([1.0, 0.0, 0.5105], abs=1e-3)


def test_a_lift_helps_to_reach_a_target(simulate):
    sim = load(simulate, more=LIFT)
    target = "ik_target.robot.arm.kuka_7"
    # 0.25 m above the stretched arm: only the lift reaches it
    sim.robot.arm.place_IK_target(target, [0.0, 0.0, 0.25]).result()
    sim.step(120)
    assert place(sim) == pytest.approx([0.0, 0.0, 1.5605], abs=1e-3)
    assert values(sim)[0] == pytest.approx(0.25, abs=1e-3)


def test_an_armature_that_the_robot_brings_stays_where_it_is(simulate):
    model = Path(morse.__file__).parent / "data" / "actuators" / "kuka_lwr.blend"
    sim = simulate(OWN.format(model=str(model)), sockets=False)
    sim.step(2)
    assert sim.robot.arm.get_joints().result() == [f"kuka_{i}" for i in range(1, 8)]
    before = sim.robot.arm.tip.get()
    assert before["z"] == pytest.approx(0.5 + 1.1005, abs=1e-4)
    sim.robot.arm.set_rotation("kuka_2", -math.pi / 2).result()
    sim.step(2)
    data = sim.robot.arm.tip.get()
    assert [data["x"], data["z"]] == pytest.approx([1.1005 - 0.3105, 0.8105], abs=1e-4)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("arm = Armature()", r"Armature needs an armature"),
        ("arm = Armature(armature_name='crane')", r"no object 'crane'"),
        ("arm = Armature('arm', 'kuka_armature', 'kuka_lrw')", r"kuka_lrw"),
        ("arm = Armature('arm', 'kuka_armatur', 'kuka_lwr')", r"kuka_armatur"),
        ("arm = Armature('arm', None, 'ptu')", r"which armature of 'ptu'"),
        ("arm = Armature('arm', 'PTU', 'ptu')", r"no bones"),
        ("arm = KukaLWR()\narm.create_ik_targets(['kuka_8'])", r"no bone 'kuka_8'"),
        ("arm = KukaLWR()\narm.create_ik_targets([7])", r"no bone 7"),
        ("arm = KukaLWR()\narm.properties(RotationSpeed=-1.0)", r"RotationSpeed"),
    ],
)
def test_mistakes_of_scripts_are_named(simulate, line, words):
    with pytest.raises(Exception, match=words):
        simulate(f"robot = FakeRobot()\n{line}\nrobot.append(arm)", sockets=False)


def test_a_pose_belongs_on_an_armature(simulate):
    with pytest.raises(Exception, match="append it to an armature"):
        simulate("robot = FakeRobot()\njoints = ArmaturePose()\nrobot.append(joints)", sockets=False)


def test_several_bones_may_have_targets(simulate):
    sim = load(simulate, more="arm.create_ik_targets(['kuka_4', 'kuka_7'])")
    assert sorted(sim.robot.arm.list_IK_targets().result()) == [
        "ik_target.robot.arm.kuka_4",
        "ik_target.robot.arm.kuka_7",
    ]


def test_messages_carry_every_joint(simulate):
    sim = load(simulate, more=LIFT)
    arm = sim.context.component("robot.arm")
    (bound,) = bind(arm)
    assert bound.kind.name == "joints"
    message = bound.gather()
    assert tuple(message.names) == arm.joints
    fields, remark = bound.scatter({"position": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]})
    assert remark is None
    assert fields == pytest.approx(dict(zip(arm.joints, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], strict=True)))
    sim.robot.arm.set_rotation("kuka_3", 0.5).result()
    sim.step(2)
    (posture,) = bind(sim.context.component("robot.arm.joints"))
    assert posture.gather().position.tolist() == pytest.approx([0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0])


def test_fields_say_unit_and_limits(simulate):
    sim = load(simulate, more=LIFT)
    lift, shoulder = (sim.context.component("robot.arm.joints").own_fields[name] for name in ("kuka_1", "kuka_2"))
    assert (lift.unit, lift.low, lift.high) == ("m", 0.0, 0.3)
    assert shoulder.unit == "rad"
    assert (shoulder.low, shoulder.high) == pytest.approx((-math.radians(120), math.radians(120)), abs=1e-5)


def test_an_arm_that_goes_preempts_its_service(simulate):
    sim = load(simulate)
    turning = sim.robot.arm.rotate("kuka_1", 2.0)
    sim.step(5)
    sim.restart()
    with pytest.raises((MorseServicePreempted, MorseServiceFailed)):
        turning.result(1.0)


def test_a_run_is_the_same_again_from_its_journal(simulate):
    target = "ik_target.robot.arm.kuka_7"
    sim = load(simulate)
    with sim.record_inputs() as journal:
        sim.robot.arm.publish({"kuka_1": 0.7})
        sim.step(20)
        sim.robot.arm.rotate("kuka_4", 1.0)
        sim.step(20)
        points = [{"positions": [0.1 * i] * 7, "time_from_start": 0.3 * i} for i in (1, 2)]
        sim.robot.arm.trajectory({"points": points})
        sim.step(40)
        sim.robot.arm.move_IK_target(target, [0.0, 0.2, -0.3])
        sim.step(40)
    wanted, there = sim.state_hash(), values(sim)
    again = load(simulate)
    again.replay(journal)
    assert again.state_hash() == wanted
    assert values(again) == there
