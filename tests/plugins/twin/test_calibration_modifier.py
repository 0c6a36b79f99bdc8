"""The modifier of gains, offsets, lags and delays."""

import math

import pytest

import morse
from morse.recording.recording import Recording
from morse.simulation.loader import LoadError
from morse.verification.resimulation import repeat


def scene(sensor=None, actuator=None, wheeled=False):
    def build():
        from morse.builder import ATRV, Environment, MotionVW, MotionVWDiff, Pioneer3DX, Pose

        robot = Pioneer3DX("robot") if wheeled else ATRV("robot")
        motion, pose = MotionVWDiff("motion") if wheeled else MotionVW("motion"), Pose("pose")
        robot.append(motion)
        robot.append(pose)
        if actuator:
            motion.alter("Calibration", **actuator)
        if sensor:
            pose.alter("Calibration", **sensor)
        Environment("empty")

    return build


def commanded(sim, ticks):
    """The speed that is obeyed in each of some ticks."""
    speeds = []
    for _ in range(ticks):
        sim.step()
        speeds.append(sim.context.components["robot.motion"].local_data["v"])
    return speeds


def test_a_lag_is_a_first_order_filter():
    with morse.load(scene(actuator={"lag": 0.1}), on_failure="raise") as sim:
        sim.step(5)
        sim.robot.motion.publish({"v": 1.0})
        speeds = commanded(sim, 30)
    # the answer to a step, 1 - exp(-t / lag), at the end of each tick
    assert speeds == pytest.approx([1.0 - math.exp(-(k + 1) / 60.0 / 0.1) for k in range(30)], abs=1e-9)


def test_a_delay_need_not_be_a_number_of_ticks():
    with morse.load(scene(actuator={"delay": 2.25 / 60.0}), on_failure="raise") as sim:
        sim.step(5)
        sim.robot.motion.publish({"v": 1.0})
        assert commanded(sim, 5) == pytest.approx([0.0, 0.0, 0.75, 1.0, 1.0], abs=1e-6)
        # a command that is back at the present output is a command, too
        sim.robot.motion.publish({"v": 0.0})
        sim.step()
        sim.robot.motion.publish({"v": 1.0})
        assert commanded(sim, 4) == pytest.approx([1.0, 0.25, 0.75, 1.0], abs=1e-6)


def test_gains_and_biases_of_vectors_and_numbers():
    with morse.load(scene(sensor={"gain": {"x": 2.0}, "bias": {"x": 0.5, "yaw": 0.1}}), on_failure="raise") as sim:
        sim.robot.place([1.0, 0.0, 0.2])
        sim.step()
        data = sim.robot.pose.data
    assert data["x"] == pytest.approx(2.5, abs=1e-6)
    assert data["yaw"] == pytest.approx(0.3, abs=1e-6)


def test_wheels_of_another_size():
    """v = R/R0 v0 and w = R/R0 T0/T w0: what the wheels of the real robot do with the speeds of those of the model."""
    with morse.load(scene(wheeled=True), on_failure="raise") as sim:
        radius, track = sim.context.robots["robot"].wheel_radius, sim.context.robots["robot"].track
    changed = {"wheel_radius": 1.1 * radius, "track": 0.8 * track, "gain": {"v": 2.0}}
    with morse.load(scene(wheeled=True, actuator=changed), on_failure="raise") as sim:
        sim.robot.motion.publish({"v": 0.3, "w": 0.2})
        sim.step()
        data = sim.context.components["robot.motion"].local_data
    assert (data["v"], data["w"]) == pytest.approx((0.3 * 1.1 * 2.0, 0.2 * 1.1 / 0.8))


def test_the_state_contains_what_is_under_way(tmp_path):
    with morse.load(scene(actuator={"delay": 0.1, "lag": 0.2}), on_failure="raise") as sim:
        sim.robot.motion.publish({"v": 1.0})
        sim.step(4)
        state = sim.save()
        first = commanded(sim, 20)
        digest = sim.state_hash()
        sim.restore(state)
        assert commanded(sim, 20) == first
        assert sim.state_hash() == digest


def test_a_recording_repeats_it(tmp_path):
    path = tmp_path / "run.mcap"
    own = scene(actuator={"delay": 0.05, "lag": 0.1, "gain": {"v": 0.5}})
    with morse.load(own) as sim, sim.record(path):
        for speed in (1.0, 1.0, -0.5, 0.0, 0.7):
            sim.robot.motion.publish({"v": speed})
            sim.step(7)
    with Recording(path) as recording, morse.load(own) as again:
        outcome = repeat(recording, again)
    assert outcome.departure is None
    assert outcome.ticks == 35


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"sensor": {"bias": {"xx": 1.0}}}, "no field 'xx'.*did you mean 'x'"),
        ({"sensor": {"bias": {"x": [1.0, 2.0]}}}, "expected a number"),
        ({"sensor": {"bias": {"x": "much"}}}, "expected a number"),
        ({"sensor": {"lag": 0.1}}, "no actuator.*delay"),
        ({"actuator": {"wheel_radius": 0.1}}, "does not drive a robot with two rows of wheels"),
    ],
)
def test_mistakes_are_refused(options, text):
    with pytest.raises(LoadError, match=text):
        morse.load(scene(**options))


@pytest.mark.parametrize("options", [{"delay": -1.0}, {"lag": math.inf}, {"lagg": 1.0}, {"bias": {"v": math.nan}}])
def test_options_out_of_range_are_refused_in_the_script(options):
    with pytest.raises(Exception, match=r"delay|lag|bias"):
        morse.load(scene(actuator=options))
