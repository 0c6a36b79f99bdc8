"""Robots from MJCF files: links where the engine itself puts them, motors, masses, shapes and contacts."""

import math
from pathlib import Path

import mujoco
import numpy as np
import pytest
import trimesh

import morse
from morse.assets import load
from morse.assets.mjcf import read_mjcf
from morse.mathutils.light import linear_light
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
        world.data.qpos[handle._qpos[0]] = value
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
