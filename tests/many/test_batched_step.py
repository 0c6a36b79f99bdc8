"""Rows that the kernel runs together have the bits of single simulations, at whatever time somebody looks."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from many_scenes import arena, block, body

import morse
from morse.kernel.loading import library
from tests.kit.effort import examples

FIELDS = {"robot.pose": ("x", "y", "yaw"), "robot.laser": ("range_list",), "robot.gps": ("x", "z")}
PLACES = [(0.0, 0.0, 0.0), (1.2, 0.5, 2.0), (-1.0, -1.5, -1.0)]


def yard():
    """A planar robot with sensors that are mounted apart, among walls and a crate."""
    from morse.builder import GPS, Environment, MotionVW, Pose, Robot, Sick

    robot, laser, gps = Robot(name="robot"), Sick("laser"), GPS("gps")
    body(robot)
    laser.translate(0.1, 0.0, 0.2)
    laser.rotate(z=0.3)
    laser.level("range")
    gps.translate(0.1, 0.2, 0.3)
    gps.frequency(7)
    for part in (MotionVW("motion"), laser, gps, Pose("pose")):
        robot.append(part)
    block("Crate", -1.0, 0.3, 0.2, 0.2, static=False)
    for number, wall in enumerate([(2.5, 0.0, 0.1, 2.5), (-2.5, 0.0, 0.1, 2.5), (0.0, 2.5, 2.5, 0.1)]):
        block(f"Wall{number}", *wall)
    Environment("empty")


speeds = st.one_of(st.sampled_from([0.0, -0.0, 0.2]), st.floats(-2.0, 2.0).map(lambda speed: round(speed, 2)))
#: of a row before a step
acts = st.one_of(
    st.tuples(st.just("drive"), st.tuples(speeds, speeds)),
    st.tuples(st.just("drive"), st.tuples(speeds, speeds)),
    st.tuples(st.sampled_from(["idle", "place", "restart", "measure", "save"]), st.sampled_from(PLACES)),
)
steps = st.tuples(acts, acts, acts, st.sampled_from([6, 6, 6, 1, 20, 100]), st.booleans())


@settings(max_examples=examples(40))
@given(script=st.lists(steps, min_size=2, max_size=12), published=st.booleans())
def test_rows_that_nobody_looks_at(script, published):
    alone = [morse.load(yard, seed=4 + row) for row in range(3)]
    contacts = [sim.robot.contacts() for sim in alone]
    with morse.batch(yard, 3, seed=4) as many:
        drive, hit = many.command("robot.motion", "v", "w"), many.contacts("robot")
        columns = {name: many.read(name, *fields) for name, fields in FIELDS.items()}
        drive[:] = 0.4, 0.9
        commands = [(0.4, 0.9)] * 3
        for *each, ticks, measure in [(*[("idle", None)] * 3, 30, True), *script]:
            for row, ((kind, value), sim) in enumerate(zip(each, alone, strict=True)):
                if kind == "drive":
                    drive[row] = commands[row] = value
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
                elif kind == "save":
                    assert many.save(row)[0].hash() == sim.state_hash()
            if published and ticks == 20:
                assert many[1].time() == alone[1].time()
            many.step(ticks, measure=measure)
            for row, sim in enumerate(alone):
                if commands[row] and ticks:
                    sim.robot.motion.publish(dict(zip("vw", commands[row], strict=True)))
                sim.step(ticks, measure=measure)
                assert (hit[row], hit.impulse[row]) == (contacts[row].touched, contacts[row].impulse)
                for name, array in columns.items():
                    data = sim.robot.parts[name.split(".")[1]].data
                    values = np.hstack([data[field] for field in FIELDS[name]])
                    if len(values) == array.shape[1]:  # a scanner that has not measured yet has no data
                        assert (array[row] == values).all(), name
        for row, sim in enumerate(alone):
            assert many.save(row)[0].hash() == sim.state_hash()
            for part in ("pose", "laser", "gps", "motion"):
                assert repr(many[row].robot.parts[part].data) == repr(sim.robot.parts[part].data)
    for sim in alone:
        sim.close()


@pytest.mark.skipif(library() is None, reason="without the kernel, each row runs on its own")
def test_rows_go_on_together():
    """Without this, the test above compares nothing."""
    with morse.batch(arena, 4) as many:
        drive = many.command("robot.motion", "v", "w")
        many.read("robot.pose", "x", "y")
        drive[:] = 0.3, 0.9
        many.step(30, measure=True)
        simulation = many[2]
        many.step(6, measure=True)
        steps, run = [], type(simulation).step
        try:
            type(simulation).step = lambda self, *a, **k: steps.append(self) or run(self, *a, **k)
            many.step(6, measure=True)
        finally:
            type(simulation).step = run
        assert steps == [simulation], "who was handed out is stepped, the others are not"


@pytest.mark.skipif(library() is None, reason="without the kernel, each row runs on its own")
def test_rows_along_a_wall_go_on_together():
    """A wall that is near, but that the robot does not touch in the next tick, is no reason to run alone."""
    with morse.batch(arena, 2) as many:
        drive, hit = many.command("robot.motion", "v", "w"), many.contacts("robot")
        many.read("robot.pose", "x", "y")
        drive[:] = 1.0, 0.0
        many.place(None, "robot", [-1.5, 1.9 - 0.2 - 0.06, 0.0])
        many.step(30, measure=True)
        steps, run = [], morse.Simulation.step
        try:
            morse.Simulation.step = lambda self, *a, **k: steps.append(self) or run(self, *a, **k)
            for _ in range(10):
                many.step(6, measure=True)
                assert not hit.any()
        finally:
            morse.Simulation.step = run
        assert not steps
