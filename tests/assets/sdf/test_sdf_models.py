"""Models from SDF files: poses of links against kinematics of the test, joints, masses."""

import math
from xml.etree import ElementTree

import kinematics
import mujoco
import numpy as np
import pytest

import morse
from morse.assets import load
from morse.assets.sdf import read_sdf
from morse.mathutils import Vector
from morse.physics import World
from morse.scene import JointKind, PhysicsType, Scene, ShapeKind
from morse.scene.articulation import ConstraintKind

LINK = "<inertial><mass>1</mass></inertial>"
FRAMES = """<sdf version="1.9"><model name="tower" canonical_link="b">
  <pose>1 2 3 0.1 0.2 0.3</pose>
  <frame name="stand"><pose degrees="true">0.1 0 0.2 30 -20 75</pose></frame>
  <frame name="shelf" attached_to="a"><pose>0 0.3 0 0 1.5707963267948966 0.4</pose></frame>
  <frame name="far" attached_to="inner::tip"><pose relative_to="elbow">0 0 1 0.5 0 0</pose></frame>
  <link name="a"><pose relative_to="stand">0.5 0.4 0.3 0.2 0.1 -3</pose></link>
  <link name="b"><pose relative_to="shelf">0 0 0.25 1 2 3</pose></link>
  <link name="c"><pose relative_to="far">0.1 0.1 0.1 0 -1.5707963 0</pose></link>
  <link name="d"><pose relative_to="inner::tip">0.1 0 0 0 0 0</pose></link>
  <model name="inner" placement_frame="grip">
    <pose relative_to="b">0.2 0.2 0.2 0.3 0.3 0.3</pose>
    <frame name="grip" attached_to="root"><pose>0.05 0 0 0 0 1</pose></frame>
    <link name="root"><pose>0 0 0.1 0 0.7 0</pose></link>
    <link name="tip"><pose relative_to="root">0.3 0 0 -0.4 0 0</pose></link>
    <joint name="wrist" type="revolute"><pose>0 0.02 0 0.3 0 0</pose><parent>root</parent><child>tip</child>
      <axis><xyz expressed_in="__model__">0 1 1</xyz><limit><lower>-1</lower><upper>2</upper></limit></axis></joint>
  </model>
  <joint name="shoulder" type="prismatic"><parent>a</parent><child>b</child>
    <axis><xyz>1 0 0</xyz><limit><lower>-0.5</lower><upper>0.5</upper></limit></axis></joint>
  <joint name="elbow" type="revolute"><pose relative_to="shelf">0 0.1 0 0 0 0.2</pose>
    <parent>b</parent><child>inner::grip</child><axis><xyz expressed_in="stand">0 0 -1</xyz></axis></joint>
  <joint name="weld" type="fixed"><parent>inner</parent><child>c</child></joint>
  <joint name="ball" type="ball"><parent>c</parent><child>d</child></joint>
</model></sdf>"""


def read(tmp_path, text, name="model.sdf"):
    path = tmp_path / name
    path.write_text(text)
    return read_sdf(path)


def nodes_of(library):
    return {node.name: node for node in library.nodes()}


def bones_of(library):
    return {bone.name: bone for node in library.nodes() for bone in node.bones}


def test_links_are_where_independent_kinematics_puts_them(tmp_path) -> None:
    library = read(tmp_path, FRAMES)
    model = ElementTree.fromstring(FRAMES).find("model")
    outer, nodes = kinematics.pose(model.find("pose")), nodes_of(library)
    wanted = kinematics.link_poses(model)
    assert set(wanted) == {"a", "b", "c", "d", "inner::root", "inner::tip"}
    for name, place in wanted.items():
        assert np.array(nodes[name].world_matrix()) == pytest.approx(outer @ place, abs=1e-12), name
    kinds = {name: bone.kind for name, bone in bones_of(library).items()}
    assert kinds == {
        "shoulder": JointKind.PRISMATIC, "elbow": JointKind.REVOLUTE, "inner::wrist": JointKind.REVOLUTE,
        "weld": JointKind.FIXED, "ball": JointKind.BALL,
    }  # fmt: skip


def test_joints_move_about_their_axes(tmp_path) -> None:
    library = read(tmp_path, FRAMES)
    (root,) = library.roots
    model = ElementTree.fromstring(FRAMES).find("model")
    world = World(Scene(roots=[root]))
    joints = world.object_of(root.children[0]).joints()
    for name, value in {"shoulder": 0.3, "elbow": 0.7, "inner::wrist": -0.6}.items():
        joints.positions((name,))
        world.data.qpos[joints._qpos] = value
    mujoco.mj_kinematics(world.model, world.data)
    world.sync()
    # the canonical link stays, and with it the frame of the model; all is computed relative to it
    axis = kinematics.frame(model, "stand")[:3, :3] @ [0.0, 0.0, -1.0]
    elbow = _turned(kinematics.frame(model, "elbow")[:3, 3], axis, 0.7)
    inner = kinematics.frame(model, "inner")
    place = inner @ kinematics.frame(model.find("model"), "wrist")
    wrist = _turned(place[:3, 3], inner[:3, :3] @ [0.0, math.sqrt(0.5), math.sqrt(0.5)], -0.6)
    links = kinematics.link_poses(model)
    slid = np.eye(4)
    slid[:3, 3] = -0.3 * links["b"][:3, 0]
    wanted = {"b": links["b"], "a": slid @ links["a"], "inner::root": elbow @ links["inner::root"],
              "c": elbow @ links["c"], "inner::tip": elbow @ wrist @ links["inner::tip"]}  # fmt: skip
    outer = kinematics.pose(model.find("pose"))
    nodes = nodes_of(library)
    for name, pose in wanted.items():
        position, rotation = world.object_of(nodes[name]).world_pose()
        assert position == pytest.approx((outer @ pose)[:3, 3], abs=1e-12), name
        assert rotation == pytest.approx((outer @ pose)[:3, :3].ravel(), abs=1e-12), name


def _turned(point, axis, angle):
    """4x4 rotation about a line (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    result = np.eye(4)
    result[:3, :3] += math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    result[:3, 3] = point - result[:3, :3] @ point
    return result


@pytest.mark.parametrize(
    ("version", "attributes", "frame"),
    [
        ("1.4", "", "model"),
        ("1.5", "", "joint"),
        ("1.6", "<use_parent_model_frame>true</use_parent_model_frame>", "model"),
        ("1.6", "<use_parent_model_frame>0</use_parent_model_frame>", "joint"),
        ("1.8", "", "joint"),
    ],
)
def test_the_frame_of_axes_depends_on_the_version(tmp_path, version, attributes, frame) -> None:
    quarter = math.pi / 2
    text = f"""<sdf version="{version}"><model name="m"><link name="a">{LINK}</link>
      <link name="b"><pose>0 0 1 0 0 {quarter}</pose>{LINK}</link>
      <joint name="j" type="revolute"><parent>a</parent><child>b</child>
        <axis><xyz>1 0 0</xyz>{attributes}</axis></joint></model></sdf>"""
    bone = bones_of(read(tmp_path, text))["j"]
    axis = [bone.rotation[2], bone.rotation[5], bone.rotation[8]]  # the Z axis of the bone, in the model
    assert axis == pytest.approx([1, 0, 0] if frame == "model" else [0, 1, 0], abs=1e-12)


def test_masses_and_inertias(tmp_path) -> None:
    text = """<sdf version="1.7"><model name="m"><link name="a"><inertial><pose>0.1 0 0 0 0 1.5707963267948966</pose>
      <mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.2</iyy><izz>0.25</izz></inertia></inertial>
      <collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision></link></model></sdf>"""
    (root,) = read(tmp_path, text).roots
    model = World(Scene(roots=[root])).model
    body = model.body("m")
    assert body.mass[0] == 2.0
    assert body.ipos == pytest.approx([0.1, 0, 0], abs=1e-12)
    # turned by a quarter, X and Y are exchanged
    matrix = np.zeros(9)
    mujoco.mju_quat2Mat(matrix, body.iquat)
    axes = matrix.reshape(3, 3)
    assert axes @ np.diag(body.inertia) @ axes.T == pytest.approx(np.diag([0.2, 0.1, 0.25]), abs=1e-9)


def test_a_link_without_a_mass_has_that_of_the_specification(tmp_path) -> None:
    text = '<sdf version="1.7"><model name="m"><link name="a"/></model></sdf>'
    inertial = nodes_of(read(tmp_path, text))["a"].inertial
    assert inertial.mass == 1.0
    assert inertial.inertia == pytest.approx((1, 0, 0, 0, 1, 0, 0, 0, 1))


def test_all_kinds_of_joints(tmp_path) -> None:
    kinds = ["revolute", "continuous", "prismatic", "fixed", "ball", "universal", "revolute2", "screw"]
    links = "".join(f'<link name="{kind}">{LINK}</link>' for kind in kinds)
    joints = "".join(
        f"""<joint name="j_{kind}" type="{kind}"><parent>base</parent><child>{kind}</child>
        <axis><xyz>0 0 1</xyz><limit><lower>-1</lower><upper>1</upper><effort>5</effort></limit>
        <dynamics><damping>0.5</damping><friction>0.1</friction></dynamics></axis><axis2><xyz>0 1 0</xyz></axis2>
        <screw_thread_pitch>0.01</screw_thread_pitch></joint>"""
        for kind in kinds
    )
    library = read(
        tmp_path, f'<sdf version="1.10"><model name="m"><link name="base">{LINK}</link>{links}{joints}</model></sdf>'
    )
    bones = bones_of(library)
    found = {name: bone.kind.value for name, bone in bones.items()}
    assert found == {
        "j_revolute": "revolute", "j_continuous": "revolute", "j_prismatic": "prismatic", "j_fixed": "fixed",
        "j_ball": "ball", "j_universal": "revolute", "j_universal_axis2": "revolute", "j_revolute2": "revolute",
        "j_revolute2_axis2": "revolute", "j_screw": "revolute", "j_screw_axis2": "prismatic",
    }  # fmt: skip
    assert (bones["j_revolute"].low, bones["j_revolute"].high) == (-1.0, 1.0)
    assert not bones["j_continuous"].dynamics.limited
    dynamics = bones["j_revolute"].dynamics
    assert (dynamics.effort, dynamics.damping, dynamics.friction) == (5.0, 0.5, 0.1)
    slide = bones["j_screw_axis2"]
    assert list(bones)[slide.leader] == "j_screw"
    assert slide.factor == pytest.approx(0.01 / (2 * math.pi), rel=1e-12)
    assert library.warnings == []


TWO_AXES = """<sdf version="1.10"><model name="m" canonical_link="{first}">
  <link name="a"><pose>0 0 1 0.1 0.2 0.3</pose>{mass}</link><link name="c"><pose>0.5 0 1 0.4 0 0.2</pose>{mass}</link>
  <joint name="u" type="{kind}"><pose>0.1 0.2 0 0.3 0.1 0</pose><parent>a</parent><child>c</child>
  <axis><xyz>1 0 0</xyz><limit><lower>-0.1</lower><upper>0.2</upper><effort>3</effort></limit></axis>
  <axis2><xyz>0 1 0</xyz><limit><lower>-0.5</lower><upper>0.6</upper><effort>7</effort></limit></axis2>
  <screw_thread_pitch>0.01</screw_thread_pitch></joint></model></sdf>"""


def chain_of(bones, values) -> np.ndarray:
    """4x4 of the last of a chain of bones, which turn about or move along their Z axes."""
    result = np.eye(4)
    for bone in bones:
        frame, move = np.eye(4), np.eye(4)
        frame[:3, :3], frame[:3, 3] = np.reshape(bone.rotation, (3, 3)), bone.position
        cosine, sine = math.cos(values[bone.name]), math.sin(values[bone.name])
        if bone.kind is JointKind.PRISMATIC:
            move[2, 3] = values[bone.name]
        else:
            move[:2, :2] = [[cosine, -sine], [sine, cosine]]
        result = result @ frame @ move
    return result


@pytest.mark.parametrize("kind", ["universal", "revolute2", "screw"])
def test_a_joint_of_two_axes_is_the_same_from_both_sides(tmp_path, kind) -> None:
    zero, values = dict.fromkeys(("u", "u_axis2"), 0.0), {"u": 0.15, "u_axis2": -0.3}
    relative = {}
    for first, last in ("ac", "ca"):
        library = read(tmp_path, TWO_AXES.format(first=first, mass=LINK, kind=kind), f"{first}.sdf")
        bones = bones_of(library)
        assert set(bones) == {"u", "u_axis2"}
        if kind != "screw":
            assert (bones["u"].low, bones["u"].high, bones["u"].dynamics.effort) == (-0.1, 0.2, 3.0)
            assert (bones["u_axis2"].low, bones["u_axis2"].high, bones["u_axis2"].dynamics.effort) == (-0.5, 0.6, 7.0)
        chain = list(bones.values())
        poses = {name: kinematics.pose(ElementTree.fromstring(f"<pose>{text}</pose>"))
                 for name, text in (("a", "0 0 1 0.1 0.2 0.3"), ("c", "0.5 0 1 0.4 0 0.2"))}  # fmt: skip
        between = np.linalg.inv(poses[first]) @ poses[last]
        relative[first] = chain_of(chain, values) @ np.linalg.inv(chain_of(chain, zero)) @ between
    assert relative["a"] @ relative["c"] == pytest.approx(np.eye(4), abs=1e-9)
    if kind != "screw":
        # the first axis is that of the joint in its parent, the second one turns with it
        anchor = poses["c"] @ kinematics.pose(ElementTree.fromstring("<pose>0.1 0.2 0 0.3 0.1 0</pose>"))
        turn = kinematics.pose(ElementTree.fromstring("<pose>0 0 0 0.15 0 0</pose>")) @ kinematics.pose(
            ElementTree.fromstring("<pose>0 0 0 0 -0.3 0</pose>")
        )
        expected = np.linalg.inv(poses["a"]) @ anchor @ turn @ np.linalg.inv(anchor) @ poses["c"]
        assert relative["a"] == pytest.approx(expected, abs=1e-9)


def test_names_that_are_made_leave_those_of_the_file_alone(tmp_path) -> None:
    names = ("base", "u_middle", "u_middle_2", "top", "loose", "u_axis2")
    links = "".join(f'<link name="{name}">{LINK}</link>' for name in names)
    joints = "".join(
        f'<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child>'
        "<axis><xyz>0 0 1</xyz></axis><axis2><xyz>0 1 0</xyz></axis2></joint>"
        for name, kind, parent, child in (
            ("u", "universal", "base", "u_middle"),
            ("u_axis2", "prismatic", "u_middle", "u_middle_2"),
            ("loose_free", "revolute", "base", "top"),
            ("s", "screw", "top", "u_axis2"),
        )
    )
    path = tmp_path / "m.sdf"
    path.write_text(f'<sdf version="1.10"><model name="m">{links}{joints}</model></sdf>')
    library = read_sdf(path)
    bones = bones_of(library)
    kinds = {"u": JointKind.REVOLUTE, "u_axis2": JointKind.PRISMATIC, "loose_free": JointKind.REVOLUTE}
    assert {name: bones[name].kind for name in kinds} == kinds
    assert len(bones) == 7
    assert set(names) <= {node.name for node in library.nodes()}
    script = tmp_path / "scene.py"
    script.write_text(f"from morse.builder import *\nrobot = Robot({str(path)!r})\nenv = Environment('empty')\n")
    with morse.load(script) as simulation:
        simulation.step(2)


def test_a_loop_is_closed_by_constraints(tmp_path) -> None:
    joints = "".join(
        f'<joint name="{a}{b}" type="revolute"><parent>{a}</parent><child>{b}</child>'
        "<axis><xyz>0 1 0</xyz></axis></joint>"
        for a, b in ("ab", "bc", "ad", "dc")
    )
    links = "".join(f'<link name="{name}">{LINK}</link>' for name in "abcd")
    library = read(tmp_path, f'<sdf version="1.7"><model name="m">{links}{joints}</model></sdf>')
    assert len(bones_of(library)) == 3
    constraints = library.roots[0].children[0].articulation.couplings.constraints
    assert [one.kind for one in constraints] == [ConstraintKind.CONNECT] * 2
    assert all({one.one, one.other} == {"d", "c"} for one in constraints)


def test_links_without_joints_move_freely(tmp_path) -> None:
    text = f"""<sdf version="1.7"><model name="m"><link name="a">{LINK}</link>
      <link name="b"><pose>0 0 1 0 0 0</pose>{LINK}</link></model></sdf>"""
    library = read(tmp_path, text)
    assert {name: bone.kind for name, bone in bones_of(library).items()} == {"b_free": JointKind.FLOATING}


@pytest.mark.parametrize("how", ["static", "joint"])
def test_fixed_models(tmp_path, how) -> None:
    extra = "<static>true</static>" if how == "static" else (
        '<joint name="w" type="fixed"><parent>world</parent><child>a</child></joint>'
    )  # fmt: skip
    library = read(
        tmp_path,
        f'<sdf version="1.7"><model name="m">{extra}<link name="a"><pose>0 0 1 0 0 0</pose>{LINK}</link></model></sdf>',
    )
    assert library.roots[0].body.type is PhysicsType.STATIC
    assert list(nodes_of(library)["a"].world_matrix().translation) == pytest.approx([0, 0, 1])


def test_a_link_with_the_name_of_the_world_is_the_world(tmp_path) -> None:
    text = f"""<sdf version="1.6"><model name="world"><link name="a">{LINK}</link><link name="world"/>
      <link name="b"><pose>0 0 1 0 0 0</pose>{LINK}</link>
      <joint name="j" type="revolute"><parent>a</parent><child>b</child><axis><xyz>0 1 0</xyz></axis></joint>
      <joint name="w" type="fixed"><parent>world</parent><child>a</child></joint></model></sdf>"""
    library = read(tmp_path, text)
    assert library.roots[0].body.type is PhysicsType.STATIC
    assert World(Scene(roots=library.roots)).model.njnt == 1


SHAPES = {
    "<box><size>1 2 3</size></box>": (ShapeKind.BOX, (0.5, 1.0, 1.5)),
    "<sphere><radius>0.5</radius></sphere>": (ShapeKind.SPHERE, (0.5,)),
    "<cylinder><radius>0.5</radius><length>2</length></cylinder>": (ShapeKind.CYLINDER, (0.5, 1.0)),
    "<capsule><radius>0.5</radius><length>2</length></capsule>": (ShapeKind.CAPSULE, (0.5, 1.0)),
    "<ellipsoid><radii>1 2 3</radii></ellipsoid>": (ShapeKind.ELLIPSOID, (1.0, 2.0, 3.0)),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_primitives_collide_as_what_they_are(tmp_path, shape) -> None:
    text = f"""<sdf version="1.9"><model name="m"><link name="a"><collision name="c"><geometry>{shape}</geometry>
      </collision><visual name="v"><geometry>{shape}</geometry></visual></link></model></sdf>"""
    library = read(tmp_path, text)
    (solid,) = (node for node in library.nodes() if node.shapes)
    assert [(one.kind, one.size) for one in solid.shapes] == [SHAPES[shape]]
    assert not solid.visible
    (seen,) = (node for node in library.nodes() if node.mesh is not None and node.visible)
    points = np.array([list(seen.world_matrix() @ Vector(p)) for p in seen.mesh.vertices.tolist()])
    kind, size = SHAPES[shape]
    half = {"box": size, "ellipsoid": size, "sphere": size * 3}.get(kind.value)
    half = half or (size[0], size[0], size[1] + (size[0] if kind is ShapeKind.CAPSULE else 0.0))
    assert points.max(axis=0) == pytest.approx(half, rel=1e-6)


def test_a_model_stands_and_its_sensors_measure(tmp_path) -> None:
    path = tmp_path / "stool" / "model.sdf"
    path.parent.mkdir()
    path.write_text("""<sdf version="1.7"><model name="stool"><link name="seat"><pose>0 0 0.25 0 0 0</pose>
      <inertial><mass>4</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial>
      <collision name="c"><geometry><box><size>0.4 0.4 0.5</size></box></geometry></collision>
      <sensor name="imu" type="imu"><pose>0 0 0.1 0 0 0</pose><update_rate>60</update_rate></sensor></link>
    </model></sdf>""")
    (path.parent / "model.config").write_text('<model><name>stool</name><sdf version="1.7">model.sdf</sdf></model>')
    scene = tmp_path / "scene.py"
    scene.write_text(f"""from morse.builder import *
robot = Robot({str(path.parent)!r})
pose = Pose()
robot.append(pose)
env = Environment('empty')
""")
    with morse.load(scene) as simulation:
        simulation.step(120)
        assert simulation.robot.pose.get()["z"] == pytest.approx(0.0, abs=2e-3)
        assert simulation.robot.imu.get()["linear_acceleration"][2] == pytest.approx(9.81, rel=1e-2)


def test_models_of_a_world_are_loaded_once_each(tmp_path) -> None:
    path = tmp_path / "world.sdf"
    path.write_text(f"""<sdf version="1.7"><world name="w">
      <model name="crate"><link name="l">{LINK}</link></model>
      <model name="crate_2"><static>1</static><link name="l">{LINK}</link></model></world></sdf>""")
    assert [root.name for root in load(path).roots] == ["crate", "crate_2"]


def test_a_four_bar_linkage_is_as_stiff_as_its_joints(tmp_path) -> None:
    """Crank 0.2 m, coupler 0.5 m, rocker 0.4 m, 0.5 m between the pivots: the angle of the rocker from geometry."""
    a, b, c, g, start = 0.2, 0.5, 0.4, 0.5, 0.5

    def rocker(crank: float) -> tuple[float, float, float]:
        """The end of the coupler, m, and the angle of the rocker, rad."""
        x, y = g - a * math.cos(crank), -a * math.sin(crank)
        far = math.hypot(x, y)
        along = (b * b - c * c + far * far) / (2.0 * far)
        up = math.sqrt(b * b - along * along)
        end = a * math.cos(crank) + (along * x - up * y) / far, a * math.sin(crank) + (along * y + up * x) / far
        return *end, math.atan2(end[1], end[0] - g)

    def link(name: str, x: float, z: float, angle: float, length: float) -> str:
        inertia = "<inertia><ixx>0.001</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia>"
        return f"""<link name="{name}"><pose>{x} 0 {z + 1.0} 0 {-angle} 0</pose><inertial><mass>0.5</mass>
          <pose>{length / 2} 0 0 0 0 0</pose>{inertia}</inertial></link>"""

    def hinge(name: str, parent: str, child: str, pose: str = "") -> str:
        return f"""<joint name="{name}" type="revolute"><parent>{parent}</parent><child>{child}</child>{pose}
          <axis><xyz expressed_in="__model__">0 -1 0</xyz></axis></joint>"""

    x, y, angle = rocker(start)
    pin = a * math.cos(start), a * math.sin(start)
    (tmp_path / "bars.sdf").write_text(f"""<sdf version="1.9"><model name="bars"><link name="base"/>
      <joint name="ground" type="fixed"><parent>world</parent><child>base</child></joint>
      {link("crank", 0, 0, start, a)}{link("coupler", *pin, math.atan2(y - pin[1], x - pin[0]), b)}
      {link("rocker", g, 0, angle, c)}{hinge("drive", "base", "crank")}{hinge("pin", "crank", "coupler")}
      {hinge("rock", "base", "rocker")}
      {hinge("close", "rocker", "coupler", f'<pose relative_to="coupler">{b} 0 0 0 0 0</pose>')}</model></sdf>""")
    (tmp_path / "scene.py").write_text(
        f"from morse.builder import *\nrobot = Robot({str(tmp_path / 'bars.sdf')!r})\n"
        "arm = Armature(armature_name='bars_joints')\narm.control('velocity', ['drive'])\n"
        "arm.control('effort', ['pin', 'rock'])\nrobot.append(arm)\nenv = Environment('empty')\n"
    )
    with morse.load(tmp_path / "scene.py") as sim:
        joints = [sim.world.data.joint(f"robot.arm/{name}") for name in ("drive", "rock")]
        sim.robot.arm.publish({"drive": 2.0})
        sim.step(3)  # the motor brings the crank to this speed within a tick
        for _ in range(240):
            sim.step(1)
            drive, rock = (float(joint.qpos[0]) for joint in joints)
            assert angle + rock == pytest.approx(rocker(start + drive)[2], abs=1e-3)
        assert drive == pytest.approx(8.1, abs=0.2)


def test_a_nut_turns_as_its_thread_says(tmp_path) -> None:
    inertia, lead = 0.04, 0.1
    pitch = lead / (2.0 * math.pi)
    (tmp_path / "screw.sdf").write_text(f"""<sdf version="1.9"><model name="screw"><link name="base"/>
      <joint name="ground" type="fixed"><parent>world</parent><child>base</child></joint>
      <link name="nut"><pose>0 0 2 0 0 0</pose><inertial><mass>1</mass>
      <inertia><ixx>{inertia}</ixx><iyy>{inertia}</iyy><izz>{inertia}</izz></inertia></inertial></link>
      <joint name="thread" type="screw"><parent>base</parent><child>nut</child><axis><xyz>0 0 1</xyz></axis>
      <screw_thread_pitch>{lead}</screw_thread_pitch></joint></model></sdf>""")
    (tmp_path / "scene.py").write_text(
        f"from morse.builder import *\nrobot = Robot({str(tmp_path / 'screw.sdf')!r})\n"
        "arm = Armature(armature_name='screw_joints')\narm.control('effort')\nrobot.append(arm)\n"
        "env = Environment('empty')\n"
    )
    with morse.load(tmp_path / "scene.py") as sim:
        sim.step(60)
        turn, fall = (float(value) for value in sim.world.data.qpos)
        assert fall / turn == pytest.approx(pitch, rel=1e-3)
        # of its weight, the thread leaves what its inertia takes; the steps of the engine add 0.4 % to a second
        assert -fall == pytest.approx(0.5 * 9.81 / (1.0 + inertia / pitch**2), rel=0.01)
