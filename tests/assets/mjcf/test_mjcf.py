"""Robots from MJCF files: links where the engine itself puts them, motors, masses, shapes and contacts."""

import math
from pathlib import Path

import mujoco
import numpy as np
import pytest
import trimesh

import morse
from morse.assets import load
from morse.assets.errors import AssetError
from morse.assets.mjcf import read_mjcf
from morse.assets.mjcf.source import Source
from morse.mathutils.portable import linear_light
from morse.physics import World
from morse.scene import Control, JointKind, PhysicsType, Scene, ShapeKind

MODEL = """
<mujoco model="crab">
  <compiler angle="degree" autolimits="true" meshdir="parts"/>
  <default>
    <joint damping="0.2" armature="0.01"/>
    <default class="shell"><geom rgba="0.9 0.1 0.1 1" friction="0.6"/></default>
  </default>
  <asset>
    <texture name="sky" type="2d" builtin="flat" width="100000000" height="100000000"/>
    <material name="steel" rgba="0.2 0.3 0.4 1" texture="sky"/>
    <mesh name="claw" file="claw.stl"/>
  </asset>
  <worldbody>
    <geom name="floor" type="plane" size="5 5 1"/>
    <body name="trunk" pos="0 0 0.6" euler="0 0 30">
      {free}
      <geom class="shell" type="box" size="0.2 0.1 0.05" mass="3"/>
      <camera name="eye" pos="0.2 0 0.05" euler="90 0 -90" fovy="50"/>
      <site name="head" pos="0.1 0 0"/>
      <body name="thigh" pos="0.2 0 0" euler="10 20 30">
        <joint name="yaw" axis="0 0 1" pos="0.01 0.02 0" range="-60 60" ref="20"/>
        <joint name="pitch" axis="0 1 0" range="-90 90" frictionloss="0.3"/>
        <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.03" material="steel"/>
        <body name="plate" pos="0.1 0 0.05" euler="0 45 0">
          <geom type="ellipsoid" size="0.05 0.04 0.03" contype="0" conaffinity="0"/>
          <body name="slider" pos="0.2 0 0">
            <joint name="slide" type="slide" axis="1 0 1" range="-0.1 0.1" stiffness="40" springref="0.05" ref="0.02"/>
            <geom type="mesh" mesh="claw"/>
          </body>
        </body>
        <body name="shin" pos="0.3 0 0">
          <joint name="knee" axis="0 1 0" range="-2 100"/>
          <geom type="cylinder" size="0.02 0.1" pos="0 0 -0.1"/>
          <body name="foot" pos="0 0 -0.2">
            <joint name="ankle" type="ball"/>
            <geom name="sole" type="sphere" size="0.04"/>
          </body>
        </body>
      </body>
      <body name="tail" pos="-0.2 0 0"><joint name="wag" axis="0 0 1"/><geom size="0.03"/></body>
    </body>
  </worldbody>
  <equality><joint joint1="wag" joint2="yaw" polycoef="0.1 0.5 0 0 0"/></equality>
  <contact><exclude body1="foot" body2="trunk"/><exclude body1="thigh" body2="trunk"/>
    <exclude body1="tail" body2="trunk"/></contact>
  <actuator>
    <position joint="pitch" kp="100" kv="3" gear="2" forcerange="-5 5"/>
    <velocity joint="knee" kv="4"/>
    <motor joint="slide" gear="3" ctrlrange="-2 2"/>
  </actuator>
  <sensor><accelerometer site="head"/><gyro site="head"/></sensor>
</mujoco>
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "parts").mkdir()
    trimesh.creation.box((0.1, 0.06, 0.04)).export(tmp_path / "parts" / "claw.stl")
    (tmp_path / "crab.xml").write_text(MODEL.format(free=""))
    (tmp_path / "free.xml").write_text(MODEL.format(free="<freejoint/>"))
    return tmp_path


def bones_of(library):
    return {bone.name: bone for bone in library.roots[0].children[0].bones}


def test_links_are_where_the_engine_puts_them(folder: Path) -> None:
    library = read_mjcf(folder / "crab.xml")
    (root,) = library.roots
    world = World(Scene(roots=[root]))
    text = MODEL.format(free="").replace('width="100000000" height="100000000"', 'width="10" height="10"')
    content = (folder / "parts" / "claw.stl").read_bytes()
    model = mujoco.MjModel.from_xml_string(text, {"parts/claw.stl": content})
    data = mujoco.MjData(model)
    handle = world.object_of(root.children[0]).joints()
    values = {"yaw": 0.3, "pitch": -0.4, "slide": 0.04, "knee": 0.9, "wag": 0.2}
    for name, value in values.items():
        handle.positions((name,))
        world.data.qpos[handle._qpos] = value
        data.joint(name).qpos = value
    mujoco.mj_kinematics(model, data)
    world.sync()
    for name in ("trunk", "thigh", "plate", "slider", "shin", "foot", "tail"):
        place, turned = world.object_of(next(node for node in library.nodes() if node.name == name)).world_pose()
        assert place == pytest.approx(data.body(name).xpos, abs=1e-9), name
        assert turned == pytest.approx(data.body(name).xmat, abs=1e-9), name
        assert world.model.body(f"crab_joints/{name}").subtreemass == pytest.approx(
            model.body(name).subtreemass, rel=1e-9
        )


def test_masses_are_those_of_the_engine(folder: Path) -> None:
    root = read_mjcf(folder / "free.xml").roots[0]
    assert root.body.type is PhysicsType.RIGID_BODY
    slider = next(node for node in root.walk() if node.name == "slider")
    # 0.1 x 0.06 x 0.04 m at 1000 kg/m^3
    assert slider.inertial.mass == pytest.approx(0.24, rel=1e-6)
    moments = np.linalg.eigvalsh(np.reshape(slider.inertial.inertia, (3, 3)))
    wanted = sorted(0.24 / 12 * (a * a + b * b) for a, b in ((0.1, 0.06), (0.1, 0.04), (0.06, 0.04)))
    assert moments == pytest.approx(wanted, rel=1e-5)


def test_joints_and_motors(folder: Path) -> None:
    bones = bones_of(read_mjcf(folder / "crab.xml"))
    assert list(bones) == ["yaw", "pitch", "slide", "knee", "ankle", "wag"]
    pitch, knee, slide, yaw = (bones[name] for name in ("pitch", "knee", "slide", "yaw"))
    # gear 2: the joint feels the force twice, and turns half as far
    moves = pitch.dynamics
    assert (moves.control, moves.gain, moves.slowing, moves.effort) == (Control.POSITION, 400.0, 12.0, 10.0)
    assert (moves.damping, moves.inertia, moves.friction) == (0.2, 0.01, 0.3)
    assert (knee.dynamics.control, knee.dynamics.gain) == (Control.VELOCITY, 4.0)
    assert (slide.dynamics.control, slide.dynamics.effort) == (Control.EFFORT, 6.0)
    assert (slide.dynamics.stiffness, slide.dynamics.rest) == (40.0, 0.05)
    assert yaw.dynamics.control is Control.EFFORT, "it has no motor"
    assert yaw.value == pytest.approx(math.radians(20))
    assert (yaw.low, yaw.high) == (pytest.approx(-math.pi / 3), pytest.approx(math.pi / 3))
    assert (bones["ankle"].kind, bones["ankle"].dynamics.limited) == (JointKind.BALL, False)
    # in degrees of the file: wag = 0 + 0.1 + 0.5 (yaw - 20 deg)
    assert (bones["wag"].factor, bones["wag"].offset) == (0.5, pytest.approx(0.1 - 0.5 * math.radians(20)))


def test_shapes_looks_and_contacts(folder: Path) -> None:
    library = read_mjcf(folder / "crab.xml")
    nodes = {node.name: node for node in library.nodes()}
    shapes = {child.parent.name: child for child in library.nodes() if child.mesh is not None}
    assert shapes["trunk"].shapes[0].kind is ShapeKind.BOX
    assert shapes["trunk"].shapes[0].size == (0.2, 0.1, 0.05)
    assert shapes["trunk"].materials[0].color == pytest.approx((*linear_light((0.9, 0.1, 0.1)), 1.0))
    assert shapes["thigh"].shapes[0].kind is ShapeKind.CAPSULE
    assert shapes["thigh"].shapes[0].size == pytest.approx((0.03, 0.15))
    assert np.ptp(shapes["thigh"].mesh.vertices, axis=0)[2] == pytest.approx(0.36)
    assert shapes["thigh"].materials[0].color == pytest.approx((*linear_light((0.2, 0.3, 0.4)), 1.0))
    assert shapes["plate"].shapes == [], "it collides with nothing"
    assert "floor" not in nodes
    assert ("trunk", "foot") in nodes["crab_joints"].articulation.apart
    model = World(Scene(roots=[library.roots[0]])).model
    assert model.geom("crab_joints/" + shapes["trunk"].name).friction[0] == 0.6


SCENE = """
from morse.builder import *
robot = Robot({file!r})
robot.translate(z=0.3)
arm = Armature(armature_name='crab_joints')
arm.control('position', ['yaw'])
robot.append(arm)
state = ArmaturePose()
arm.append(state)
env = Environment('empty')
"""


def test_a_script_drives_it(folder: Path) -> None:
    script = folder / "scene.py"
    script.write_text(SCENE.format(file=str(folder / "crab.xml")))
    with morse.load(script) as sim:
        told = sim.robot.arm.get_controls().result()
        assert (told["yaw"], told["pitch"], told["knee"], told["slide"]) == (
            "position",
            "position",
            "velocity",
            "effort",
        )
        sim.robot.arm.publish({"yaw": -0.2, "pitch": 0.0, "knee": 0.2, "slide": 0.0})
        # from 20 deg at 0.8 rad/s it is there after 0.7 s
        sim.step(120)
        found = sim.robot.arm.state.get()
        assert found["yaw"] == pytest.approx(-0.2, abs=0.01)
        speeds = sim.robot.arm.state.get_velocities().result()
        assert speeds["yaw"] == pytest.approx(0.0, abs=0.02)


def test_cameras_and_sensors(folder: Path) -> None:
    eye, imu = read_mjcf(folder / "crab.xml").sensors
    assert (eye.name, eye.product, eye.link, eye.position) == ("eye", "VideoCamera", "trunk", (0.2, 0.0, 0.05))
    assert dict(eye.properties) == {"cam_fov": pytest.approx(50.0)}
    # turned by 90 degrees about X, then by -90 about its own Z: it looks along +Y of the trunk, its right is -Z
    columns = np.reshape(eye.rotation, (3, 3)).T
    turned = np.zeros(9)
    mujoco.mju_quat2Mat(turned, np.array([0.5, 0.5, 0.5, -0.5]))
    right, up, back = turned.reshape(3, 3).T
    assert columns == pytest.approx(np.array([-back, -right, up]), abs=1e-9)
    assert (imu.product, imu.link, imu.position) == ("IMU", "trunk", (0.1, 0.0, 0.0))


def test_it_is_found_by_its_suffix(folder: Path) -> None:
    assert load(folder / "crab.xml").roots[0].name == "crab"


# -- cameras and sensors of MJCF files -------------------------------------------------------------

FILE_SENSORS_MODEL = """<mujoco model="eye">
  <worldbody><body name="head" pos="0 0 1"><geom size="0.1"/><site name="here"/>
  <camera name="left" pos="0.2 0 0"/><camera name="right" pos="0.2 0 0"/></body></worldbody>
  <sensor><magnetometer site="here"/></sensor></mujoco>"""
FILE_SENSORS_SCENE = """
from morse.builder import *
robot = Robot({file!r})
env = Environment("empty")
"""


def test_cameras_take_pictures_once_somebody_reads_them_and_sensors_without_a_place_are_off(tmp_path: Path) -> None:
    (tmp_path / "eye.xml").write_text(FILE_SENSORS_MODEL)
    (tmp_path / "scene.py").write_text(FILE_SENSORS_SCENE.format(file=str(tmp_path / "eye.xml")))
    with morse.load(tmp_path / "scene.py") as sim:
        left, right = sim.robot.left, sim.robot.right
        sim.step(20)
        assert left.component._taken == right.component._taken == -1
        assert left.get()["image"].size > 0
        sim.step(20)
        assert left.component._taken > 0
        assert right.component._taken == -1
        assert not any(part.name().endswith("sensor0") for part in sim.context.components.values() if part.active)


def test_the_image_of_a_camera_has_the_size_and_the_view_of_the_file(tmp_path: Path) -> None:
    text = FILE_SENSORS_MODEL.replace('name="left"', 'name="left" fovy="60" resolution="320 160"')
    (tmp_path / "eye.xml").write_text(text.replace('name="right"', 'name="right" fovy="60"'))
    (tmp_path / "scene.py").write_text(FILE_SENSORS_SCENE.format(file=str(tmp_path / "eye.xml")))
    with morse.load(tmp_path / "scene.py") as sim:
        images = {}
        for camera in ("left", "right"):
            getattr(sim.robot, camera).get()
            sim.step(20)
            images[camera] = getattr(sim.robot, camera).get()
        assert images["left"]["image"].shape[:2] == (160, 320)
        # the same vertical field of view: 160 pixels for twice tan 30 degrees
        assert images["left"]["intrinsic_matrix"][0][0] == pytest.approx(80.0 / math.tan(math.radians(30.0)))
        height = images["right"]["image"].shape[0]
        assert images["right"]["intrinsic_matrix"][1][1] == pytest.approx(height / 2 / math.tan(math.radians(30.0)))


# -- mJCF files that earlier versions of MuJoCo read -----------------------------------------------

GLOBAL = """<mujoco><compiler coordinate="global" angle="degree"/><worldbody>
<body name="torso" pos="0.1 0 1.25"><joint type="slide" axis="1 0 0" pos="0 0 0"/><joint axis="0 1 0" pos="0.1 0 1.25"/>
  <geom type="capsule" fromto="0.1 0 1.45 0.1 0 1.05" size="0.05"/>
  <body name="thigh"><joint axis="0 -1 0" pos="0.1 0 1.05" range="-150 0" limited="true"/>
    <geom type="capsule" fromto="0.1 0 1.05 0.1 0 0.6" size="0.05"/><site name="knee" pos="0.1 0 0.6"/>
    <body name="leg" pos="0 0 0.4"><joint axis="0 -1 0" pos="0.1 0 0.6"/><geom type="box" size="0.04 0.03 0.2"
      pos="0.1 0 0.4"/></body></body></body></worldbody></mujoco>"""
LOCAL = """<mujoco><compiler angle="degree"/><worldbody>
<body name="torso" pos="0.1 0 1.25"><joint type="slide" axis="1 0 0" pos="-0.1 0 -1.25"/><joint axis="0 1 0"/>
  <geom type="capsule" fromto="0 0 0.2 0 0 -0.2" size="0.05"/>
  <body name="thigh" pos="0 0 -0.2"><joint axis="0 -1 0" range="-150 0" limited="true"/>
    <geom type="capsule" fromto="0 0 0 0 0 -0.45" size="0.05"/><site name="knee" pos="0 0 -0.45"/>
    <body name="leg" pos="0 0 -0.45"><joint axis="0 -1 0"/><geom type="box" size="0.04 0.03 0.2" pos="0 0 -0.2"/></body>
  </body></body></worldbody></mujoco>"""
BODY = '<worldbody><body pos="0 0 1"><joint axis="0 1 0" damping="3"/><geom name="g" size="0.1"/></body></worldbody>'


def compiled(tmp_path: Path, text: str) -> mujoco.MjModel:
    path = tmp_path / "model.xml"
    path.write_text(text)
    return Source(path).file().spec().compile()


def test_global_coordinates(tmp_path: Path) -> None:
    models = [compiled(tmp_path, text) for text in (GLOBAL, LOCAL)]
    states = [mujoco.MjData(model) for model in models]
    for _ in range(2):
        for model, data in zip(models, states, strict=True):
            mujoco.mj_forward(model, data)
        one, other = states
        for name in ("geom_xpos", "site_xpos", "xanchor", "xaxis", "xipos", "qvel"):
            assert getattr(one, name) == pytest.approx(getattr(other, name), abs=1e-9), name
        for model, data in zip(models, states, strict=True):
            mujoco.mj_step(model, data, 200)


def test_global_coordinates_of_rotated_bodies_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    path.write_text(GLOBAL.replace('name="leg"', 'name="leg" euler="0 0 30"'))
    with pytest.raises(AssetError, match=r"the body 'leg' is rotated"):
        read_mjcf(path)


@pytest.mark.parametrize(
    "element",
    [
        '<option apirate="100" mpr_iterations="40"/>',
        '<compiler coordinate="local" convexhull="true" exactmeshinertia="true"/>',
        '<option><flag sensornoise="enable"/></option>',
    ],
)
def test_removed_attributes_change_nothing(tmp_path: Path, element: str) -> None:
    model = compiled(tmp_path, f"<mujoco>{element}{BODY}</mujoco>")
    assert model.body_mass == pytest.approx(compiled(tmp_path, f"<mujoco>{BODY}</mujoco>").body_mass)


def test_renamed_attributes_keep_their_meaning(tmp_path: Path) -> None:
    text = '<mujoco><option mpr_tolerance="0.01"><flag passive="disable"/></option>%s</mujoco>'
    model = compiled(tmp_path, text % BODY)
    assert model.opt.ccd_tolerance == pytest.approx(0.01)
    off = mujoco.mjtDisableBit.mjDSBL_DAMPER | mujoco.mjtDisableBit.mjDSBL_SPRING
    assert int(model.opt.disableflags) & int(off) == int(off)
    predefined = compiled(tmp_path, f'<mujoco><option collision="predefined"/>{BODY}</mujoco>')
    assert (int(predefined.geom_contype[0]), int(predefined.geom_conaffinity[0])) == (0, 0)


@pytest.mark.parametrize(
    ("asset", "body", "lost"),
    [
        ('<mesh name="m"><plugin plugin="mujoco.sdf.torus"/></mesh>', '<geom type="mesh" mesh="m"/>', "plugin"),
        ("", '<flexcomp name="f" type="gmsh" file="none.msh" radius="0.01" dim="3"/>', "deformable"),
    ],
)
def test_what_is_left_out_does_not_make_the_rest_unreadable(tmp_path: Path, asset: str, body: str, lost: str) -> None:
    path = tmp_path / "model.xml"
    extra = ""
    if lost == "deformable":
        extra = '<keyframe><key qpos="0 1 2 3 4 5 6 7 8 9 10 11 12"/></keyframe>'
        extra += '<equality><connect body1="f_0" body2="b" anchor="0 0 0"/></equality>'
    path.write_text(
        f'<mujoco><asset>{asset}</asset>{BODY.replace("</worldbody>", "")}<body name="b" pos="1 0 1">{body}<geom '
        f'size="0.1"/></body></worldbody>{extra}</mujoco>'
    )
    library = read_mjcf(path)
    assert any(lost in warning and "left out" in warning for warning in library.warnings)
    assert sum(len(node.bones) for node in library.nodes()) == 1
