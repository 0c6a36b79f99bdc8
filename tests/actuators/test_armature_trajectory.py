"""Trajectories of an arm against closed forms."""

import math

import pytest
from arms import load, values

from pymorse import MorseServiceFailed, MorseServicePreempted

REST = [0.0] * 7


def second(value):
    return [0.0, value, 0.0, 0.0, 0.0, 0.0, 0.0]


def run_through(sim, trajectory, ticks):
    """(simulated time since the start, angle of the second joint) of each tick."""
    arm = sim.context.component("robot.arm")
    began = sim.time()
    handle = sim.robot.arm.trajectory(trajectory)
    found = []
    for _ in range(ticks):
        sim.step(1)
        found.append((arm.clock.time - began, arm.joint_values[1]))
    return handle, found


def assert_follows(found, curve):
    """The angles follow the curve, with a delay of at most one tick."""
    tick = 1.0 / 60.0
    for time, angle in found:
        assert min(abs(angle - curve(time - lag * tick)) for lag in (0.0, 1.0)) < 1e-6


def test_straight_lines_between_positions(simulate):
    sim = load(simulate)
    points = [{"positions": second(0.6), "time_from_start": 1.0}, {"positions": second(0.0), "time_from_start": 2.0}]
    handle, found = run_through(sim, {"points": points}, 130)
    assert_follows(found, lambda t: 0.6 * max(0.0, min(t, 2.0 - t)))
    assert handle.result(1.0) is None


def test_cubic_between_velocities(simulate):
    sim = load(simulate)
    # from rest to rest: q = 3 s^2 - 2 s^3
    points = [{"positions": second(1.0), "velocities": REST, "time_from_start": 2.0}]
    _, found = run_through(sim, {"points": points}, 130)

    def curve(t):
        s = min(max(t / 2.0, 0.0), 1.0)
        return 3.0 * s**2 - 2.0 * s**3

    assert_follows(found, curve)


def test_cubic_through_a_point_in_motion(simulate):
    sim = load(simulate)
    # q = t^3 is a cubic: its values and slopes at 0.8 s and 1.2 s determine it
    points = [{"positions": second(t**3), "velocities": second(3.0 * t**2), "time_from_start": t} for t in (0.8, 1.2)]
    _, found = run_through(sim, {"points": points}, 70)
    assert_follows(found, lambda t: max(t, 0.0) ** 3)


def test_quintic_with_accelerations(simulate):
    sim = load(simulate)
    # minimum jerk (Flash and Hogan, 1985): q = 10 s^3 - 15 s^4 + 6 s^5
    points = [{"positions": second(1.0), "velocities": REST, "accelerations": REST, "time_from_start": 1.5}]
    _, found = run_through(sim, {"points": points}, 100)

    def curve(t):
        s = min(max(t / 1.5, 0.0), 1.0)
        return 10.0 * s**3 - 15.0 * s**4 + 6.0 * s**5

    assert_follows(found, curve)


def test_it_waits_for_its_start(simulate):
    sim = load(simulate)
    start = sim.time() + 1.0
    handle = sim.robot.arm.trajectory(
        {"starttime": start, "points": [{"positions": second(0.5), "time_from_start": 0.5}]}
    )
    sim.step(55)
    assert values(sim) == REST
    handle.result(2.0)
    assert sim.time() == pytest.approx(start + 0.5, abs=0.05)
    assert values(sim) == pytest.approx(second(0.5))


def test_points_that_are_past_are_left_out(simulate):
    sim = load(simulate)
    sim.step(120)
    points = [{"positions": second(2.0), "time_from_start": 0.5}, {"positions": second(0.4), "time_from_start": 2.0}]
    _, found = run_through(sim, {"starttime": sim.time() - 1.0, "points": points}, 70)
    assert max(angle for _, angle in found) == pytest.approx(0.4)
    assert_follows(found, lambda t: 0.4 * min(max(t, 0.0), 1.0))


def test_limits_are_kept(simulate):
    sim = load(simulate)
    _, found = run_through(sim, {"points": [{"positions": second(4.0), "time_from_start": 1.0}]}, 70)
    assert max(angle for _, angle in found) == pytest.approx(math.radians(120), abs=1e-4)


def test_a_trajectory_is_preempted_and_stays(simulate):
    sim = load(simulate)
    handle, found = run_through(sim, {"points": [{"positions": second(1.0), "time_from_start": 2.0}]}, 60)
    handle.cancel()
    with pytest.raises(MorseServicePreempted):
        handle.result(1.0)
    here = values(sim)[1]
    assert here == pytest.approx(found[-1][1], abs=0.03)
    sim.step(60)
    assert values(sim)[1] == here


def test_a_restored_state_goes_on(simulate):
    sim = load(simulate)
    points = [{"positions": second(0.1 * i), "time_from_start": 0.2 * i} for i in range(1, 10)]
    run_through(sim, {"points": points}, 20)
    state = sim.save()
    sim.step(50)
    there = values(sim)
    sim.restore(state)
    sim.step(50)
    assert values(sim) == there


@pytest.mark.parametrize(
    ("trajectory", "words"),
    [
        ({}, r"'points' is None"),
        ({"points": []}, r"1 to"),
        ({"points": 3}, r"'points' is 3"),
        ({"points": [{"positions": [0.0], "time_from_start": 1.0}]}, r"7 numbers: kuka_1"),
        ({"points": [{"positions": REST}]}, r"time_from_start"),
        ({"points": [{"positions": REST, "time_from_start": -1.0}]}, r"from 0"),
        ({"points": [{"positions": REST, "time_from_start": "soon"}]}, r"time_from_start"),
        ({"points": [{"positions": ["a"] * 7, "time_from_start": 1.0}]}, r"7 numbers"),
        ({"points": [{"positions": REST, "velocities": [1.0], "time_from_start": 1.0}]}, r"velocities"),
        (
            {"points": [{"positions": REST, "time_from_start": 1.0}] * 2},
            r"larger value than that of the previous point",
        ),
        ({"points": [[0.0] * 7]}, r"object"),
        ({"starttime": "now", "points": [{"positions": REST, "time_from_start": 1.0}]}, r"starttime"),
        ({"pionts": []}, r"not 'pionts'"),
    ],
)
def test_mistakes_fail(simulate, trajectory, words):
    sim = load(simulate)
    with pytest.raises(MorseServiceFailed, match=words):
        sim.robot.arm.trajectory(trajectory).result(1.0)
    assert values(sim) == REST


def test_a_trajectory_of_some_joints_leaves_the_others_to_their_setpoints(simulate):
    sim = load(simulate)
    path = {"joints": ["kuka_4", "kuka_2"], "points": [{"positions": [0.3, 0.6], "time_from_start": 1.0}]}
    handle = sim.robot.arm.trajectory(path)
    sim.step(6)
    sim.robot.arm.set_rotation("kuka_6", 0.4)
    handle.result(2.0)
    assert values(sim) == pytest.approx([0.0, 0.6, 0.0, 0.3, 0.0, 0.4, 0.0])


def test_a_command_of_a_joint_ends_the_trajectory_of_this_joint(simulate):
    sim = load(simulate)
    handle = sim.robot.arm.trajectory({"joints": ["kuka_2"], "points": [{"positions": [1.0], "time_from_start": 2.0}]})
    sim.step(30)
    sim.robot.arm.set_rotation("kuka_2", 0.2)
    with pytest.raises(MorseServicePreempted):
        handle.result(1.0)
    assert values(sim)[1] == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        ({"joints": ["kuka_9"]}, "there is no joint 'kuka_9'"),
        ({"joints": ["kuka_1", "kuka_1"]}, "the joint 'kuka_1' is named twice"),
        ({"joints": []}, "expected a list of names of joints"),
        ({"goal_tolerance": {"kuka_7": {"speed": 1.0}}}, "expected position and velocity"),
        ({"goal_tolerance": {"kuka_8": 0.1}}, "'goal_tolerance' has no joint 'kuka_8'"),
        ({"path_tolerance": -1.0}, "'path_tolerance' is -1.0"),
        ({"path_tolerance": "tight"}, "'path_tolerance' is 'tight'"),
        ({"goal_time_tolerance": -1.0}, "'goal_time_tolerance' is -1.0"),
        ({"tolerance": 0.1}, "not 'tolerance'"),
    ],
)
def test_what_a_trajectory_says_about_joints_and_tolerances_is_checked(simulate, entries, message):
    sim = load(simulate)
    with pytest.raises(MorseServiceFailed, match=message):
        sim.robot.arm.trajectory({"points": [{"positions": REST, "time_from_start": 1.0}], **entries})


# -- a pendulum of 2 kg at 0.4 m: what keeps it from a path, and what a weak motor cannot do -------

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
