"""Robots from URDF files that drive on wheels with motors, and whose arms have no masses if the script wants it."""

from pathlib import Path

import pytest

import morse
from tests.kit.scenes import Load

WHEEL = """<link name="{side}_wheel"><inertial><mass value="0.5"/>
    <inertia ixx="0.001" iyy="0.002" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <joint name="{side}" type="continuous"><parent link="base"/><child link="{side}_wheel"/><origin xyz="0 {y} 0"/>
    <axis xyz="0 1 0"/></joint>"""
ROVER = f"""<robot name="rover">
  <link name="base"><inertial><origin xyz="-0.05 0 0"/><mass value="6"/>
    <inertia ixx="0.05" iyy="0.08" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0 0 0.05"/><geometry><box size="0.4 0.2 0.05"/></geometry></collision></link>
  {WHEEL.format(side="left", y=0.2)}
  {WHEEL.format(side="right", y=-0.2)}
  <link name="caster"><inertial><mass value="0.1"/></inertial>
    <collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <joint name="roll" type="continuous"><parent link="base"/><child link="caster"/><origin xyz="-0.15 0 -0.05"/>
    <axis xyz="0 1 0"/></joint>
</robot>"""
SCENE = """
from morse.builder import *
rover = Robot({file!r})
rover.translate(z=0.1)
motors = Armature(armature_name='rover_joints')
{more}
rover.append(motors)
wheels = ArmaturePose()
motors.append(wheels)
pose = Pose()
rover.append(pose)
env = Environment('empty')
"""


@pytest.fixture
def rover(tmp_path: Path, load: Load) -> Load:
    def start(more: str):
        (tmp_path / "rover.urdf").write_text(ROVER)
        simulation = load(SCENE.format(file=str(tmp_path / "rover.urdf"), more=more), sockets=False)
        return simulation.rover, simulation

    return start


def test_wheels_that_are_told_a_speed_roll(rover) -> None:
    robot, sim = rover("motors.control('velocity', ['left', 'right'])\nmotors.control('effort', ['roll'])")
    robot.motors.publish({"left": 3.0, "right": 3.0, "roll": 0.0})
    sim.step(120)
    before = robot.pose.get()["x"]
    sim.step(120)
    # v = w r
    assert (robot.pose.get()["x"] - before) / 2.0 == pytest.approx(3.0 * 0.1, rel=0.03)
    speeds = robot.motors.wheels.get_velocities().result()
    assert speeds["left"] == pytest.approx(3.0, rel=0.01)
    assert speeds["roll"] == pytest.approx(6.0, rel=0.05), "the caster is half as large"


def test_wheels_against_each_other_turn_the_robot(rover) -> None:
    robot, sim = rover("motors.control('velocity', ['left', 'right'])\nmotors.control('effort', ['roll'])")
    robot.motors.publish({"left": -2.0, "right": 2.0, "roll": 0.0})
    sim.step(60)
    before = robot.pose.get()["yaw"]
    sim.step(60)
    # (v_right - v_left) / width if nothing slides; the caster cannot steer, and slides sideways
    rate = 2.0 * 2.0 * 0.1 / 0.4
    assert 0.75 * rate < robot.pose.get()["yaw"] - before < 1.01 * rate


def test_torques_on_the_wheels_accelerate_it(rover) -> None:
    robot, sim = rover("motors.control('effort')")
    torque = 0.2
    robot.motors.publish({"left": torque, "right": torque, "roll": 0.0})
    sim.step(6)
    first = robot.motors.wheels.get_velocities().result()["left"] * 0.1
    sim.step(60)
    second = robot.motors.wheels.get_velocities().result()["left"] * 0.1
    # F = 2 T / r; the mass of the robot, and that of the turning wheels I / r^2
    mass = 6.0 + 2 * 0.5 + 0.1 + 2 * 0.002 / 0.1**2
    assert second - first == pytest.approx(2.0 * torque / 0.1 / mass, rel=0.06)


def test_joints_without_masses_if_the_script_wants_it(rover) -> None:
    robot, sim = rover("motors.properties(Dynamic=False)")
    sim.step(2)
    assert robot.motors.get_controls().result() == {}
    robot.motors.set_rotation("left", 1.0).result()
    sim.step(2)
    assert robot.motors.wheels.get()["left"] == 1.0, "at once, as in MORSE 1.4"
    assert robot.motors.wheels.get_efforts().result() == {}


TRANSMISSIONS = "".join(
    f"<transmission name='{side}'><joint name='{side}'><hardwareInterface>VelocityJointInterface</hardwareInterface>"
    "</joint></transmission>"
    for side in ("left", "right")
)


@pytest.mark.parametrize("drive", ["MotionVWDiff", "MotionVW", "MotionXYW"])
def test_second_drive_is_named_with_the_first_one(tmp_path: Path, caplog, drive):
    (tmp_path / "rover.urdf").write_text(ROVER.replace("</robot>", TRANSMISSIONS + "</robot>"))
    script = tmp_path / "scene.py"
    text = "from morse.builder import *\nrover = Robot('rover.urdf')\n{}\nenv = Environment('empty')\n"
    script.write_text(text.format(f"rover.append({drive}('drive'))"))
    with morse.load(script):
        pass
    message = next(text for text in caplog.messages if "both set the speed" in text)
    assert f"'rover.motion' ({script}:2)" in message
    assert f"'rover.drive' ({script}:3)" in message
    assert "robot.actuators['motion']" in message


def test_one_drive_and_the_keyboard_work_together(tmp_path: Path, caplog):
    script = tmp_path / "scene.py"
    drives = "robot = ATRV()\nrobot.append(Keyboard('keys'))\nrobot.append(MotionVW('drive'))\n"
    script.write_text(f"from morse.builder import *\n{drives}env = Environment('empty')\n")
    with morse.load(script):
        pass
    assert not [text for text in caplog.messages if "both set the speed" in text]
