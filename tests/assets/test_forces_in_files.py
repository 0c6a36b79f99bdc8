"""Sensors of forces, contacts and velocities that robot files declare measure what their programs measure."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import morse

if TYPE_CHECKING:
    from pathlib import Path

#: a pan of 2 kg hangs on an arm that a motor holds; the pan has the shape that touches
MJCF = """<mujoco model="arm"><worldbody><geom type="box" size="0.05 0.05 0.5" pos="0 0 0.5"/>
  <body name="upper" pos="0.2 0 1"><joint name="lift" type="slide" axis="0 0 1" damping="1"/>
    <inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
    <body name="pan" pos="0.2 0 0"><joint name="turn" axis="0 0 1" damping="0.1"/>
      <geom name="pan" size="0.05" mass="2"/>
      <site name="wrist"/><site name="skin" size="0.06"/></body></body></worldbody>
  <actuator><position joint="lift" kp="20000" dampratio="1"/></actuator>
  <sensor><force name="pull" site="wrist"/><torque name="twist" site="wrist"/><touch name="skin" site="skin"/>
    <velocimeter name="speed" site="wrist"/><framezaxis name="up" objtype="site" objname="wrist"/><clock name="now"/>
    <e_kinetic name="energy"/></sensor></mujoco>"""
LINKS = """<link name="world"/>
  <link name="upper"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/>
    </inertial></link>
  <link name="pan"><inertial><mass value="2"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <joint name="lift" type="prismatic"><parent link="world"/><child link="upper"/><origin xyz="0.2 0 1"/>
    <axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1000" velocity="1"/></joint>
  <joint name="turn" type="continuous"><parent link="upper"/><child link="pan"/><origin xyz="0.2 0 0"/>
    <axis xyz="0 0 1"/></joint>"""
URDF = f"""<robot name="arm">{LINKS}
  <gazebo reference="turn"><sensor name="pull" type="force_torque"/></gazebo>
  <gazebo reference="pan"><sensor name="skin" type="contact"/><sensor name="height" type="altimeter"/></gazebo>
    </robot>"""
SDF = """<sdf version="1.9"><model name="arm">
  <link name="upper"><pose>0.2 0 1 0 0 0</pose><inertial><mass>1</mass></inertial></link>
  <link name="pan"><pose>0.4 0 1 0 0 0</pose><inertial><mass>2</mass></inertial>
    <collision name="c"><geometry><sphere><radius>0.05</radius></sphere></geometry></collision>
    <sensor name="skin" type="contact"><contact><collision>c</collision></contact></sensor>
    <sensor name="height" type="altimeter"/></link>
  <joint name="lift" type="prismatic"><parent>world</parent><child>upper</child><axis><xyz>0 0 1</xyz></axis></joint>
  <joint name="turn" type="revolute"><parent>upper</parent><child>pan</child><axis><xyz>0 0 1</xyz></axis>
    <sensor name="pull" type="force_torque"/></joint></model></sdf>"""
SCENE = """
from morse.builder import *
robot = Robot({file!r})
env = Environment("empty")
"""


def test_a_sensor_on_a_link_measures_the_velocity_of_the_link(tmp_path: Path) -> None:
    wheel = """<mujoco><option gravity="0 0 0"/><worldbody><body name="base" pos="0 0 1"><freejoint/>
      <geom size="0.5"/>
      <body name="wheel"><joint name="spin" axis="0 0 1"/>
        <geom name="rim" type="box" size="0.01 0.01 0.01" pos="0.2 0 0"/>
      <site name="rim" pos="0.2 0 0"/></body></body></worldbody><keyframe>
        <key name="turning" qpos="0 0 1 1 0 0 0 0"/></keyframe>
      <actuator><velocity joint="spin" kv="0.02"/></actuator>
      <sensor><gyro name="imu" site="rim"/><velocimeter name="speed" site="rim"/></sensor></mujoco>"""
    (tmp_path / "wheel.xml").write_text(wheel)
    script = SCENE.format(file=str(tmp_path / "wheel.xml")).replace(
        "env =", "arm = Armature(armature_name='wheel_joints')\nrobot.append(arm)\nenv ="
    )
    (tmp_path / "scene.py").write_text(script)
    with morse.load(tmp_path / "scene.py") as sim:
        for _ in range(60):
            sim.robot.arm.publish({"spin": 3.0})
            sim.step(1)
        # the base, a ball of lead beside the rim, hardly turns
        assert sim.robot.imu.get()["angular_velocity"] == pytest.approx([0.0, 0.0, 3.0], abs=0.05)
        assert sim.robot.speed.get()["linear_velocity"] == pytest.approx([0.0, 0.6, 0.0], abs=0.02)


@pytest.mark.parametrize(("name", "text"), [("arm.xml", MJCF), ("arm.urdf", URDF), ("arm.sdf", SDF)])
def test_a_pan_weighs_and_touches_nothing(tmp_path: Path, name: str, text: str) -> None:
    (tmp_path / name).write_text(text)
    (tmp_path / "scene.py").write_text(SCENE.format(file=str(tmp_path / name)))
    with morse.load(tmp_path / "scene.py") as sim:
        sim.step(120)
        assert sim.robot.pull.get()["force"] == pytest.approx([0.0, 0.0, -2 * 9.81], abs=0.02)
        skin = sim.robot.skin.get()
        assert (skin["touching"], skin["force"]) == (False, [0.0, 0.0, 0.0])
        if name == "arm.xml":
            assert sim.robot.speed.get()["linear_velocity"] == pytest.approx([0.0, 0.0, 0.0], abs=1e-3)
            assert (sim.robot.up.get()["x"], sim.robot.up.get()["y"]) == pytest.approx((0.4, 0.0), abs=1e-3)
            # the torque is one component with the force, and the energy is left out
            assert not {"twist", "energy"} & set(sim.robot.parts)
        else:
            assert sim.robot.height.get()["z"] == pytest.approx(1.0, abs=2e-3)
