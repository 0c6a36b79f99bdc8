"""What URDF files of ROS packages contain besides links and joints: package names, substitutions, macros."""

import math
from pathlib import Path

import numpy as np
import pytest
import trimesh

import morse
from morse.assets import load
from morse.assets.errors import AssetError
from morse.assets.urdf import read_urdf
from morse.builder import Environment, Pose, Robot
from morse.mathutils import Vector
from morse.scene import PhysicsType

ROBOT = """<robot name="crane"><link name="base"><inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0"
  ixz="0" iyz="0"/></inertial><visual><geometry><mesh filename="package://crane_description/meshes/box.stl"/></geometry></visual>
  </link><link name="hook"/><joint name="turn" type="revolute"><parent link="base"/><child link="hook"/>
  <origin rpy="$(optenv CRANE_TILT 0 0.5 0)"/><limit lower="-1e+16" upper="inf" effort="5" velocity="1"/>
  </joint></robot>"""


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A clone of a package into a folder of another name."""
    folder = tmp_path / "src" / "clone-of-crane"
    (folder / "meshes").mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name> crane_description </name></package>")
    trimesh.creation.box((0.1, 0.1, 0.1)).export(folder / "meshes" / "box.stl")
    return folder


def meshes(library) -> list[str]:
    return [node.name for node in library.nodes() if node.mesh is not None]


def test_a_package_has_the_name_in_its_package_xml(package: Path) -> None:
    (package / "urdf").mkdir()
    (package / "urdf" / "crane.urdf").write_text(ROBOT)
    library = read_urdf(package / "urdf" / "crane.urdf")
    assert meshes(library)
    assert library.warnings == []


@pytest.mark.parametrize("name", ["a%20box.stl", "a box.stl", "100%25.stl", "100%.stl"])
def test_uris_may_have_encoded_letters(package: Path, name: str) -> None:
    for own in ("a box.stl", "100%.stl"):
        (package / "meshes" / own).write_bytes((package / "meshes" / "box.stl").read_bytes())
    (package / "crane.urdf").write_text(ROBOT.replace("box.stl", name))
    library = read_urdf(package / "crane.urdf")
    assert meshes(library)
    assert library.warnings == []


def test_encoded_letters_lead_out_of_no_package(package: Path, tmp_path: Path) -> None:
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "secret.stl")
    (package / "crane.urdf").write_text(ROBOT.replace("meshes/box.stl", "%2e%2e/%2e%2e/secret.stl"))
    assert not meshes(read_urdf(package / "crane.urdf"))


def test_a_text_in_capitals_is_stl(package: Path) -> None:
    box = package / "meshes" / "box.stl"
    text = trimesh.load(box).export(file_type="stl_ascii")
    box.write_bytes(text.upper().replace("\n", "\r\n").encode())
    (package / "crane.urdf").write_text(ROBOT)
    library = read_urdf(package / "crane.urdf")
    assert meshes(library)
    assert library.warnings == []


@pytest.mark.parametrize("variable", ["ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"])
def test_packages_elsewhere_are_listed_by_variables(tmp_path: Path, package: Path, monkeypatch, variable: str) -> None:
    (tmp_path / "robots" / "deep" / "in" / "folders").mkdir(parents=True)
    file = tmp_path / "robots" / "deep" / "in" / "folders" / "crane.urdf"
    file.write_text(ROBOT.replace("crane_description", "other_description"))
    assert not meshes(read_urdf(file))
    (package / "package.xml").write_text("<package><name>other_description</name></package>")
    listed = package.parent
    if variable == "AMENT_PREFIX_PATH":
        (tmp_path / "opt").mkdir()
        package.parent.rename(tmp_path / "opt" / "share")
        listed = tmp_path / "opt"
    monkeypatch.setenv(variable, str(listed))
    assert meshes(read_urdf(file))


def test_limits_that_are_no_limits_and_substitutions(package: Path) -> None:
    file = package / "crane.urdf"
    file.write_text(ROBOT)
    (turn,) = load(file, {"CRANE_TILT": "0 0 0.25"}).roots[0].children[0].bones
    assert not turn.dynamics.limited
    assert turn.dynamics.effort == 5.0
    file.write_text(ROBOT.replace("optenv CRANE_TILT 0 0.5 0", "env NO_SUCH_TILT"))
    with pytest.raises(AssetError, match=r"no environment variables: give NO_SUCH_TILT as in .*arguments="):
        read_urdf(file)


XACRO = """<robot name="legs" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="count" default="2"/>
<xacro:include filename="$(find crane_description)/leg.xacro"/><link name="base"/>
<xacro:property name="length" value="${2*0.1}"/><xacro:leg name="a"/>
<xacro:if value="${$(arg count) > 1}"><xacro:leg name="b"/></xacro:if></robot>"""
LEG = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro name="leg" params="name"><link name="${name}"/>
<joint name="hip_${name}" type="continuous"><parent link="base"/><child link="${name}"/><origin xyz="0 0 ${length}"/>
</joint></xacro:macro></robot>"""


def test_macros_are_expanded(package: Path) -> None:
    pytest.importorskip("xacro")
    (package / "leg.xacro").write_text(LEG)
    file = package / "robot.urdf.xacro"
    file.write_text(XACRO)
    assert [bone.name for bone in load(file).roots[0].children[0].bones] == ["hip_a", "hip_b"]
    bones = load(file, {"count": "1"}).roots[0].children[0].bones
    assert [(bone.name, bone.position[2]) for bone in bones] == [("hip_a", pytest.approx(0.2))]
    file.write_text(XACRO.replace("crane_description", "gone"))
    with pytest.raises(AssetError, match=r"robot.urdf.xacro: \$\(find gone\): there is no package 'gone'"):
        load(file)
    with pytest.raises(AssetError, match="no links: load the file that includes it"):
        load(package / "leg.xacro")


@pytest.mark.parametrize("text", ["1e+09", "inf", "0", "-1", "1e300"])
def test_efforts_and_speeds_that_are_no_limits(package: Path, text: str) -> None:
    file = package / "crane.urdf"
    file.write_text(ROBOT.replace('effort="5" velocity="1"', f'effort="{text}" velocity="{text}"'))
    (turn,) = read_urdf(file).roots[0].children[0].bones
    assert (turn.dynamics.effort, turn.dynamics.speed) == (math.inf, math.inf)


def test_a_capsule_stands_on_its_round_end(package: Path) -> None:
    file = package / "pill.urdf"
    capsule = '<geometry><capsule radius="0.1" length="0.4"/></geometry>'
    file.write_text(
        f"""<robot name="pill"><link name="base"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0"
        ixz="0" iyz="0"/></inertial><collision>{capsule}</collision><visual>{capsule}</visual></link></robot>"""
    )
    scene = f"robot = Robot({str(file)!r})\nrobot.translate(z=0.31)\nenv = Environment('empty')\n"
    script = package / "default.py"
    script.write_text(f"from morse.builder import *\n{scene}")
    with morse.load(script) as simulation:
        simulation.step(60)
        # half of the length and the radius
        assert simulation.robot.component.position_3d.z == pytest.approx(0.3, abs=2e-3)


def test_a_world_that_is_not_declared_fixes_the_robot(package: Path) -> None:
    file = package / "arm.urdf"
    file.write_text("""<robot name="arm"><link name="base"><inertial><mass value="2"/></inertial></link>
      <joint name="weld" type="fixed"><parent link="world"/><child link="base"/></joint></robot>""")
    assert load(file).roots[0].body.type is PhysicsType.STATIC


CHAIN = """<robot name="r"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
  <joint name="first" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="second" type="Revolute"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
    <origin xyz="1 0 0" rpy=""/><limit lower="-1" upper="1" effort="1" velocity="1"/>
    <mimic joint="first" multiplier="2" offset="0.5"/></joint>
  <joint name="third" type="revolute"><parent link="c"/><child link="d"/><axis xyz="0 0 1"/>
    <mimic joint="{leader}" multiplier="-3" offset="0.25"/></joint></robot>"""


def test_a_chain_of_joints_that_follow_each_other(tmp_path) -> None:
    (tmp_path / "r.urdf").write_text(CHAIN.format(leader="second"))
    library = load(tmp_path / "r.urdf")
    bones = [bone for node in library.nodes() for bone in node.bones]
    third = next(bone for bone in bones if bone.name == "third")
    # -3 (2 first + 0.5) + 0.25
    assert (bones[third.leader].name, third.factor, third.offset) == ("first", -6.0, -1.25)
    assert not library.warnings


def test_a_joint_that_follows_itself_moves_by_itself_and_has_no_limits(tmp_path) -> None:
    (tmp_path / "r.urdf").write_text(CHAIN.format(leader="third"))
    library = load(tmp_path / "r.urdf")
    third = next(bone for node in library.nodes() for bone in node.bones if bone.name == "third")
    assert (third.leader, third.low < -1e3, third.high > 1e3, third.dynamics.limited) == (-1, True, True, False)
    assert library.warnings == ["the joint 'third' cannot follow 'third'; it moves by itself"]


ENDLESS = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="${%s}"/></robot>'


@pytest.mark.parametrize(
    ("expression", "words"), [("9**9**9**9", "needs more than 3 s"), ("len('a'*10**11)", "xacro cannot expand it")]
)
def test_expressions_of_a_file_cannot_take_all_time_or_memory(tmp_path, monkeypatch, expression, words) -> None:
    pytest.importorskip("xacro")
    monkeypatch.setattr("morse.assets.urdf.expansion.TIME_LIMIT", 3.0)
    (tmp_path / "r.urdf.xacro").write_text(ENDLESS % expression)
    with pytest.raises(AssetError, match=words):
        load(tmp_path / "r.urdf.xacro")


def _glb(path: Path, size: tuple[float, float, float], transform: object = None) -> None:
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.box(size), transform=transform)
    path.write_bytes(trimesh.exchange.gltf.export_glb(scene))


@pytest.mark.parametrize("suffix", ["glb", "obj", "stl"])
def test_meshes_of_all_formats_have_the_axes_of_the_link(tmp_path, suffix) -> None:
    """A box of 0.2 x 0.4 x 1 m stands upright in each of them, also as glTF."""
    box = trimesh.creation.box((0.2, 0.4, 1.0))
    if suffix == "glb":
        _glb(tmp_path / "box.glb", (0.2, 0.4, 1.0))
    else:
        box.export(tmp_path / f"box.{suffix}")
    mesh = f'<geometry><mesh filename="box.{suffix}"/></geometry>'
    (tmp_path / "r.urdf").write_text(
        f'<robot name="r"><link name="base"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" '
        f'ixz="0" iyz="0"/></inertial><visual>{mesh}</visual><collision>{mesh}</collision></link></robot>'
    )

    def scene() -> None:
        robot = Robot(str(tmp_path / "r.urdf"), name="r")
        robot.append(Pose("pose"))
        robot.translate(z=0.7)
        Environment("empty")

    with morse.load(scene) as simulation:
        simulation.step(120)
        assert simulation.r.pose.get()["z"] == pytest.approx(0.5, abs=2e-3)


def test_rotations_within_a_gltf_file_apply(tmp_path) -> None:
    turn = trimesh.transformations.rotation_matrix(np.pi / 2, (1, 0, 0))
    _glb(tmp_path / "box.glb", (0.2, 0.4, 1.0), turn)
    (tmp_path / "r.urdf").write_text(
        '<robot name="r"><link name="base"><visual><geometry><mesh filename="box.glb"/></geometry></visual></link>'
        "</robot>"
    )
    (node,) = [node for node in load(tmp_path / "r.urdf").nodes() if node.mesh is not None]
    corners = np.array([list(node.world_matrix() @ Vector(corner)) for corner in node.mesh.vertices.tolist()])
    assert np.ptp(corners, axis=0) == pytest.approx([0.2, 1.0, 0.4], abs=1e-6)


@pytest.mark.parametrize("mass", [None, 12.0])
def test_a_robot_whose_file_has_no_masses_weighs_1_kg_by_volume(tmp_path, mass) -> None:
    cube = '<link name="{}"><collision><geometry><box size="{} 1 1"/></geometry></collision></link>'
    (tmp_path / "r.urdf").write_text(
        f'<robot name="r">{cube.format("a", 1)}{cube.format("b", 2)}<joint name="j" type="continuous">'
        '<parent link="a"/><child link="b"/><origin xyz="0 0 2"/><axis xyz="0 1 0"/></joint></robot>'
    )

    def scene() -> None:
        robot = Robot(str(tmp_path / "r.urdf"), name="r")
        if mass is not None:
            robot.set_mass(mass)
        Environment("empty")

    with morse.load(scene) as simulation:
        model = simulation.context.world.model
        masses = {model.body(i).name: model.body(i).mass[0] for i in range(1, model.nbody)}
    heavy = sorted(value for value in masses.values() if value > 0.0)
    assert heavy == pytest.approx([(mass or 1.0) / 3, (mass or 1.0) * 2 / 3], rel=1e-9)


def test_a_robot_with_mass_and_without_collision_falls(tmp_path) -> None:
    (tmp_path / "r.urdf").write_text(
        '<robot name="r"><link name="base"><inertial><mass value="3"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" '
        'iyz="0"/></inertial><visual><geometry><box size="1 1 1"/></geometry></visual></link></robot>'
    )

    def scene() -> None:
        robot = Robot(str(tmp_path / "r.urdf"), name="r")
        robot.append(Pose("pose"))
        robot.translate(z=50.0)
        env = Environment("empty")
        env.set_gravity(9.81)

    with morse.load(scene) as simulation:
        simulation.step(60)
        # half g t², with the steps of the integrator
        assert simulation.r.pose.get()["z"] == pytest.approx(50.0 - 0.5 * 9.81, abs=0.15)
