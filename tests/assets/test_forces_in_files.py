"""Sensors of forces, contacts and velocities that robot files declare measure what their programs measure."""

from pathlib import Path

import pytest

import morse

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


#: a mast that turns, a sensor fixed 0.2 m above it, and a tool of 1 kg fixed to it with its centre 0.3 m aside
WRIST = {
    "wrist.urdf": """<robot name="wrist"><link name="base"/><link name="mast"><inertial><mass value="2"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="flange"/><link name="tool"><inertial><origin xyz="0.3 0 0.1"/><mass value="1"/>
  <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="mast"/><origin xyz="0 0 1"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="100" velocity="1"/></joint>
  <joint name="ft" type="fixed"><parent link="mast"/><child link="flange"/><origin xyz="0 0 0.2"/></joint>
  <joint name="hold" type="fixed"><parent link="flange"/><child link="tool"/><origin xyz="0 0 0.05"/></joint>
  <gazebo reference="ft"><sensor name="pull" type="force_torque"/></gazebo></robot>""",
    "wrist.sdf": """<sdf version="1.9"><model name="wrist">
  <joint name="ground" type="fixed"><parent>world</parent><child>base</child></joint><link name="base"/>
  <link name="mast"><pose>0 0 1 0 0 0</pose><inertial><mass>2</mass></inertial></link>
  <link name="flange"><pose>0 0 1.2 0 0 0</pose><inertial><mass>1e-6</mass></inertial></link>
  <link name="tool"><pose>0 0 1.25 0 0 0</pose><inertial><pose>0.3 0 0.1 0 0 0</pose><mass>1</mass></inertial></link>
  <joint name="turn" type="revolute"><parent>base</parent><child>mast</child><axis><xyz>0 0 1</xyz></axis></joint>
  <joint name="ft" type="fixed"><parent>mast</parent><child>flange</child>
    <sensor name="pull" type="force_torque"/></joint>
  <joint name="hold" type="fixed"><parent>flange</parent><child>tool</child></joint></model></sdf>""",
    "wrist.xml": """<mujoco model="wrist"><worldbody><body name="mast" pos="0 0 1"><joint name="turn" axis="0 0 1"/>
  <geom size="0.05" mass="2"/><body name="flange" pos="0 0 0.2"><geom size="0.001" mass="1e-6" contype="0"
  conaffinity="0"/><site name="ft"/><body name="tool" pos="0 0 0.05"><geom size="0.01" mass="1" pos="0.3 0 0.1"/></body>
  </body></body></worldbody><sensor><force name="pull" site="ft"/></sensor></mujoco>""",
}


@pytest.mark.parametrize("name", WRIST)
def test_a_sensor_at_a_fixed_joint_measures_what_it_carries(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text(WRIST[name])
    (tmp_path / "scene.py").write_text(SCENE.format(file=str(tmp_path / name)))
    with morse.load(tmp_path / "scene.py") as sim:
        sim.step(120)
        load = sim.robot.pull.get()
        assert load["force"] == pytest.approx([0.0, 0.0, -9.81], abs=0.01)
        # r x F with r = (0.3, 0, 0.15) m
        assert load["torque"] == pytest.approx([0.0, 0.3 * 9.81, 0.0], abs=0.01)


def test_an_ankle_on_the_ground_carries_its_share(tmp_path: Path) -> None:
    """Two feet, each fixed to a leg by a sensor, carry what is above them: half of 10 kg each."""
    foot = """<link name="leg_{n}"><inertial><mass value="0.5"/>
      <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <link name="foot_{n}"><inertial><mass value="0.2"/>
      <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
      <collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision></link>
      <joint name="hip_{n}" type="revolute"><parent link="trunk"/><child link="leg_{n}"/><origin xyz="0 {y} 0"/>
      <axis xyz="0 1 0"/><limit lower="-0.1" upper="0.1" effort="500" velocity="9"/></joint>
      <joint name="ankle_{n}" type="fixed"><parent link="leg_{n}"/><child link="foot_{n}"/>
      <origin xyz="0 0 -0.4"/></joint>
      <gazebo reference="ankle_{n}"><sensor name="load_{n}" type="force_torque"/></gazebo>"""
    text = """<robot name="legs"><link name="trunk"><inertial><mass value="9"/>
      <inertia ixx="0.2" iyy="0.2" izz="0.2" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
    text += foot.format(n=1, y=0.2) + foot.format(n=2, y=-0.2) + "</robot>"
    (tmp_path / "legs.urdf").write_text(text)
    (tmp_path / "scene.py").write_text(
        SCENE.format(file=str(tmp_path / "legs.urdf")).replace("env =", "robot.translate(z=0.45)\nenv =")
    )
    with morse.load(tmp_path / "scene.py") as sim:
        sim.step(180)
        # what the foot exerts on the leg: the ground lifts the leg by what stands on it
        for name in ("load_1", "load_2"):
            assert getattr(sim.robot, name).get()["force"][2] == pytest.approx(0.5 * 10.0 * 9.81, rel=0.02)
