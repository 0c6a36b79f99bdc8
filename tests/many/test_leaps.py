"""A step of many ticks has the bits of as many steps of one tick."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from many_scenes import block, body

import morse
from morse.kernel.loading import library
from tests.kit.effort import examples

PLACES = [(0.0, 0.0, 0.0), (1.2, 0.5, 2.0), (-1.0, -1.5, -1.0)]


def yard(wheels=False):
    """Two planar robots, and one on wheels, with sensors of several rates, among walls and a crate."""
    from morse.builder import (
        GPS,
        Environment,
        MotionVW,
        MotionVWDiff,
        Odometry,
        Pioneer3DX,
        Pose,
        Robot,
        Sick,
        Velocity,
    )

    for name, x, motion in (("robot", 0.0, MotionVW("motion")), ("second", 1.0, MotionVW("motion"))):
        robot = Robot(name=name)
        body(robot)
        robot.translate(x, -0.8, 0.0)
        laser, gps, odometry = Sick("laser"), GPS("gps"), Odometry("odometry")
        laser.translate(0.0, 0.0, 0.2)
        laser.frequency(10)
        gps.frequency(7)
        odometry.frequency(20)
        velocity = Velocity("velocity")
        velocity.frequency(4)
        for part in (motion, laser, gps, odometry, Pose("pose"), velocity):
            robot.append(part)
    if wheels:
        third = Pioneer3DX("third")
        third.translate(1.0, 1.0, 0.0)
        for part in (MotionVWDiff("motion"), Pose("pose"), Odometry("odometry")):
            third.append(part)
    block("Crate", -1.0, 0.3, 0.2, 0.2, static=False)
    for number, wall in enumerate([(2.5, 0.0, 0.1, 2.5), (-2.5, 0.0, 0.1, 2.5), (0.0, 2.5, 2.5, 0.1)]):
        block(f"Wall{number}", *wall)
    Environment("empty")


speeds = st.one_of(st.just(0.0), st.floats(-2.0, 2.0).map(lambda speed: round(speed, 2)))
acts = st.one_of(
    st.tuples(st.just("drive"), st.tuples(speeds, speeds, speeds, speeds)),
    st.tuples(st.sampled_from(["place", "read", "listen", "sleep"]), st.sampled_from(PLACES)),
)


def act_on(sim, kind, value):
    if kind == "drive":
        sim.robot.motion.publish({"v": value[0], "w": value[1]})
        sim.second.motion.publish({"v": value[2], "w": value[3]})
        if "third" in sim.robots:
            sim.third.motion.publish({"v": value[2], "w": value[1]})
    elif kind == "place":
        sim.robot.place(value)
    elif kind == "read":
        sim.robot.odometry.component.local_data["x"]
    elif kind == "listen":
        sim.robot.gps.last()
    else:
        sim.call("time", "sleep", 0.15)


@settings(max_examples=examples(40))
@given(
    script=st.lists(st.tuples(acts, st.integers(2, 40), st.booleans(), st.booleans()), min_size=1, max_size=6),
    watched=st.booleans(),
    scene=st.sampled_from([yard, lambda: yard(wheels=True)]),
)
def test_many_ticks_are_as_single_ticks(script, watched, scene):
    with morse.load(scene, seed=5) as leaping, morse.load(scene, seed=5) as single:
        contacts = [sim.robot.contacts() for sim in (leaping, single)] if watched else []
        for (kind, value), ticks, measure, reads in script:
            for sim in (leaping, single):
                act_on(sim, kind, value)
            leaping.step(ticks, measure=measure)
            touched, impulse = False, 0.0
            for tick in range(ticks):
                single.step(1, measure=measure and tick == ticks - 1)
                if watched:
                    touched |= contacts[1].touched
                    impulse += contacts[1].impulse
            if watched:
                assert contacts[0].touched == touched
                assert abs(contacts[0].impulse - impulse) <= 1e-9 * impulse
            assert leaping.time() == single.time()
            if reads:
                for name in leaping.robots:
                    for part in leaping[name].parts:
                        first, second = (sim[name].parts[part].data for sim in (leaping, single))
                        assert repr(first) == repr(second), part
            assert leaping.state_hash() == single.state_hash()


@pytest.mark.skipif(library() is None, reason="without the kernel, each tick is run")
def test_ticks_are_left_out():
    """Without this, the test above compares nothing."""
    with morse.load(yard) as sim:
        sim.robot.motion.publish({"v": 0.3, "w": 0.9})
        sim.second.motion.publish({"v": 0.2, "w": 0.9})
        sim.step(60)
        ticks = []
        run = type(sim.context.world).advance
        sim.context.world.advance = lambda most: ticks.append(run(sim.context.world, most)) or ticks[-1]
        sim.step(60, measure=True)
        assert sum(ticks) > 40
        assert len(ticks) < 20


#: a body on a leg, which falls over, with sensors of its file; a ball that rolls away from it
HOPPER = """<mujoco model="hopper"><option timestep="0.004"/><worldbody>
  <body name="trunk" pos="0 0 0.6"><freejoint/><geom type="sphere" size="0.1" mass="2"/><site name="imu"/>
    <camera name="eye" pos="0.1 0 0"/>
    <body name="leg"><joint name="hip" axis="0 1 0" range="-60 60" damping="0.1"/>
      <geom name="leg" type="capsule" fromto="0 0 0 0.05 0 -0.45" size="0.03" mass="0.5"/>
      <site name="foot" pos="0.05 0 -0.45" size="0.05"/></body></body></worldbody>
  <actuator><position name="servo" joint="hip" kp="20"/></actuator>
  <sensor><accelerometer site="imu"/><gyro site="imu"/><velocimeter site="imu"/><force site="foot"/>
    <touch site="foot"/></sensor></mujoco>"""


def hopper(folder, rates):
    """The robot of the file, with its sensors at several rates, and something that sleeps in the end."""
    from morse.builder import Armature, Environment, Odometry, Pose, Robot

    file = folder / "hopper.xml"
    file.write_text(HOPPER)

    def scene():
        robot = Robot(str(file))
        robot.name = "robot"
        for number, sensor in enumerate(robot.sensors.values()):
            sensor.frequency(rates[number % len(rates)])
        for part in (Pose("pose"), Odometry("odometry")):
            part.frequency(rates[-1])
            robot.append(part)
        if rates[0] == 12:
            robot.append(Armature("joints", armature_name="hopper_joints"))
        block("crate", 1.0, 0.0, 0.5, 0.2, static=False)
        Environment("empty")

    return scene


@settings(max_examples=examples(16))
@given(
    script=st.lists(
        st.tuples(st.sampled_from(["go", "aim", "place", "watch", "read", "kick"]), st.integers(2, 80), st.booleans()),
        min_size=1,
        max_size=5,
    ),
    rates=st.sampled_from([(60, 60, 30), (60, 20, 7), (12, 60, 4)]),
)
def test_ticks_of_the_engine_alone_are_as_single_ticks(tmp_path_factory, script, rates):
    scene = hopper(tmp_path_factory.mktemp("file"), rates)
    with morse.load(scene, seed=5) as leaping, morse.load(scene, seed=5) as single:
        for what, ticks, measure in script:
            for sim in (leaping, single):
                if what == "place":
                    sim.robot.place((0.2, 0.1, 0.8))
                elif what == "aim" and rates[0] == 12:
                    sim.robot.joints.publish({"hip": 0.01 * ticks})
                elif what == "watch":
                    assert sim.robot.eye.get()["image"] is not None
                elif what == "kick":  # so hard that the engine diverges
                    sim.context.world.data.qvel[-6] = 1e12
                elif what == "read":
                    sim.robot.pose.component.local_data["x"]
            leaping.step(ticks, measure=measure)
            for tick in range(ticks):
                single.step(1, measure=measure and tick == ticks - 1)
            assert leaping.time() == single.time()
            assert leaping.state_hash() == single.state_hash()
            for name, part in leaping.robot.parts.items():
                assert repr(part.data) == repr(single.robot.parts[name].data), name


def test_a_camera_that_nobody_reads_and_sensors_of_a_file_end_no_leap(tmp_path):
    with morse.load(hopper(tmp_path, (60, 20, 7))) as sim:
        sim.step(30)
        ticks = []
        run = type(sim.context.world).advance
        sim.context.world.advance = lambda most: ticks.append(run(sim.context.world, most)) or ticks[-1]
        sim.step(60)
        assert sum(ticks) > 50
        assert len(ticks) < 10
