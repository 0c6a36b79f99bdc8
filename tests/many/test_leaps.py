"""A step of many ticks has the bits of as many steps of one tick."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from many_scenes import block, body

import morse
from effort import examples
from morse.kernel.loading import library

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
        run = type(sim.context.world).step_freely
        sim.context.world.step_freely = lambda most: ticks.append(run(sim.context.world, most)) or ticks[-1]
        sim.step(60, measure=True)
        assert sum(ticks) > 40
