"""The PR2: its torso, arms, joint values and equipment."""

import json
import math
from types import SimpleNamespace

import pytest
from morse.middleware.sockets.jointstate import PR2JointStatePublisher

from morse.core.exceptions import MorseRPCInvokationError
from morse.robots.pr2 import PR2

SCENE = """
from morse.builder import *
pr2 = NavPR2()
pr2.add_interface("socket")
other = LocalizedPR2()
other.translate(y=3)
plain = Robot("pr2")
plain.morseable("morse.robots.pr2.PR2")
plain.translate(y=-4)
env = Environment("empty", fastmode=True)
"""


def component(simulation, name):
    return simulation.context.components.get(name) or simulation.context.robots[name]


def palm(simulation, side):
    parts = component(simulation, "pr2").bge_object.childrenRecursive
    return next(part for part in parts if part.name.startswith(f"{side}_gripper_palm_link")).world_pose()[0]


def test_the_components_have_the_names_of_1_4(simulation):
    limbs = ["torso", "head", "l_arm", "r_arm"]
    bare = [f"{limb}{end}" for limb in limbs for end in ("", ".pose")] + ["joint_state"]
    base = [*bare, "motion", "odometry", "keyboard"]
    names = set(simulation.context.components)
    assert {f"pr2.{name}" for name in [*base, "base_scan"]} == {name for name in names if name.startswith("pr2.")}
    assert {f"other.{name}" for name in [*base, "pose"]} == {name for name in names if name.startswith("other.")}
    assert component(simulation, "pr2").get_armatures() == [f"pr2.{limb}" for limb in limbs]


def test_the_torso_rises_with_head_and_arms(simulation):
    pr2 = component(simulation, "pr2")
    assert pr2.get_torso_minmax() == pytest.approx([0.0, 0.31])
    assert pr2.get_torso() == 0.0
    before = palm(simulation, "l")
    pr2.set_torso(0.2)
    simulation.step()
    assert pr2.get_torso() == pytest.approx(0.2)
    assert [b - a for a, b in zip(before, palm(simulation, "l"), strict=True)] == pytest.approx([0, 0, 0.2], abs=1e-4)
    pr2.set_torso(0.9)
    assert pr2.get_torso() == pytest.approx(0.31)


def test_a_robot_without_a_torso_component_says_so(simulation):
    with pytest.raises(MorseRPCInvokationError, match="plain has no component that moves the torso"):
        component(simulation, "plain").get_torso()


def test_at_zero_the_arms_point_ahead(simulation):
    # from the description of the robot: shoulder at (-0.05, 0.188, 0.791), wrist 0.1 + 0.4 + 0.321 m ahead of it, and
    # 42 mm to the joint of the palm
    x, y, z = palm(simulation, "l")
    assert (x, y, z) == pytest.approx((-0.05 + 0.821 + 0.042, 0.188, 0.791), abs=1e-3)
    assert palm(simulation, "r") == pytest.approx((x, -y, z), abs=1e-3)


@pytest.mark.parametrize(
    ("joint", "angle", "axis", "way"),
    [
        ("shoulder_pan", 0.5, 1, 1.0),
        ("shoulder_lift", 0.5, 2, -1.0),
        ("elbow_flex", 0.5, 2, 1.0),
        ("wrist_flex", 0.5, 2, 1.0),
    ],
)
def test_joints_turn_in_their_directions(simulation, joint, angle, axis, way):
    before = palm(simulation, "l")
    component(simulation, "pr2.l_arm").set_rotation(f"l_{joint}_joint", angle)
    simulation.step()
    reach = {"shoulder_pan": 0.863, "shoulder_lift": 0.763, "elbow_flex": 0.363, "wrist_flex": 0.042}[joint]
    assert palm(simulation, "l")[axis] - before[axis] == pytest.approx(way * reach * math.sin(angle), abs=1e-3)


def test_it_drives(simulation):
    component(simulation, "pr2.motion").local_data["x"] = 0.5
    simulation.step(60)
    odometry = component(simulation, "pr2.odometry").local_data
    assert (odometry["x"], odometry["y"]) == pytest.approx((0.5, 0.0), abs=0.02)


def test_its_scanner_does_not_see_the_robot_itself(simulation):
    simulation.step(12)
    # the side of the other base, half of 0.668 m from its centre
    assert min(component(simulation, "pr2.base_scan").local_data["range_list"]) == pytest.approx(3.0 - 0.334, abs=0.01)


def test_joint_values_on_the_socket_are_one_flat_object_of_45_joints(simulation):
    component(simulation, "pr2.head").set_rotation("head_pan_joint", 0.3)
    simulation.step(2)
    data = component(simulation, "pr2.joint_state").local_data
    publisher = PR2JointStatePublisher.__new__(PR2JointStatePublisher)
    publisher.component_instance = SimpleNamespace(local_data=data, robot_parent=component(simulation, "pr2"))
    sent = json.loads(publisher.encode())
    assert list(sent) == ["timestamp", *PR2.all_joints]
    assert len(PR2.all_joints) == len(set(PR2.all_joints)) == 45
    assert sent["head_pan_joint"] == pytest.approx(0.3)
    assert sent["timestamp"] == data["timestamp"]
    # the model has no fingers that move
    assert sent["l_gripper_l_finger_joint"] == 0.0
