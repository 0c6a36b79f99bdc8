"""The gains of motors: how far a joint sags is its load divided by its stiffness."""

import pytest

from pymorse import MorseServiceFailed

MASS, LENGTH, GRAVITY = 2.0, 0.4, 9.81
URDF = f"""
<robot name="beam">
  <link name="world"/>
  <joint name="mount" type="fixed"><parent link="world"/><child link="base"/><origin xyz="0 0 1"/></joint>
  <link name="base"><inertial><mass value="5"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hinge" type="revolute"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="100" velocity="5"/></joint>
  <link name="rod"><inertial><origin xyz="{LENGTH} 0 0"/><mass value="{MASS}"/>
    <inertia ixx="0.001" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="sledge"/><axis xyz="0 0 1"/>
    <limit lower="-0.5" upper="0.5" effort="200" velocity="5"/></joint>
  <link name="sledge"><inertial><mass value="{MASS}"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>
"""
SCENE = """
robot = Robot(r"{path}")
arm = Armature("arm", armature_name="beam_joints")
{more}
robot.append(arm)
joints = ArmaturePose("joints")
arm.append(joints)
robot.append(ForceTorqueSensor("load"), "rod")
"""


@pytest.fixture
def start(simulate, tmp_path):
    """Loads the beam, with more lines of the script."""
    path = tmp_path / "beam.urdf"
    path.write_text(URDF)
    return lambda more="": simulate(SCENE.format(path=path, more=more), sockets=False)


def angles(sim):
    sim.step(600)
    return sim.robot.arm.joints.get()


def test_a_joint_sags_by_its_load_over_its_stiffness(start):
    sim = start("arm.gains(400.0, 40.0, ['hinge']); arm.gains(stiffness=2000.0, damping=200.0, joints='slide')")
    state = angles(sim)
    # m g l cos(q) = k q; m g = k x
    angle = MASS * GRAVITY * LENGTH / 400.0
    assert state["hinge"] == pytest.approx(angle, rel=1e-3)
    assert state["slide"] == pytest.approx(-MASS * GRAVITY / 2000.0, rel=1e-3)
    gains = sim.robot.arm.get_gains().result()
    assert gains["hinge"] == {"stiffness": 400.0, "damping": 40.0}
    # the load of the joint, about the sensor at the hinge: force down, torque about Y
    load = sim.robot.load.get()
    assert load["torque"][1] == pytest.approx(MASS * GRAVITY * LENGTH, rel=1e-2)
    assert sum(value**2 for value in load["force"]) ** 0.5 == pytest.approx(MASS * GRAVITY, rel=1e-3)


def test_gains_are_set_while_it_runs_and_outlast_a_change_of_the_mode(start):
    sim = start()
    sim.robot.arm.set_gains(200.0, 20.0, ["hinge"]).result()
    assert angles(sim)["hinge"] == pytest.approx(MASS * GRAVITY * LENGTH / 200.0, rel=2e-3)
    sim.robot.arm.set_control("effort", ["hinge"]).result()
    sim.robot.arm.set_control("position", ["hinge"]).result()
    assert sim.robot.arm.get_gains().result()["hinge"] == {"stiffness": 200.0, "damping": 20.0}
    sim.robot.arm.set_gains(400.0).result()
    assert sim.robot.arm.get_gains().result()["hinge"] == {"stiffness": 400.0, "damping": 20.0}


def test_a_motor_for_velocities_lags_by_its_load_over_its_damping(start):
    sim = start("arm.control('velocity', ['slide']); arm.gains(damping=100.0, joints=['slide'])")
    sim.step(1)
    sim.robot.arm.publish({"slide": 0.2})
    sim.step(120)
    velocity = sim.robot.arm.joints.get_velocities().result()["slide"]
    assert velocity == pytest.approx(0.2 - MASS * GRAVITY / 100.0, abs=2e-3)


def test_wrong_gains_are_refused(start):
    sim = start()
    for arguments, message in (((-1.0,), "-1.0"), ((1.0, 1.0, ["hinges"]), "did you mean 'hinge'")):
        with pytest.raises(MorseServiceFailed, match=message):
            sim.robot.arm.set_gains(*arguments).result()


def test_a_script_with_wrong_gains_is_refused(start):
    from morse.core.exceptions import MorseError

    with pytest.raises(MorseError, match="gains: 'arm' has no joint 'hing'"):
        start("arm.gains(1.0, 1.0, ['hing'])")
    with pytest.raises(MorseError, match="gains\\(stiffness\\)"):
        start("arm.gains(-1.0)")
