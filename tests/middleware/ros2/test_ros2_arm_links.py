"""Links of arms and of robots from files as frames: names of the file, poses of forward kinematics."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from desk import Desk
from test_ros2_robots import about, frames, from_rpy, numbers, rotation

Start = Callable[..., tuple[Any, Desk]]

INERTIAL = '<inertial><mass value="1"/></inertial>'
#: a column that turns, a boom that is raised, a trolley that slides along it, with a lamp at a fixed place; and a hand
#: whose two fingers move against each other
CRANE = f"""<robot name="crane">
  <link name="base_link"/><link name="column">{INERTIAL}</link><link name="boom">{INERTIAL}</link>
  <link name="trolley">{INERTIAL}</link><link name="lamp"/>
  <link name="left">{INERTIAL}</link><link name="right">{INERTIAL}</link>
  <joint name="turn" type="continuous"><parent link="base_link"/><child link="column"/>
    <origin xyz="0.1 0 0.4" rpy="0 0 0.3"/><axis xyz="0 0 1"/></joint>
  <joint name="lift" type="revolute"><parent link="column"/><child link="boom"/>
    <origin xyz="0 0.05 1.0" rpy="0.2 0 0"/><axis xyz="0 -0.6 0.8"/>
    <limit lower="-1" upper="1" effort="0" velocity="0"/></joint>
  <joint name="run" type="prismatic"><parent link="boom"/><child link="trolley"/><origin xyz="0.5 0 -0.1"/>
    <axis xyz="1 0 0"/><limit lower="0" upper="2" effort="0" velocity="0"/></joint>
  <joint name="screw" type="fixed"><parent link="trolley"/><child link="lamp"/>
    <origin xyz="0 0 -0.2" rpy="0 1.2 0"/></joint>
  <joint name="open" type="revolute"><parent link="trolley"/><child link="left"/><origin xyz="0.1 0.1 0"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="0" velocity="0"/></joint>
  <joint name="close" type="revolute"><parent link="trolley"/><child link="right"/><origin xyz="0.1 -0.1 0"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="0" velocity="0"/>
    <mimic joint="open" multiplier="-1"/></joint>
</robot>"""
ROBOT = """
robot = Robot({file!r}, name="crane")
robot.translate(1.0, 2.0, 0.0)
{arm}
robot.append(Pose("pose"))
robot.add_default_interface("ros2")
"""
ARM = """
arm = Armature("arm", armature_name="crane_joints")
arm.properties(Dynamic={dynamic}, LinearSpeed=2.0, RotationSpeed=3.0)
robot.append(arm)
arm.append(ArmaturePose("state"))
"""
GOAL = {"turn": 0.7, "lift": -0.4, "run": 0.6, "open": 0.5}


def matrix(rotation: Any, place: Any) -> Any:
    made = np.eye(4)
    made[:3, :3], made[:3, 3] = rotation, place
    return made


def kinematics(values: dict[str, float]) -> dict[str, Any]:
    """Link to its parent and (4, 4) pose in it, from the text of the file."""
    found = {}
    for joint in ElementTree.fromstring(CRANE).iter("joint"):
        origin, axis = joint.find("origin"), joint.find("axis")
        pose = matrix(from_rpy(origin.get("rpy", "0 0 0")), numbers(origin.get("xyz")))
        value = values.get(joint.get("name"), 0.0)
        if joint.find("mimic") is not None:
            value = -values["open"]
        if joint.get("type") == "prismatic":
            pose = pose @ matrix(np.eye(3), value * numbers(axis.get("xyz")))
        elif axis is not None:
            pose = pose @ matrix(about(numbers(axis.get("xyz")), value), np.zeros(3))
        found[joint.find("child").get("link")] = joint.find("parent").get("link"), pose
    return found


def pose_of(transform: Any) -> Any:
    place = transform.transform.translation
    return matrix(rotation(transform.transform.rotation), [place.x, place.y, place.z])


@pytest.fixture
def file(tmp_path: Path) -> str:
    path = tmp_path / "crane.urdf"
    path.write_text(CRANE)
    return str(path)


@pytest.mark.parametrize("dynamic", [True, False])
def test_links_are_where_forward_kinematics_says(start: Start, file: str, dynamic: bool) -> None:
    sim, desk = start(ROBOT.format(file=file, arm=ARM.format(dynamic=dynamic)))
    sim.crane.arm.publish(GOAL)
    sim.step(100)
    values = sim.crane.arm.state.get()
    assert values["run"] == pytest.approx(GOAL["run"], abs=5e-3)
    known = frames(desk, "/tf", "/tf_static")
    for link, (parent, pose) in kinematics(values).items():
        seen = known[f"crane/{link}"]
        assert seen.header.frame_id == f"crane/{parent}"
        # fingers that follow others, by a soft constraint
        np.testing.assert_allclose(pose_of(seen), pose, atol=2e-3 if link == "right" and dynamic else 1e-5)
    assert known["crane/base_link"].header.frame_id == "crane/odom", "the first link of the file is the body"
    assert "crane/lamp" in frames(desk, "/tf_static"), "it does not move against its parent"


def test_the_description_has_the_links_and_joints_of_the_file(start: Start, file: str) -> None:
    sim, desk = start(ROBOT.format(file=file, arm=ARM.format(dynamic=True)))
    sim.step(3)
    model = ElementTree.fromstring(desk.last("/crane/robot_description").data)
    joints = {joint.get("name"): joint for joint in model.iter("joint")}
    for given in ElementTree.fromstring(CRANE).iter("joint"):
        made = joints[given.get("name")]
        kind = given.get("type")
        assert made.get("type") == kind
        assert made.find("child").get("link") == f"crane/{given.find('child').get('link')}"
        wanted, seen = given.find("origin"), made.find("origin")
        np.testing.assert_allclose(numbers(seen.get("xyz")), numbers(wanted.get("xyz")), atol=1e-4)
        np.testing.assert_allclose(from_rpy(seen.get("rpy", "0 0 0")), from_rpy(wanted.get("rpy", "0 0 0")), atol=5e-3)
        if given.find("axis") is not None:
            np.testing.assert_allclose(
                numbers(made.find("axis").get("xyz")), numbers(given.find("axis").get("xyz")), atol=1e-6
            )
    mimic = joints["close"].find("mimic")
    assert (mimic.get("joint"), float(mimic.get("multiplier"))) == ("open", -1.0)
    assert sorted(desk.last("/crane/joint_states").name) == ["lift", "open", "run", "turn"]


def test_a_robot_without_an_armature_has_frames_too(start: Start, file: str) -> None:
    sim, desk = start(ROBOT.format(file=file, arm=""))
    sim.step(30)
    known = frames(desk, "/tf", "/tf_static")
    values = dict.fromkeys(GOAL, 0.0)
    for link, (parent, pose) in kinematics(values).items():
        assert known[f"crane/{link}"].header.frame_id == f"crane/{parent}"
        np.testing.assert_allclose(pose_of(known[f"crane/{link}"]), pose, atol=0.02)


def test_an_arm_of_a_blender_file(start: Start) -> None:
    sim, desk = start(
        "arm = KukaLWR()\narm.translate(z=0.5)\nrobot.append(arm)\n"
        "arm.append(Pose('tip')); robot.add_default_interface('ros2')\n"
    )
    angles = [0.3, -0.6, 0.2, 0.9, -0.4, 0.5, 0.1]
    for number, angle in enumerate(angles, 1):
        sim.robot.arm.set_rotation(f"kuka_{number}", angle).result()
    sim.step(3)
    known = frames(desk, "/tf", "/tf_static")
    parents = {child: one.header.frame_id for child, one in known.items()}
    moved = [child for child, parent in parents.items() if "kuka" in child.lower()]
    chain = []
    frame = next(child for child in moved if child not in parents.values())
    while frame != "robot/base_link":
        chain.append(frame)
        frame = parents[frame]
    assert len(chain) == 7, "a frame for each joint, one below the other"
    tip = np.eye(4)
    for child in reversed(chain):
        tip = tip @ pose_of(known[child])
    # heights of the joints of the stretched arm; odd joints turn about Z, even ones about -Y, +Y, -Y
    heights, axes = (0.0, 0.3105, 0.5105, 0.7105, 0.9105, 1.1005, 1.1785), "z-z+z-z"
    wanted, below = matrix(np.eye(3), [0.0, 0.0, 0.5]), 0.0
    for height, axis, angle in zip(heights, axes, angles, strict=True):
        about_y = {"z": (0.0, 0.0, 1.0), "-": (0.0, -1.0, 0.0), "+": (0.0, 1.0, 0.0)}[axis]
        wanted = wanted @ matrix(about(about_y, angle), [0.0, 0.0, height - below])
        below = height
    # along the last axis its origin may be anywhere
    away = np.linalg.inv(wanted) @ tip
    np.testing.assert_allclose(away[:2, 3], [0.0, 0.0], atol=1e-4)
    assert math.hypot(*away[:3, 3]) < 0.2
