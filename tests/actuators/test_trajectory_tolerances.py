"""A pendulum of 2 kg at 0.4 m: what keeps it from a path, and what a weak motor cannot do."""

import math

import pytest

from pymorse import MorseServiceFailed

MASS, LENGTH, GRAVITY = 2.0, 0.4, 9.81
#: less than the 7.85 N m with which it would be held level
EFFORT = 5.0
URDF = f"""
<robot name="beam">
  <link name="world"/>
  <joint name="mount" type="fixed"><parent link="world"/><child link="base"/><origin xyz="0 0 1"/></joint>
  <link name="base"><inertial><mass value="5"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hinge" type="revolute"><parent link="base"/><child link="rod"/><axis xyz="0 -1 0"/>
    <limit lower="-2" upper="2" effort="{EFFORT}" velocity="5"/></joint>
  <link name="rod"><inertial><origin xyz="0 0 -{LENGTH}"/><mass value="{MASS}"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>
"""


@pytest.fixture
def sim(simulate, tmp_path):
    path = tmp_path / "beam.urdf"
    path.write_text(URDF)
    scene = f"robot = Robot(r'{path}')\narm = Armature('arm', armature_name='beam_joints')\nrobot.append(arm)"
    simulation = simulate(scene, sockets=False)
    simulation.step(30)
    return simulation


def follow(sim, angle, seconds, **tolerances):
    points = [{"positions": [angle], "velocities": [0.0], "time_from_start": seconds}]
    return sim.robot.arm.trajectory({"points": points, **tolerances})


def angle(sim):
    return sim.context.component("robot.arm").joint_values[0]


def test_a_motor_that_is_too_weak_leaves_the_path(sim):
    # it holds sin(q) = effort / m g l at most
    most = math.asin(EFFORT / (MASS * GRAVITY * LENGTH))
    with pytest.raises(MorseServiceFailed, match="PATH_TOLERANCE_VIOLATED: the position of 'hinge' differs by"):
        follow(sim, 1.5, 6.0, path_tolerance=0.2).result(20.0)
    assert angle(sim) == pytest.approx(most, abs=0.1)
    assert sim.time() < 6.0


def test_it_is_given_time_to_arrive_and_no_more(sim):
    start = sim.time()
    with pytest.raises(MorseServiceFailed, match="GOAL_TOLERANCE_VIOLATED: the position of 'hinge' differs by"):
        follow(sim, 1.4, 2.0, goal_tolerance={"hinge": 0.1}, goal_time_tolerance=1.5).result(20.0)
    assert sim.time() - start == pytest.approx(3.5, abs=0.05)


def test_what_it_can_do_is_done_within_the_tolerances(sim):
    follow(sim, 0.5, 2.0, path_tolerance=0.1, goal_tolerance={"hinge": {"position": 0.01, "velocity": 0.1}}).result(
        20.0
    )
    assert angle(sim) == pytest.approx(0.5, abs=0.01)


def test_a_velocity_that_differs_is_named(sim):
    with pytest.raises(MorseServiceFailed, match="the velocity of 'hinge' differs by"):
        follow(sim, 1.5, 3.0, path_tolerance={"hinge": {"velocity": 0.3}}).result(20.0)
