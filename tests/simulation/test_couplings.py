"""Tendons and constraints of MJCF files."""

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import morse
from morse.builder import Armature, ArmaturePose, Environment, Robot

#: masses on rails, a weight on a spring, a loop of four bars, a welded pair, and wrapped ropes
MJCF = """<mujoco model="gym"><worldbody><body name="frame" pos="0 0 1" euler="0 0 40"><inertial pos="0 0 0" mass="1"
    diaginertia="1 1 1"/>
  <site name="ceiling" pos="0.1 2 0.2"/>
  <body name="left" pos="0 0 0.5"><joint name="a" type="slide" axis="1 0 0"/><geom size="0.05" mass="2"/></body>
  <body name="right" pos="0 1 0.5"><joint name="b" type="slide" axis="1 0 0"/><geom size="0.05" mass="1"/></body>
  <body name="weight" pos="0.1 2 -0.3"><joint name="hang" type="slide" axis="0 0 1" damping="8"/>
    <geom size="0.05" mass="3"/><site name="hook" pos="0 0 0.1"/></body>
  <body name="crank" pos="0 3 0"><joint name="turn" axis="0 -1 0"/><geom size="0.02" pos="0 0 0.2" mass="0.1"/>
    <body name="rod" pos="0 0 0.2"><joint name="bend" axis="0 -1 0"/><geom size="0.02" pos="0.3 0 0" mass="0.1"/></body>
  </body>
  <body name="rocker" pos="0.6 3 0"><joint name="rock" axis="0 -1 0"/><geom size="0.02" pos="0 0 0.2" mass="0.1"/>
  </body>
  <body name="one" pos="0 5 0"><joint name="p" axis="0 0 1"/><geom size="0.05" mass="1" pos="0.1 0 0"/></body>
  <body name="other" pos="0.5 5 0" euler="0 0 30"><joint name="q" axis="0 0 1"/><joint name="qx" type="slide"
    axis="1 0 0"/><joint name="qy" type="slide" axis="0 1 0"/><geom size="0.05" mass="1" pos="0.1 0 0"/></body>
  <body name="drum" pos="0 7 0"><joint name="roll" axis="0 1 0"/><geom name="rim" type="cylinder" size="0.2 0.1"
    euler="90 0 0" mass="1"/><site name="pin" pos="-0.3 0 0"/><site name="beside" pos="0 0 0.3"/></body>
  <body name="load" pos="0.5 7 0"><joint name="lift" type="slide" axis="0 0 1"/><geom size="0.05" mass="1"/>
    <site name="eye"/></body>
  <body name="x1" pos="0 9 0"><joint name="x" type="slide" axis="1 0 0"/><geom size="0.05" mass="1"/></body>
  <body name="y1" pos="0 10 0"><joint name="y" type="slide" axis="1 0 0"/><geom size="0.05" mass="0.001"/></body>
  </body></worldbody>
  <tendon>
    <fixed name="differential"><joint joint="a" coef="1"/><joint joint="b" coef="-0.5"/></fixed>
    <spatial name="spring" stiffness="200" springlength="0.35"><site site="ceiling"/><site site="hook"/></spatial>
    <spatial name="rope"><site site="pin"/><geom geom="rim" sidesite="beside"/><site site="eye"/><pulley divisor="2"/>
      <site site="eye"/><site site="ceiling"/></spatial>
  </tendon>
  <equality>
    <connect body1="rod" body2="rocker" anchor="0.6 0 0"/>
    <weld body1="one" body2="other"/>
    <joint joint1="y" joint2="x" polycoef="0.02 0.3 0.5 0 0"/>
  </equality>
  <actuator><general name="pull" tendon="differential" gainprm="1" ctrlrange="-4 4"/></actuator>
</mujoco>"""
SCENE = """
from morse.builder import *
gym = Robot({file!r})
gym.translate(1, 2, 0)
gym.rotate(z=0.5)
arm = Armature(armature_name='gym_joints')
gym.append(arm)
state = ArmaturePose()
arm.append(state)
env = Environment('empty')
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "gym.xml"
    path.write_text(MJCF)
    (tmp_path / "scene.py").write_text(SCENE.format(file=str(path)))
    return path


@pytest.fixture
def sim(file: Path):
    with morse.load(file.parent / "scene.py") as loaded:
        yield loaded


def local(sim: Any, link: str, point=(0.0, 0.0, 0.0)) -> np.ndarray:
    """A point of a link in the frame of the robot."""
    world = sim.context.world
    (base, turned), (place, r) = world.game_object("gym").world_pose(), world.game_object(link).world_pose()
    there = np.array(place) + np.reshape(r, (3, 3)) @ np.array(point)
    return np.reshape(turned, (3, 3)).T @ (there - np.array(base))


def test_paths_are_as_long_as_in_the_file(sim) -> None:
    plain = mujoco.MjModel.from_xml_string(MJCF)
    model = sim.context.world.model
    assert plain.ntendon == model.ntendon == 3
    for number in range(plain.ntendon):
        mine = model.tendon(f"gym.arm/{plain.tendon(number).name}").id
        assert model.tendon_length0[mine] == pytest.approx(plain.tendon_length0[number], abs=1e-9)


def test_a_motor_pulls_a_fixed_tendon(sim) -> None:
    sim.gym.arm.publish({"pull": 1.5})
    sim.step(2)
    before = sim.gym.arm.state.get_velocities().result()
    sim.step(30)
    after = sim.gym.arm.state.get_velocities().result()
    # F c / m of each joint
    assert after["a"] - before["a"] == pytest.approx(0.5 * 1.5 / 2.0, rel=1e-3)
    assert after["b"] - before["b"] == pytest.approx(-0.5 * 0.5 * 1.5 / 1.0, rel=1e-3)
    found = sim.gym.arm.get_tendons().result()["pull"]
    values = sim.gym.arm.state.get()
    assert found["force"] == pytest.approx(1.5)
    assert found["length"] == pytest.approx(values["a"] - 0.5 * values["b"], abs=0.02)
    sim.gym.arm.publish({"pull": 99.0})
    sim.step(2)
    assert sim.gym.arm.get_tendons().result()["pull"]["force"] == pytest.approx(4.0), "the range of its commands"


def test_a_weight_stretches_the_spring_on_which_it_hangs(sim) -> None:
    sim.step(240)
    hook, ceiling = local(sim, "weight", (0.0, 0.0, 0.1)), local(sim, "frame", (0.1, 2.0, 0.2))
    # m g / k beyond the rest length
    assert np.linalg.norm(hook - ceiling) == pytest.approx(0.35 + 3.0 * 9.81 / 200.0, rel=2e-3)


def test_bars_of_a_loop_stay_connected(sim) -> None:
    arm = sim.gym.arm
    arm.set_control("position", ["turn"]).result()
    arm.publish({"turn": 0.6})
    sim.step(120)
    values = arm.state.get()
    assert values["turn"] == pytest.approx(0.6, abs=0.02)
    assert local(sim, "rod", (0.6, 0.0, 0.0)) == pytest.approx(local(sim, "rocker", (0.0, 0.0, 0.2)), abs=2e-3)


def test_a_weld_keeps_the_relative_pose(sim) -> None:
    arm = sim.gym.arm
    before = local(sim, "other") - local(sim, "one")
    arm.set_control("position", ["p"]).result()
    arm.publish({"p": 1.0})
    sim.step(180)
    c, s = np.cos(1.0), np.sin(1.0)
    turned = arm.state.get()["p"]
    assert turned == pytest.approx(1.0, abs=0.02)
    frame = np.radians(40.0)
    back = np.array([[np.cos(frame), np.sin(frame), 0], [-np.sin(frame), np.cos(frame), 0], [0, 0, 1]])
    about = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    assert local(sim, "other") - local(sim, "one") == pytest.approx(back.T @ about @ back @ before, abs=0.02)


def test_a_joint_is_a_polynomial_of_another(sim) -> None:
    sim.gym.arm.set_control("position", ["x"]).result()
    sim.gym.arm.publish({"x": 0.4})
    sim.step(700)
    values = sim.gym.arm.state.get()
    x = values["x"]
    assert x == pytest.approx(0.4, abs=5e-3)
    assert values["y"] == pytest.approx(0.02 + 0.3 * x + 0.5 * x * x, abs=5e-3)


def test_two_of_them_a_state_and_a_deletion(sim, file: Path) -> None:
    def second() -> Robot:
        robot = Robot(str(file))
        limb = Armature("limb", armature_name="gym_joints")
        robot.append(limb)
        limb.append(ArmaturePose("meter"))
        return robot

    sim.gym.arm.publish({"pull": 1.0})
    sim.step(10)
    sim.spawn("second", second, position=(30.0, 0.0, 0.0))
    sim.second.limb.publish({"pull": -2.0})
    sim.step(10)
    assert sim.gym.arm.get_tendons().result()["pull"]["force"] == pytest.approx(1.0)
    assert sim.second.limb.get_tendons().result()["pull"]["force"] == pytest.approx(-2.0)
    state = sim.save()
    sim.step(20)
    wanted = sim.state_hash()
    sim.restore(state)
    sim.step(20)
    assert sim.state_hash() == wanted
    sim.delete("second")
    sim.step(5)
    assert sim.gym.arm.get_tendons().result()["pull"]["force"] == pytest.approx(1.0)
    assert sim.context.world.model.ntendon == 3
    sim.reset()
    sim.step(1)
    assert sim.gym.arm.state.get()["a"] == pytest.approx(0.0, abs=1e-2)


# -- two tendons whose lengths an MJCF file couples, in a world whose other bodies have fallen asleep

#: the length of the second tendon is 0.1 m plus half of the change of the first
COUPLED_TENDONS_MJCF = """<mujoco model="rig"><worldbody><body name="frame" pos="0 0 1"><inertial pos="0 0 0" mass="1"
    diaginertia="1 1 1"/>
  <body name="left"><joint name="a" type="slide" axis="1 0 0"/><geom size="0.05" mass="1"/></body>
  <body name="right" pos="0 1 0"><joint name="b" type="slide" axis="1 0 0"/><geom size="0.05" mass="1"/></body>
  </body></worldbody>
  <tendon>
    <fixed name="first"><joint joint="a" coef="2"/></fixed>
    <fixed name="second"><joint joint="b" coef="1"/></fixed>
  </tendon>
  <equality><tendon tendon1="second" tendon2="first" polycoef="0.1 0.5 0 0 0"/></equality>
</mujoco>"""


def rig(file: Path) -> Robot:
    robot = Robot(str(file))
    arm = Armature("arm", armature_name="rig_joints")
    robot.append(arm)
    arm.append(ArmaturePose("state"))
    return robot


def test_they_are_coupled_and_the_others_sleep_again_after_a_deletion(tmp_path: Path) -> None:
    file = tmp_path / "rig.xml"
    file.write_text(COUPLED_TENDONS_MJCF)
    with morse.load(lambda: Environment("empty")) as sim:
        sim.spawn("crate", "props/crates", (-5.0, 0.0, 0.5))
        sim.step(300)
        assert sim.context.world.data.nv_awake == 0
        sim.spawn("rig", lambda: rig(file), position=(3.0, 0.0, 0.0))
        sim.rig.arm.set_control("position", ["a"]).result()
        sim.rig.arm.publish({"a": 0.3})
        sim.step(600)
        values = sim.rig.arm.state.get()
        assert values["a"] == pytest.approx(0.3, abs=5e-3)
        assert values["b"] == pytest.approx(0.1 + 0.5 * (2 * values["a"]), abs=5e-3)
        sim.save()
        sim.delete("rig")
        sim.step(300)
        assert sim.context.world.data.nv_awake == 0
