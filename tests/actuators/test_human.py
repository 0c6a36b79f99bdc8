"""A person: walking, the skeleton, its targets, and the hands."""

import math

import pytest

from morse.core.exceptions import MorseRPCInvokationError

pytestmark = pytest.mark.long

SCENE = """
from morse.builder import *
human = Human()
human.translate(x=1)
motion = MotionXYW()
human.append(motion)
pose = Pose()
human.append(pose)
human.add_interface("socket")
posture = HumanPosture()
human.append(posture)
calm = Human(name="calm")
calm.translate(y=5)
calm.properties(Animations=False)
stroll = MotionVW()
calm.append(stroll)
watcher = FakeRobot()
watcher.translate(x=-3, z=1.2)
laser = Sick()
watcher.append(laser)
for name, y, mark in (("Cup", -0.45, True), ("Plate", -0.75, True), ("Rock", -0.5, False)):
    thing = Cube(name)
    thing.scale = (0.02, 0.02, 0.02)
    thing.translate(x=1.1, y=y, z=0.8)
    thing.properties(Graspable=mark)
env = Environment("empty", fastmode=True)
"""


def component(simulation, name):
    return simulation.context.components.get(name) or simulation.context.robots[name]


def test_the_components_have_the_names_of_1_4(simulation):
    assert {"human.skeleton", "human.skeleton.joint_states"} <= set(simulation.context.components)
    assert component(simulation, "human.skeleton").list_IK_targets() == [
        f"ik_target.human.skeleton.{bone}" for bone in ("head", "wrist_L", "wrist_R", "foot_L", "foot_R")
    ]


def test_the_posture_of_a_person_has_the_fields_of_1_4(simulation):
    sensor, skeleton = component(simulation, "human.posture"), component(simulation, "human.skeleton")
    joints = skeleton.get_joints()
    simulation.rpc("human.skeleton", "set_rotation", joints[5], 0.2)
    simulation.step(2)
    data = sensor.local_data
    fields = ["timestamp", "x", "y", "z", "yaw", "pitch", "roll", *(f"empty{n}" for n in range(1, 7))]
    assert list(data) == [*fields, *(f"dof_{n}" for n in range(12, 50))]
    assert data["x"] == pytest.approx(1.0, abs=1e-3)
    assert data["dof_17"] == pytest.approx(0.2, abs=1e-6)
    values = [data[f"dof_{n}"] for n in range(12, 50)]
    assert values == pytest.approx([*skeleton.joint_values, *[0.0] * (38 - len(joints))])


def test_a_person_walks_without_momentum_whatever_the_control_type(simulation):
    motion, pose = component(simulation, "human.motion"), component(simulation, "human.pose")
    motion.local_data["x"] = 1.2
    simulation.step(60)
    motion.local_data["x"] = 0.0
    simulation.step(30)
    assert pose.local_data["x"] == pytest.approx(2.2, abs=0.01)
    assert pose.local_data["z"] == pytest.approx(0.0, abs=0.01)


def test_a_person_who_turns_stays_upright(simulation):
    """As all bodies of the type DYNAMIC in 1.4; it fell over after half a turn."""
    component(simulation, "calm.stroll").local_data["w"] = 0.5
    simulation.step(600)
    calm = component(simulation, "calm").position_3d
    assert (calm.roll, calm.pitch) == pytest.approx((0.0, 0.0), abs=1e-3)
    assert math.remainder(calm.yaw - 5.0, math.tau) == pytest.approx(0.0, abs=0.02)
    assert calm.z == pytest.approx(0.0, abs=0.01)


def test_legs_swing_against_each_other_with_the_distance_and_settle(simulation):
    motion, states = component(simulation, "human.motion"), component(simulation, "human.skeleton.joint_states")
    motion.local_data["x"] = 1.3
    left, right = [], []
    for _ in range(120):
        simulation.step()
        left.append(states.local_data["upperleg01_L"])
        right.append(states.local_data["upperleg01_R"])
    # a stride of 1.3 m at 1.3 m/s: one swing in a second, the first one gentler
    assert max(left) == pytest.approx(0.45, abs=0.02)
    assert min(left) == pytest.approx(-0.45, abs=0.02)
    assert right == pytest.approx([-angle for angle in left])
    motion.local_data["x"] = 0.0
    simulation.step(30)
    assert states.local_data["upperleg01_L"] == pytest.approx(0.0, abs=1e-6)


def test_a_person_without_animations_glides(simulation):
    component(simulation, "calm.stroll").local_data["v"] = 1.0
    simulation.step(30)
    skeleton = component(simulation, "calm.skeleton")
    assert skeleton.joint_values == pytest.approx([0.0] * len(skeleton.joints))


def test_a_knee_bends_backward_and_an_elbow_forward(simulation):
    skeleton = component(simulation, "human.skeleton")
    foot = next(part for part in skeleton.bge_object.children if part.name.startswith("foot_L"))
    hand = next(part for part in skeleton.bge_object.children if part.name.startswith("hand_L"))
    before = foot.world_pose()[0][0], hand.world_pose()[0][0]
    skeleton.set_rotations([{"lowerleg01_L": -1.0, "lowerarm01_L": 1.0}.get(joint, 0.0) for joint in skeleton.joints])
    simulation.step()
    after = foot.world_pose()[0][0], hand.world_pose()[0][0]
    assert after[0] < before[0] - 0.2
    assert after[1] > before[1] + 0.15


def test_a_wrist_follows_its_target(simulation):
    skeleton = component(simulation, "human.skeleton")
    name = "ik_target.human.skeleton.wrist_L"
    target = skeleton._targets[name]
    skeleton.place_IK_target(name, [0.1, 0.05, 0.08])
    simulation.step(240)
    (x, y, z), _ = target.local_pose()
    chain = skeleton.chain
    index = chain.index("wrist_L")
    tip, _ = chain.tip(chain.frames(list(skeleton.joint_values))[index], index)
    assert math.dist(tip, (x, y, z)) < 0.02


def test_lasers_see_the_torso(simulation):
    simulation.step(12)
    # 4 m between the laser and the person, whose torso has a radius of 17 cm
    assert min(component(simulation, "watcher.laser").local_data["range_list"]) == pytest.approx(3.83, abs=0.01)


def test_the_right_hand_takes_the_nearest_object_along(simulation):
    human = component(simulation, "human")
    assert human.grasp(True) is True
    cup = simulation.context.world.objects_by_name["Cup"]
    before = cup.world_pose()[0][0]
    component(simulation, "human.motion").local_data["x"] = 0.6
    simulation.step(60)
    # the arm swings while the person walks
    assert cup.world_pose()[0][0] - before == pytest.approx(0.6, abs=0.25)
    assert human.grasp(False) is True
    assert human.grasp(False) is False
    assert cup.parent is None


def test_an_object_is_chosen_by_its_name(simulation):
    human = component(simulation, "human")
    assert human.grasp(True, "Plate") is True
    assert simulation.context.world.objects_by_name["Plate"].parent is not None
    assert human.grasp(True, "Plate") is True
    assert human.grasp(True, "Cup") is False


@pytest.mark.parametrize(
    ("name", "reason"), [("Rock", "is held already, or is not Graspable"), ("Cop", "does not exist.*'Cup'")]
)
def test_an_object_that_cannot_be_grasped_is_named(simulation, name, reason):
    with pytest.raises(MorseRPCInvokationError, match=reason):
        component(simulation, "human").grasp(True, name)


def test_an_object_out_of_reach_is_not_grasped(simulation):
    component(simulation, "human.motion").local_data["y"] = 2.0
    simulation.step(60)
    assert component(simulation, "human").grasp(True) is False
