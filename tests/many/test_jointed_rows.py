"""Rows in which motors and the engine alone move something have the bits of single simulations."""

import math
import os
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from many_scenes import block

import morse
from tests.kit.effort import examples
from tests.kit.programs import python

MODEL = Path(__file__).parent / "spider.xml"
PICKER = Path(__file__).parents[2] / "examples" / "joints" / "picker.urdf"
#: where programs of these tests find this module
PATHS = os.pathsep.join([str(MODEL.parent), str(MODEL.parents[2]), *sys.path])
JOINTS = ("hip_a", "knee_a", "hip_b", "knee_b", "hip_c", "knee_c")
FIELDS = {
    "robot.legs.angles": (),
    "robot.pose": ("x", "z", "roll", "yaw"),
    "robot.laser": ("range_list",),
    "robot.imu": ("angular_velocity",),
    "robot.velocity": ("world_linear_velocity", "angular_velocity", "linear_velocity"),
}
PLACES = [(0.0, 0.0, 0.0), (0.6, 0.5, 2.0), (-0.4, -0.5, 0.4, 0.3, 0.2, 1.0)]


def meadow(control, model=MODEL):
    """A robot with three legs between walls, with sensors that are mounted apart."""
    from morse.builder import IMU, Armature, ArmaturePose, Environment, Odometry, Pose, Robot, Sick, Velocity

    robot = Robot(str(model), name="robot")
    legs, laser, pose = Armature("legs", armature_name="spider_joints"), Sick("laser"), Pose("pose")
    imu, velocity = IMU("imu"), Velocity("velocity")
    for sensor in (imu, velocity):
        sensor.translate(0.0, 0.1, 0.0)
        sensor.rotate(0.3, 0.0, 0.2)
    legs.control(control)
    legs.properties(RotationSpeed=2.0)
    legs.append(ArmaturePose("angles"))
    laser.level("range")
    laser.properties(scan_window=40, resolution=10)
    laser.translate(0.05, 0.0, 0.1)
    pose.translate(0.1, 0.0, 0.05)
    for part in (legs, laser, pose, imu, velocity, Odometry("odometry")):
        robot.append(part)
    for number, wall in enumerate([(1.5, 0.0, 0.1, 1.5), (-1.5, 0.0, 0.1, 1.5)]):
        block(f"Wall{number}", *wall)
    Environment("empty")


def stepped_alone(many):
    """The rows that simulations step by themselves in the next step."""
    steps, run, simulations = [], morse.Simulation.step, many._simulations
    try:
        morse.Simulation.step = lambda self, *a, **k: steps.append(simulations.index(self)) or run(self, *a, **k)
        many.step(1, measure=True)
    finally:
        morse.Simulation.step = run
    return steps


numbers = st.one_of(st.sampled_from([0.0, -0.0, 0.2, 9.0]), st.floats(-3.0, 3.0).map(lambda number: round(number, 2)))
#: of a row before a step
acts = st.one_of(
    *[st.tuples(st.just("move"), st.lists(numbers, min_size=6, max_size=6))] * 3,
    st.tuples(
        st.sampled_from(["idle", "place", "restart", "measure", "save", "vary", "again"]), st.sampled_from(PLACES)
    ),
)
steps = st.tuples(acts, acts, acts, st.sampled_from([1, 1, 2, 5, 20]), st.sampled_from([True, True, True, False]))


@settings(max_examples=examples(25))
@given(
    script=st.lists(steps, min_size=3, max_size=14),
    control=st.sampled_from(["effort", "position", "velocity"]),
    scans=st.booleans(),
    fields=st.sampled_from([JOINTS, ("knee_b", "hip_a", "knee_a", "hip_c", "knee_c", "hip_b"), JOINTS[:2]]),
)
def test_rows_that_nobody_looks_at(script, control, scans, fields):
    scene = partial(meadow, control)
    alone, states = [morse.load(scene, seed=4 + row) for row in range(3)], [None] * 3
    with morse.batch(scene, 3, seed=4) as many:
        legs = many.command("robot.legs", *fields)
        columns = {name: many.read(name, *names) for name, names in FIELDS.items() if scans or "laser" not in name}
        commands = [None] * 3
        for *each, ticks, measure in script:
            for row, ((kind, value), sim) in enumerate(zip(each, alone, strict=True)):
                if kind == "move":
                    legs[row] = commands[row] = value[: len(fields)]
                elif kind == "place":
                    many.place(row, "robot", value)
                    sim.robot.place(value)
                elif kind == "restart":
                    many.restart(row)
                    sim.restart(sim.seed())
                    commands[row] = None
                elif kind == "measure":
                    many.measure(row)
                    sim.measure()
                elif kind == "vary":
                    many.vary("robot", rows=row, mass=3.0 + value[1])
                    sim.robot.set_mass(3.0 + value[1])
                elif kind == "save":
                    states[row] = sim.save()
                    assert many.save(row)[0].hash() == states[row].hash()
                elif kind == "again" and states[row] is not None:
                    many.restore(row, states[row])
                    sim.restore(states[row])
                    commands[row] = None
            many.step(ticks, measure=measure)
            for row, sim in enumerate(alone):
                if commands[row]:
                    sim.robot.legs.publish(dict(zip(fields, commands[row], strict=True)))
                sim.step(ticks, measure=measure)
                for name, array in columns.items():
                    handle = sim.robot.legs.angles if "angles" in name else sim.robot.parts[name.split(".")[1]]
                    data = handle.data
                    values = np.hstack([data[field] for field in FIELDS[name] or data])
                    if len(values) == array.shape[1]:  # a scanner that has not measured yet has no data
                        assert (array[row] == values).all(), name
        for row, sim in enumerate(alone):
            assert many.save(row)[0].hash() == sim.state_hash()
            for part in ("legs", "pose", "laser", "imu", "velocity", "odometry"):
                assert repr(many[row].robot.parts[part].data) == repr(sim.robot.parts[part].data)
            assert many[row].robot.legs.angles.get_efforts() == sim.robot.legs.angles.get_efforts()
    for sim in alone:
        sim.close()


def test_rows_are_stepped_together():
    """Without this, the test above compares nothing."""
    with morse.batch(partial(meadow, "effort"), 4) as many:
        legs = many.command("robot.legs")
        for name, fields in FIELDS.items():
            many.read(name, *fields)
        legs[:] = 0.5
        assert stepped_alone(many) == []
        many.restart([1])
        assert stepped_alone(many) == []
        legs[:] = 0.7
        many.place([3], "robot", PLACES[1])
        assert stepped_alone(many) == [3]
        assert stepped_alone(many) == []
        simulation = many[2]
        assert stepped_alone(many) == [2], "somebody may look at it, or give it commands"
        assert simulation.ticks == 5


def bowling(model):
    """The robot, and a ball that falls on it."""
    from morse.builder import Sphere

    meadow("effort", model)
    ball = Sphere("ball")
    ball.scale = (0.08, 0.08, 0.08)
    ball.translate(0.05, 0.0, 0.9)
    ball.set_rigid_body()
    ball.set_mass(0.4)


@pytest.mark.parametrize("cone", ["pyramidal", "elliptic"])
def test_objects_that_roll_have_the_bits_of_a_simulation_alone(cone, tmp_path):
    model = tmp_path / "spider.xml"
    model.write_text(MODEL.read_text().replace("<option ", f'<option cone="{cone}" '))
    scene = partial(bowling, model)
    with morse.batch(scene, 2, seed=4) as many, morse.load(scene, seed=4) as sim:
        legs, pose = many.command("robot.legs"), many.read("robot.pose", "x", "z", "roll", "yaw")
        angles, by_themselves, ball = many.read("robot.legs.angles", *JOINTS), [], sim.world.game_object("ball")
        for number in range(60):
            command = [0.8 * (-1.0) ** (number // 7)] * 6
            legs[:] = command
            by_themselves.append(stepped_alone(many))
            sim.robot.legs.publish(dict(zip(JOINTS, command, strict=True)))
            sim.step(1, measure=True)
            assert (pose[0] == [sim.robot.pose.data[name] for name in ("x", "z", "roll", "yaw")]).all()
            assert (angles[0] == [sim.robot.legs.angles.data[name] for name in JOINTS]).all()
        assert many.save(0)[0].hash() == sim.state_hash()
        assert math.dist(ball.world_pose()[0], (0.05, 0.0, 0.9)) > 0.3
        # in the model of friction of elliptic cones, objects that slide have contacts that change within a tick
        assert bool(by_themselves[30]) == (cone == "elliptic")
        assert not by_themselves[1]


def bench():
    """An arm from a URDF file."""
    from morse.builder import Armature, ArmaturePose, Environment, Pose, Robot

    picker = Robot(str(PICKER), name="picker")
    arm = Armature("arm", armature_name="picker_joints")
    picker.append(arm)
    arm.append(ArmaturePose("angles"))
    picker.append(Pose("hand"), "hand")
    Environment("empty")


def test_arms_of_urdf_files_go_together_too():
    fields = ("turn", "shoulder", "elbow")
    with morse.batch(bench, 3, seed=4) as many, morse.load(bench, seed=5) as sim:
        arm, angles = many.command("picker.arm", *fields), many.read("picker.arm.angles", *fields)
        hand = many.read("picker.hand")
        for goal in (0.4, -0.2, 0.9):
            arm[:] = [goal, 0.5 * goal, -goal]
            for _ in range(10):
                assert stepped_alone(many) == []
            sim.picker.arm.publish(dict(zip(fields, arm[1].tolist(), strict=True)))
            sim.step(9)
            sim.step(1, measure=True)
            assert (angles[1] == [sim.picker.arm.angles.data[name] for name in fields]).all()
            assert (hand[1] == list(sim.picker.hand.data.values())).all()
        assert many.save(1)[0].hash() == sim.state_hash()


@pytest.mark.parametrize(("name", "field"), [("imu", "angular_velocity"), ("velocity", "linear_velocity")])
def test_a_sensor_on_a_link_has_the_velocity_of_the_robot_in_its_own_axes(name, field):
    """The leg that carries it turns against the robot."""

    def scene():
        from morse.builder import IMU, Armature, Environment, Robot, Velocity

        robot = Robot(str(MODEL), name="robot")
        legs = Armature("legs", armature_name="spider_joints")
        legs.control("velocity")
        for sensor in (IMU("imu"), Velocity("velocity")):
            sensor.properties(ComputationMode="Velocity")
            legs.append(sensor, "shin_a")
        robot.append(legs)
        Environment("empty")

    with morse.load(scene, seed=4) as alone, morse.batch(scene, 2, seed=4) as many:
        assert alone.robot.legs.imu.component.bge_object.slot != alone.robot.component.bge_object.slot
        legs, array = many.command("robot.legs"), many.read(f"robot.legs.{name}", field)
        for _ in range(10):
            legs[:] = 1.5
            many.step(6, measure=True)
            alone.robot.legs.publish(dict.fromkeys(JOINTS, 1.5))
            alone.step(6, measure=True)
            assert array[0].tolist() == list(alone.robot.legs.parts[name].data[field])
        assert np.abs(array[0]).max() > 0.01


def test_motors_of_tendons_go_together_too(tmp_path):
    model = tmp_path / "spider.xml"
    tendon = (
        '<tendon><fixed name="band"><joint joint="hip_a" coef="1"/><joint joint="knee_a" coef="0.5"/></fixed></tendon>'
    )
    pull = '<motor name="pull" tendon="band" ctrlrange="-3 3"/></actuator>'
    text = MODEL.read_text().replace("<actuator>", f"{tendon}<actuator>").replace("</actuator>", pull)
    model.write_text(text)
    scene = partial(meadow, "effort", model)
    with morse.batch(scene, 2, seed=4) as many, morse.load(scene, seed=5) as sim:
        legs, angles = many.command("robot.legs", "pull", "knee_b"), many.read("robot.legs.angles", *JOINTS)
        for force in (2.0, -9.0, -3.0, 0.5):
            legs[1] = force, 0.4
            assert stepped_alone(many) == []
            sim.robot.legs.publish({"pull": force, "knee_b": 0.4})
            sim.step(1, measure=True)
            assert (angles[1] == [sim.robot.legs.angles.data[name] for name in JOINTS]).all()
        assert many.save(1)[0].hash() == sim.state_hash()
        assert many[1].robot.legs.get_tendons() == sim.robot.legs.get_tendons()
        assert sim.robot.legs.get_tendons().result()["pull"]["force"] == 0.5


def test_a_single_row_goes_on_in_the_kernel():
    with morse.batch(partial(meadow, "effort"), 1) as many:
        legs, pose = many.command("robot.legs"), many.read("robot.pose", "z")
        legs[:] = 0.5
        before = pose.copy()
        assert stepped_alone(many) == []
        assert pose[0] != before[0]


def test_a_row_that_diverges_is_left_to_its_simulation():
    def run(seeds):
        with morse.batch(partial(meadow, "effort"), seed=seeds, rows=len(seeds)) as many:
            legs, pose = many.command("robot.legs"), many.read("robot.pose", "x", "y", "z")
            seen = []
            for number in range(30):
                legs[:] = np.where(np.array(seeds)[:, None] == 2, 1e6 * (-1.0) ** number, 0.1)
                many.step(2, measure=True)
                seen.append(pose.copy())
            return np.array(seen), [state.hash() for state in many.save()], [one.world.recovered for one in many]

    together, hashes, recovered = run([1, 2, 3])
    for row, seed in enumerate([1, 2, 3]):
        alone = run([seed])
        assert (together[:, row] == alone[0][:, 0]).all()
        assert hashes[row] == alone[1][0]
    assert recovered[0] == recovered[2] == 0


def test_a_robot_that_falls_out_of_its_world_is_reported(tmp_path):
    world = tmp_path / "bare.sdf"
    world.write_text('<sdf version="1.9"><world name="w"><light type="directional" name="sun"/></world></sdf>')

    def abyss():
        from morse.builder import Armature, Environment, Robot

        robot = Robot(str(MODEL), name="robot")
        robot.append(Armature("legs", armature_name="spider_joints"))
        Environment(str(world))

    simulation = morse.load(abyss)
    with morse.batch(abyss, seed=[simulation.seed()] * 2, rows=2) as many:
        for _ in range(150):
            many.step(1, measure=True)
            simulation.step(1, measure=True)
        assert [state.hash() for state in many.save()] == [simulation.state_hash()] * 2
        assert simulation.failures
        assert [[one.part for one in row] for row in many.failures] == [[one.part for one in simulation.failures]] * 2
    simulation.close()


PROGRAM = """
from test_jointed_rows import *

with morse.batch(partial(meadow, 'effort'), 6) as many:
    legs, pose = many.command('robot.legs'), many.read('robot.pose', 'x', 'y', 'z')
    for number in range(20):
        legs[:] = np.sin(np.arange(36).reshape(6, 6) + number)
        many.step(1, measure=True)
    print(pose.tobytes().hex(), [state.hash() for state in many.save()])
"""


def test_threads_make_no_difference():
    one, two = (python("-c", PROGRAM, MORSE_THREADS=number, PYTHONPATH=PATHS) for number in (1, 2))
    assert one.stdout, one.stderr
    assert one.stdout == two.stdout


FORK = """
import signal
from test_jointed_rows import *

with morse.batch(partial(meadow, 'effort'), 4) as many:
    legs, pose = many.command('robot.legs'), many.read('robot.pose', 'x', 'y', 'z')
    for number in range(6):
        legs[:] = np.sin(np.arange(24).reshape(4, 6) + number)
        many.step(1, measure=True)
        if number == 3:
            child = os.fork()
            signal.alarm(0 if child else 60)
    print(pose.tobytes().hex(), flush=True)
if child:
    assert os.waitpid(child, 0)[1] == 0
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are not forked here")
def test_a_forked_process_goes_on():
    """It has none of the threads of the engine."""
    done = python("-c", FORK, MORSE_THREADS=2, PYTHONPATH=PATHS)
    assert done.returncode == 0, done.stderr
    first, second = done.stdout.split()
    assert first == second
