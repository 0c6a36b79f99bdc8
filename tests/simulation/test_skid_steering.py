"""Robots that turn on the spot by wheels that slide sideways: the moments of friction are in balance."""

import math
from pathlib import Path

import pytest

import morse

TRACK = 0.5
BASE = """<link name="base"><inertial><mass value="20"/>
  <inertia ixx="0.6" iyy="0.8" izz="1.2" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><box size="0.6 0.3 0.1"/></geometry></collision></link>"""
WHEEL = """<link name="{name}_link"><inertial><mass value="1"/>
    <inertia ixx="0.005" iyy="0.01" izz="0.005" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin rpy="1.5707963 0 0"/><geometry><cylinder radius="0.12" length="0.06"/></geometry></collision>
  </link>
  <joint name="{name}" type="continuous"><parent link="base"/><child link="{name}_link"/>
    <origin xyz="{x} {y} -0.05"/><axis xyz="0 1 0"/></joint>"""
SCENE = """
from morse.builder import *
robot = Robot("skid.urdf")
robot.translate(z=0.18)
motion = MotionVWDiff(left=("fl", "rl"), right=("fr", "rr"))
motion.properties(WheelSeparation={separation})
robot.append(motion)
robot.append(Pose("pose"))
env = Environment("empty")
"""


def turned(folder: Path, half_base: float, separation: float = 0.0) -> float:
    """The yaw rate on the spot, of 0.5 rad/s that are commanded; averaged over two seconds."""
    places = {"fl": (1, 1), "fr": (1, -1), "rl": (-1, 1), "rr": (-1, -1)}
    wheels = [WHEEL.format(name=name, x=x * half_base, y=y * TRACK / 2.0) for name, (x, y) in places.items()]
    (folder / "skid.urdf").write_text(f"<robot name='skid'>{BASE}{''.join(wheels)}</robot>")
    (folder / "scene.py").write_text(SCENE.format(separation=separation))
    with morse.load(folder / "scene.py") as sim:
        sim.robot.motion.publish({"v": 0.0, "w": 0.5})
        sim.step(60)
        before = sim.robot.pose.data["yaw"]
        sim.step(120)
        return math.remainder(sim.robot.pose.data["yaw"] - before, math.tau) / 2.0


@pytest.mark.parametrize("half_base", [0.05, 0.15, 0.25, 0.35])
def test_friction_is_in_balance(tmp_path: Path, half_base: float):
    # Coulomb friction f slip / |slip| at each wheel, with the slip (w T / 2 - r W, w b): no moment about the centre
    ratio = 1.0 / (1.0 + (2.0 * half_base / TRACK) ** 2)
    assert turned(tmp_path, half_base, TRACK) / 0.5 == pytest.approx(ratio, abs=0.05)


@pytest.mark.parametrize("half_base", [0.05, 0.15, 0.2, 0.25])
def test_the_separation_of_the_model_gives_the_commanded_rate(tmp_path: Path, half_base: float):
    assert turned(tmp_path, half_base) == pytest.approx(0.5, rel=0.05)
    separation = TRACK * (1.0 + (2.0 * half_base / TRACK) ** 2)
    assert turned(tmp_path, half_base, separation) == pytest.approx(0.5, abs=0.04)
