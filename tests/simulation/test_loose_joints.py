"""Joints of files that move in several directions: balls, planar and floating ones."""

import itertools
import logging
import math
from pathlib import Path
from typing import Any

import pytest

from morse.assets.mjcf import read_mjcf
from morse.assets.urdf import read_urdf
from morse.builder import Armature, ArmaturePose, Robot
from morse.scene import JointKind, PhysicsType
from tests.kit.scenes import Load

MASS, LENGTH, INERTIA, SLOPE = 2.0, 0.5, 0.01, 0.3
TENSOR = f'<inertia ixx="{INERTIA}" iyy="{INERTIA}" izz="{INERTIA}" ixy="0" ixz="0" iyz="0"/>'
#: a pendulum on a ball, a puck on a slope, a stone in the air
URDF = f"""<robot name="toys"><link name="world"/>
  <link name="bob"><inertial><origin xyz="0 0 -{LENGTH}"/><mass value="{MASS}"/>{TENSOR}</inertial></link>
  <link name="puck"><inertial><mass value="1"/>{TENSOR}</inertial></link>
  <link name="stone"><inertial><mass value="1"/>{TENSOR}</inertial></link>
  <joint name="hook" type="spherical"><parent link="world"/><child link="bob"/><origin xyz="0 0 5" rpy="0.08 0.06 0"/>
  </joint>
  <joint name="table" type="planar"><parent link="world"/><child link="puck"/><origin xyz="0 3 5" rpy="0 {SLOPE} 0"/>
    <axis xyz="0 0 1"/></joint>
  <joint name="air" type="floating"><parent link="world"/><child link="stone"/><origin xyz="0 6 50"/></joint>
</robot>"""
MJCF = f"""<mujoco model="toys"><worldbody><body name="post">
  <body name="bob" pos="0 0 5"><joint name="hook" type="ball" damping="0"/>
    <inertial pos="{LENGTH * 0.1} 0 -{LENGTH * 0.995}" mass="{MASS}" diaginertia="{INERTIA} {INERTIA} {INERTIA}"/>
  </body>
</body></worldbody></mujoco>"""
SCENE = """
from morse.builder import *
toys = Robot({file!r})
arm = Armature(armature_name='toys_joints')
arm.properties(Dynamic={dynamic})
toys.append(arm)
state = ArmaturePose()
arm.append(state)
env = Environment('empty')
"""


@pytest.fixture
def load(tmp_path: Path, load: Load) -> Load:
    def start(text: str = URDF, *, dynamic: bool = True) -> Any:
        file = tmp_path / ("toys.xml" if text.startswith("<mujoco") else "toys.urdf")
        file.write_text(text)
        return load(SCENE.format(file=str(file), dynamic=dynamic), sockets=False)

    return start


def place(sim, link: str):
    return sim.context.world.game_object(link).world_pose()[0]


def tilt(sim) -> tuple[float, float]:
    """How far the bob is from the vertical along X and Y, rad."""
    _, r = sim.context.world.game_object("bob").world_pose()
    return -r[2], -r[5]


def crossings(values: list[float]) -> list[float]:
    """Times at which values fall below 0, in ticks."""
    pairs = enumerate(itertools.pairwise(values))
    return [number + a / (a - b) for number, (a, b) in pairs if a > 0.0 >= b]


@pytest.mark.parametrize("text", [URDF, MJCF])
def test_a_pendulum_on_a_ball_swings_in_its_period(load, text: str) -> None:
    sim = load(text)
    seen = []
    for _ in range(300):
        sim.step(1)
        world = sim.context.world
        (x, _, _), r = world.game_object("bob").world_pose()
        centre = [-LENGTH * r[2]] if text is URDF else [LENGTH * (0.1 * r[0] - 0.995 * r[2])]
        seen.append(centre[0])
        assert abs(x) < 1e-9, "its origin stays at the ball"
    times = crossings(seen) or crossings([-value for value in seen])
    period = math.tau * math.sqrt((MASS * LENGTH**2 + INERTIA) / (MASS * 9.81 * LENGTH))
    assert (times[1] - times[0]) / 60.0 == pytest.approx(period, rel=5e-3)


def test_it_is_published(load) -> None:
    sim = load()
    sim.step(30)
    found = sim.toys.arm.state.get()
    w, x, y, z = found["hook"]
    assert w * w + x * x + y * y + z * z == pytest.approx(1.0)
    # q = (x, y, yaw) along the slope: g sin(slope) t^2 / 2 downhill, which is +X of the joint
    t = sim.time()
    assert found["table"] == pytest.approx([0.5 * 9.81 * math.sin(SLOPE) * t * t, 0.0, 0.0], rel=0.03, abs=1e-6)
    assert found["air"][:3] == pytest.approx([0.0, 0.0, -0.5 * 9.81 * t * t], rel=0.03, abs=1e-6)
    assert found["air"][3:] == [1.0, 0.0, 0.0, 0.0]
    loose = sim.toys.arm.state.get_loose_joints().result()
    assert {name: one["type"] for name, one in loose.items()} == {"hook": "ball", "table": "planar", "air": "floating"}
    assert loose["air"]["velocity"] == pytest.approx([0.0, 0.0, -9.81 * sim.time(), 0.0, 0.0, 0.0], rel=0.03, abs=1e-6)
    assert sim.toys.arm.get_joints().result() == [], "they have no motors"
    assert place(sim, "stone")[2] == pytest.approx(50.0 + found["air"][2], abs=0.2)


def test_the_velocity_of_a_link_is_that_of_its_place(load) -> None:
    sim = load()
    sim.step(20)
    world = sim.context.world
    bob = world.game_object("bob")
    before = tilt(sim)
    _, (wx, wy, _) = bob.velocity()
    sim.step(1)
    after = tilt(sim)
    # small angles: about X the bob moves along Y, about Y along -X
    assert ((after[0] - before[0]) * 60.0, (after[1] - before[1]) * 60.0) == pytest.approx((-wy, wx), abs=0.05)
    assert world.game_object("stone").velocity()[0][2] < -3.0


def test_a_run_repeats_and_goes_on_from_a_state(load) -> None:
    sim = load()
    sim.step(20)
    state = sim.save()
    sim.step(40)
    wanted, found = sim.state_hash(), sim.toys.arm.state.get()
    sim.restore(state)
    sim.step(40)
    assert (sim.state_hash(), sim.toys.arm.state.get()) == (wanted, found)


def test_others_come_and_go(load, tmp_path: Path) -> None:
    sim = load()
    sim.step(20)
    speed = sim.toys.arm.state.get_loose_joints().result()["air"]["velocity"][2]

    def second() -> Robot:
        robot = Robot(str(tmp_path / "toys.urdf"))
        arm = Armature("limb", armature_name="toys_joints")
        robot.append(arm)
        arm.append(ArmaturePose("meter"))
        return robot

    sim.spawn("second", second, position=(20.0, 0.0, 0.0))
    sim.step(10)
    falling = sim.toys.arm.state.get_loose_joints().result()["air"]["velocity"][2]
    assert falling == pytest.approx(speed - 9.81 * 10 / 60, rel=0.05)
    assert sim.second.limb.meter.get()["air"][2] == pytest.approx(-0.5 * 9.81 * (11 / 60) ** 2, rel=0.05)
    sim.delete("second")
    sim.step(10)
    assert sim.toys.arm.state.get()["air"][2] < -0.5


def test_without_masses_they_stay_and_the_log_says_so(load, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING):
        sim = load(dynamic=False)
    assert "'hook' (ball), 'table' (planar), 'air' (floating) stay fixed" in caplog.text
    sim.step(10)
    assert place(sim, "stone") == pytest.approx((0.0, 6.0, 50.0))
    assert sim.toys.arm.state.get()["table"] == [0.0, 0.0, 0.0]


def test_a_robot_that_floats_in_its_world_is_free(tmp_path: Path) -> None:
    file = tmp_path / "drone.urdf"
    file.write_text(
        f"""<robot name="drone"><link name="world"/>
        <link name="hull"><inertial><mass value="1"/>{TENSOR}</inertial></link>
        <joint name="free" type="floating"><parent link="world"/><child link="hull"/><origin xyz="1 0 2"/></joint>
        </robot>"""
    )
    library = read_urdf(file)
    (root,) = library.roots
    assert root.body.type is PhysicsType.RIGID_BODY
    assert [child.name for child in root.children[0].children] == ["hull"]
    assert "set the position in the script" in " ".join(library.warnings)


def test_limits_of_a_ball_are_read(tmp_path: Path) -> None:
    file = tmp_path / "toys.xml"
    file.write_text(MJCF.replace('damping="0"', 'damping="0.3" range="0 40"'))
    bone = next(node for node in read_mjcf(file).nodes() if node.bones).bones[0]
    assert (bone.kind, bone.high) == (JointKind.BALL, pytest.approx(math.radians(40)))
    assert bone.dynamics is not None
    assert (bone.dynamics.damping, bone.dynamics.limited) == (0.3, True)
