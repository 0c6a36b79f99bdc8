"""Robots with dynamic joints in a simulation: saved, restored, reset, spawned, deleted, repeated to the bit."""

from pathlib import Path

import pytest

import morse
from morse.builder import Armature, ArmaturePose, Robot

ROBOT = """<robot name="crane">
  <link name="base"><inertial><mass value="30"/></inertial>
    <collision><geometry><box size="0.8 0.8 0.2"/></geometry></collision></link>
  <link name="boom"><inertial><origin xyz="0.3 0 0"/><mass value="2"/></inertial>
    <collision><origin xyz="0.3 0 0"/><geometry><box size="0.6 0.05 0.05"/></geometry></collision></link>
  <link name="hook"><inertial><origin xyz="0.1 0 0"/><mass value="0.5"/></inertial></link>
  <joint name="lift" type="revolute"><parent link="base"/><child link="boom"/><origin xyz="0 0 0.3"/>
    <axis xyz="0 -1 0"/><limit lower="-1" upper="1.5" effort="0" velocity="0"/></joint>
  <joint name="swing" type="continuous"><parent link="boom"/><child link="hook"/><origin xyz="0.6 0 0"/>
    <axis xyz="0 -1 0"/><dynamics damping="0.01"/></joint>
</robot>"""
SCENE = """
from morse.builder import *
crane = Robot({file!r})
crane.translate(z=0.1)
arm = Armature(armature_name='crane_joints')
arm.control('effort', ['swing'])
crane.append(arm)
joints = ArmaturePose()
arm.append(joints)
place = Pose()
crane.append(place)
env = Environment('empty')
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    (tmp_path / "crane.urdf").write_text(ROBOT)
    script = tmp_path / "scene.py"
    script.write_text(SCENE.format(file=str(tmp_path / "crane.urdf")))
    return script


def test_a_run_repeats_to_the_bit_and_goes_on_from_a_state(scene: Path) -> None:
    with morse.load(scene) as one, morse.load(scene) as other:
        for sim in (one, other):
            sim.crane.arm.rotate("lift", 0.5)
            sim.step(30)
        assert one.state_hash() == other.state_hash()
        state = one.save()
        one.step(60)
        wanted, pose = one.state_hash(), one.crane.arm.joints.get()
        other.step(200)
        other.restore(state)
        other.step(60)
        assert other.state_hash() == wanted
        assert other.crane.arm.joints.get() == pose
        # the hook hangs freely from a boom that is raised
        assert pose["lift"] == pytest.approx(0.5, abs=0.01)


def test_a_reset_brings_the_joints_back(scene: Path) -> None:
    with morse.load(scene) as sim:
        sim.step(2)
        before = sim.crane.arm.joints.get()["lift"]
        sim.crane.arm.set_rotation("lift", 1.0).result()
        sim.step(60)
        assert sim.crane.arm.joints.get()["lift"] == pytest.approx(1.0, abs=0.01)
        sim.reset()
        sim.step(2)
        assert sim.crane.arm.joints.get()["lift"] == pytest.approx(before, abs=1e-9)


def test_a_service_ends_when_the_joint_has_arrived(scene: Path) -> None:
    with morse.load(scene) as sim:
        sim.crane.arm.rotate("lift", 0.6, 1.0).result(5.0)
        values = sim.crane.arm.joints.get_state().result()
        assert values["lift"] == pytest.approx(0.6, abs=0.02)
        assert sim.time() > 0.55
        with pytest.raises(Exception, match="controlled by effort, not by position"):
            sim.crane.arm.rotate("swing", 0.1).result(5.0)


def test_efforts_and_velocities_are_measured(scene: Path) -> None:
    with morse.load(scene) as sim:
        sim.crane.arm.publish({"lift": 0.0, "swing": 0.2})
        sim.step(600)
        efforts = sim.crane.arm.joints.get_efforts().result()
        assert efforts["swing"] == pytest.approx(0.2)
        # m g l of the boom, the weight of the hook at its end, and what the motor of the hook pushes against
        assert efforts["lift"] == pytest.approx(2 * 9.81 * 0.3 + 0.5 * 9.81 * 0.6 + 0.2, rel=0.01)
        speeds = sim.crane.arm.joints.get_velocities().result()
        assert speeds["lift"] == pytest.approx(0.0, abs=1e-3)


def test_two_of_them_have_joints_of_their_own(scene: Path) -> None:
    first, _, end = scene.read_text().partition("env =")
    file = str(scene.parent / "crane.urdf")
    second = (
        f"second = Robot({file!r})\nsecond.translate(y=3, z=0.1)\nother = Armature(armature_name='crane_joints')\n"
        "second.append(other)\nmeter = ArmaturePose()\nother.append(meter)\n"
    )
    scene.write_text(f"{first}{second}env ={end}")
    with morse.load(scene) as sim:
        sim.second.other.rotate("lift", 0.4)
        sim.step(60)
        assert sim.crane.arm.joints.get()["lift"] == pytest.approx(0.0, abs=5e-3)
        assert sim.second.other.meter.get()["lift"] == pytest.approx(0.4, abs=5e-3)


def test_it_is_spawned_and_deleted(scene: Path) -> None:
    def second():
        robot = Robot(str(scene.parent / "crane.urdf"))
        boom = Armature("boom_motor", armature_name="crane_joints")
        robot.append(boom)
        state = ArmaturePose("state")
        boom.append(state)
        return robot

    with morse.load(scene) as sim:
        sim.step(10)
        before = sim.crane.arm.joints.get()
        handle = sim.spawn("second", second, position=(3.0, 0.0, 0.1))
        handle.boom_motor.rotate("lift", 0.3)
        sim.step(60)
        assert sim.crane.arm.joints.get()["lift"] == pytest.approx(before["lift"], abs=5e-3)
        assert sim.second.boom_motor.state.get()["lift"] == pytest.approx(0.3, abs=5e-3)
        sim.delete("second")
        sim.step(10)
        assert sim.crane.arm.joints.get()["lift"] == pytest.approx(before["lift"], abs=5e-3)
