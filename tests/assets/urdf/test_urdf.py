"""Robots from URDF files: the poses of links, and invalid files."""

import math
from pathlib import Path

import numpy as np
import pytest
import trimesh

from morse.assets import find, load
from morse.assets.errors import AssetError
from morse.assets.urdf import read_urdf
from morse.scene import Bounds, JointKind, NodeKind, PhysicsType
from tests.kit.scenes import Load

ARM = """<robot name="planar">
  <material name="blue"><color rgba="0 0 1 1"/></material>
  <link name="base">
    <inertial><mass value="20"/></inertial>
    <visual><geometry><box size="0.6 0.6 0.2"/></geometry><material name="blue"/></visual>
    <collision><geometry><box size="0.6 0.6 0.2"/></geometry></collision>
  </link>
  <link name="upper">
    <inertial><mass value="2.5"/></inertial>
    <visual><origin xyz="0.25 0 0"/><geometry><box size="0.5 0.06 0.06"/></geometry></visual>
    <collision><origin xyz="0.25 0 0"/><geometry><cylinder radius="0.03" length="0.5"/></geometry></collision>
  </link>
  <link name="fore"><visual><geometry><sphere radius="0.05"/></geometry></visual></link>
  <link name="slider"/><link name="tool"/><link name="finger"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><origin xyz="0 0 0.3"/><axis xyz="0 2 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="elbow" type="continuous">
    <parent link="upper"/><child link="fore"/><origin xyz="0.5 0 0"/><axis xyz="0 0 -1"/>
  </joint>
  <joint name="reach" type="prismatic">
    <parent link="fore"/><child link="slider"/><origin xyz="0.4 0 0"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.2" effort="1" velocity="1"/>
  </joint>
  <joint name="mount" type="fixed">
    <parent link="slider"/><child link="tool"/><origin xyz="0.1 0 0" rpy="0 0 1.5707963267948966"/>
  </joint>
  <joint name="grip" type="prismatic">
    <parent link="tool"/><child link="finger"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.2" effort="1" velocity="1"/><mimic joint="reach" multiplier="0.5" offset="0.01"/>
  </joint>
</robot>
"""
SCENE = """
from morse.builder import *
robot = Robot({file!r})
robot.translate(z=0.5)
arm = Armature(armature_name='planar_joints')
arm.create_ik_targets(['mount'])
robot.append(arm)
joints = ArmaturePose()
arm.append(joints)
tip = Pose()
arm.append(tip, 'tool')
finger = Pose()
arm.append(finger, 'finger')
foot = Pose()
robot.append(foot)
env = Environment('empty')
"""


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    file = tmp_path / "arm.urdf"
    file.write_text(ARM)
    return file


@pytest.fixture
def run(load: Load, arm: Path):
    simulation = load(SCENE.format(file=str(arm)))
    simulation.step(120)
    return simulation


def place(pose) -> list[float]:
    data = pose.get()
    return [data["x"], data["y"], data["z"]]


def test_links_and_joints(arm: Path) -> None:
    (root,) = read_urdf(arm).roots
    assert root.body.type is PhysicsType.RIGID_BODY
    assert root.body.mass == pytest.approx(22.5)
    (joints,) = root.children
    assert joints.kind is NodeKind.ARMATURE
    assert [(bone.name, bone.kind.value) for bone in joints.bones] == [
        ("shoulder", "revolute"), ("elbow", "revolute"), ("reach", "prismatic"), ("mount", "fixed"),
        ("grip", "prismatic"),
    ]  # fmt: skip
    assert {node.name: node.bone for node in joints.children} == {
        "base": "", "upper": "shoulder", "fore": "elbow", "slider": "reach", "tool": "mount", "finger": "grip",
    }  # fmt: skip
    shapes = {node.name: node for node in root.walk() if node.mesh is not None}
    assert shapes["base_visual1"].materials[0].color == (0.0, 0.0, 1.0, 1.0)
    assert not shapes["base_collision1"].visible
    assert shapes["upper_collision1"].body.bounds is Bounds.CYLINDER
    assert shapes["upper_collision1"].scale == [0.03, 0.03, 0.25]


def test_links_start_where_the_file_has_them(arm: Path) -> None:
    nodes = {node.name: node for node in read_urdf(arm).nodes()}
    places = {"upper": (0, 0, 0.3), "fore": (0.5, 0, 0.3), "slider": (0.9, 0, 0.3), "tool": (1.0, 0, 0.3)}
    for name, wanted in places.items():
        assert tuple(nodes[name].world_matrix().translation) == pytest.approx(wanted, abs=1e-9)
    # the finger follows the slider, which is at 0: its offset is left
    assert nodes["finger"].world_matrix().translation[2] == pytest.approx(0.31)


def test_the_robot_stands_and_its_joints_obey(run) -> None:
    assert place(run.robot.foot) == pytest.approx([0.0, 0.0, 0.1], abs=2e-3), "half the height of its base"
    assert place(run.robot.arm.tip) == pytest.approx([1.0, 0.0, 0.4], abs=2e-3)
    arm = run.robot.arm
    assert arm.get_joints().result() == ["shoulder", "elbow", "reach"]
    assert arm.get_IK_limits("shoulder").result() == [-2.0, 2.0]
    arm.set_rotation("shoulder", -0.5).result()
    arm.set_rotation("elbow", 0.3).result()
    arm.set_translation("reach", 0.1).result()
    # the motors take a second, at 1 N m and 1 N at most
    run.step(120)
    # two links: 0.5 m, then 0.6 m rotated by 0.3 rad about the Z axis of the first, all pitched by 0.5 rad
    ahead = 0.5 + 0.6 * math.cos(0.3)
    wanted = [ahead * math.cos(0.5), -0.6 * math.sin(0.3), 0.4 + ahead * math.sin(0.5)]
    assert place(arm.tip) == pytest.approx(wanted, abs=3e-3)
    # the finger is 0.5 * 0.1 + 0.01 above the tool
    gap = np.subtract(place(arm.finger), place(arm.tip))
    assert np.linalg.norm(gap) == pytest.approx(0.06, abs=1e-3)
    data = arm.joints.get()
    assert [data[name] for name in ("shoulder", "elbow", "reach")] == pytest.approx([-0.5, 0.3, 0.1], abs=1e-3)


def test_its_tool_follows_a_target(run) -> None:
    target = "ik_target.robot.arm.mount"
    before = place(run.robot.arm.tip)
    run.robot.arm.place_IK_target(target, [0.1, 0.0, 0.0]).result()
    run.step(180)
    assert place(run.robot.arm.tip) == pytest.approx([before[0] + 0.1, *before[1:]], abs=1e-3)
    assert run.robot.arm.joints.get()["reach"] == pytest.approx(0.1, abs=1e-3)


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply"])
def test_meshes_are_found_and_scaled(tmp_path: Path, suffix: str) -> None:
    folder = tmp_path / "rover" / "meshes"
    folder.mkdir(parents=True)
    trimesh.creation.box((2.0, 4.0, 6.0)).export(folder / f"body.{suffix}")
    file = tmp_path / "rover" / "urdf" / "rover.urdf"
    file.parent.mkdir()
    name = f"package://rover/meshes/body.{suffix}"
    file.write_text(
        f'<robot name="rover"><link name="base"><visual><geometry><mesh filename="{name}" scale=".1 .1 .1"/></geometry>'
        f'</visual><collision><geometry><mesh filename="../meshes/body.{suffix}"/></geometry></collision></link>'
        "</robot>"
    )
    library = read_urdf(file)
    assert library.warnings == []
    nodes = {node.name: node for node in library.nodes()}
    (seen,), (solid,) = nodes["base_visual1"].children, nodes["base_collision1"].children
    assert np.ptp(seen.mesh.vertices * nodes["base_visual1"].scale, axis=0) == pytest.approx([0.2, 0.4, 0.6])
    assert seen.body.type is PhysicsType.NO_COLLISION
    assert solid.body.bounds is Bounds.CONVEX_HULL
    assert not solid.visible


def test_what_hangs_on_the_world_is_fixed(tmp_path: Path) -> None:
    file = tmp_path / "post.urdf"
    file.write_text(
        '<robot name="post"><link name="world"/><link name="post"/><joint name="fix" type="fixed">'
        '<parent link="world"/><child link="post"/></joint></robot>'
    )
    (root,) = read_urdf(file).roots
    assert root.body.type is PhysicsType.STATIC


def test_a_thing_of_mass_0_is_fixed(tmp_path: Path) -> None:
    file = tmp_path / "plane.urdf"
    file.write_text('<robot name="plane"><link name="plane"><inertial><mass value="0"/></inertial></link></robot>')
    (root,) = read_urdf(file).roots
    assert root.body.type is PhysicsType.STATIC


def test_it_is_found_by_its_name(arm: Path) -> None:
    assert load(find(str(arm))).roots[0].name == "planar"


def test_what_cannot_be_read_is_left_out_with_a_warning(tmp_path: Path) -> None:
    (tmp_path / "bad.stl").write_bytes(b"solid nonsense" * 3)
    (tmp_path / "huge.obj").write_text("v 1e30 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n")
    file = tmp_path / "odd.urdf"
    visuals = "".join(
        f'<visual><geometry><mesh filename="{name}"/></geometry></visual>'
        for name in ("bad.stl", "huge.obj", "gone.stl", "package://nowhere/a.stl", "arm.step")
    )
    file.write_text(
        f'<robot name="odd"><link name="a">{visuals}<visual><geometry><cone radius="1" length="1"/></geometry>'
        '</visual><visual><geometry><box size="1, 1, 0 7"/></geometry></visual></link><link name="b"/>'
        '<joint name="j" type="planar"><parent link="a"/><child link="b"/></joint>'
        "</robot>"
    )
    library = read_urdf(file)
    text = "\n".join(library.warnings)
    for word in (
        "bad.stl",
        "huge.obj",
        "gone.stl",
        "ROS_PACKAGE_PATH",
        "cone",
        "first 3 are used",
        "<box>",
    ):
        assert word in text
    assert not any(node.mesh for node in library.nodes())


LINKS = '<link name="a"/><link name="b"/>'
ENDS = '<parent link="a"/><child link="b"/>'


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "not XML"),
        ("<robot>", "not XML"),
        ("<sdf/>", "begins with <sdf>"),
        ("<robot/>", "no links"),
        ("<robot><link/></robot>", "a <link> has no 'name'"),
        (f"<robot>{LINKS}</robot>", "2 links without a parent: a, b"),
        (f'<robot>{LINKS}<joint name="j" type="turning">{ENDS}</joint></robot>', "'turning'.*revolute"),
        (f'<robot>{LINKS}<joint name="j" type="revolute">{ENDS}<axis xyz="0 nan 1"/></joint></robot>', "3 numbers"),
        (
            '<robot><link name="a"/><joint name="j" type="fixed"><parent link="a"/><child link="c"/></joint></robot>',
            "'c', which does not exist",
        ),
        (
            f'<robot>{LINKS}<joint name="j" type="fixed">{ENDS}</joint><joint name="k" type="fixed"><parent link="b"/>'
            '<child link="a"/></joint></robot>',
            "cycle",
        ),
        ('<robot><link name="a"><inertial><mass value="-1"/></inertial></link></robot>', "mass -1"),
        ('<robot><link name="a"><inertial><mass value="inf"/></inertial></link></robot>', "a number"),
    ],
)
def test_broken_files_are_refused_with_the_reason(tmp_path: Path, text: str, words: str) -> None:
    file = tmp_path / "broken.urdf"
    file.write_text(text)
    with pytest.raises(AssetError, match=words):
        read_urdf(file)


def test_a_joint_that_cannot_follow_another_moves_by_itself(tmp_path: Path) -> None:
    file = tmp_path / "alone.urdf"
    file.write_text(
        f'<robot name="alone">{LINKS}<joint name="j" type="prismatic">{ENDS}<limit lower="0" upper="1"/>'
        '<mimic joint="k"/></joint></robot>'
    )
    library = read_urdf(file)
    assert "cannot follow 'k'" in library.warnings[0]
    bone = library.roots[0].children[0].bones[0]
    assert (bone.kind, bone.leader) == (JointKind.PRISMATIC, -1)


def test_a_joint_with_an_axis_of_length_0_is_fixed(tmp_path: Path) -> None:
    file = tmp_path / "stiff.urdf"
    file.write_text(
        f'<robot name="stiff">{LINKS}<joint name="j" type="revolute">{ENDS}<axis xyz="0 0 0"/>'
        '<limit lower="-1" upper="1" effort="2" velocity="3"/></joint></robot>'
    )
    library = read_urdf(file)
    assert any("'j' has an axis of length 0 (line 1): it is fixed" in warning for warning in library.warnings)
    assert library.roots[0].children[0].bones[0].kind == JointKind.FIXED


def test_limits_the_wrong_way_round_are_none(tmp_path: Path) -> None:
    file = tmp_path / "free.urdf"
    file.write_text(
        f'\n<?xml version="1.0"?><robot name="free">{LINKS}<joint name="j" type="revolute">{ENDS}'
        '<limit lower="1" upper="-1"/></joint></robot>'
    )
    library = read_urdf(file)
    assert "no limits" in library.warnings[0]
    bone = library.roots[0].children[0].bones[0]
    assert bone.low < -1000.0
    assert bone.high > 1000.0
