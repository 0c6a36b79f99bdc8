"""Delays of sensors and of commands are found where errors have minima beside the solution."""

import json

import numpy as np
import pytest

import morse
from morse.many import Twin
from morse.plugins.twin.comparison import Channel, Clock, Comparison, align, shifts
from morse.plugins.twin.replay import Samples

ROVER = """
from morse.builder import *

robot = Pioneer3DX("robot")
motion, pose, imu = MotionVWDiff("motion"), Pose("pose"), IMU("imu")
pose.frequency(20)
for part in (motion, pose, imu):
    robot.append(part)
env = Environment("empty")
"""
ARM_FILE = """<robot name='arm'><link name='world'/>
<link name='upper'><inertial><origin xyz='0 0 0.25'/><mass value='3'/>
<inertia ixx='0.06' iyy='0.06' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial></link>
<joint name='shoulder' type='revolute'><parent link='world'/><child link='upper'/><origin xyz='0 0 1.5'/>
<axis xyz='0 1 0'/><limit lower='-2.5' upper='2.5' effort='500' velocity='20'/>
<dynamics damping='2.0' friction='0.8'/></joint></robot>
"""
ARM = """
from morse.builder import *

robot = Robot("arm.urdf")
arm = Armature("arm", armature_name="arm_joints")
arm.gains(150.0, 8.0, ["shoulder"])
state = ArmaturePose("state")
arm.append(state)
robot.append(arm)
env = Environment("empty")
"""


def fitted(folder, script, noise, planted, command, seconds):
    """Record a run of a scene with planted values and noise, and fit the scene without them."""
    (folder / "scene.py").write_text(script)
    (folder / "planted.json").write_text(json.dumps({"morse preset": 1, "values": planted}))
    (folder / "real.py").write_text(f'{script}{noise}env.preset("planted.json")\n')
    rng = np.random.default_rng(5)
    with morse.load(folder / "real.py", seed=5) as sim, sim.record(folder / "log.mcap"):
        for _ in range(seconds):
            name, order = command(rng)
            for _ in range(10):
                sim.robot[name].publish(order)
                sim.step(6)
    return Twin(folder / "log.mcap", folder / "scene.py", fit=list(planted)).fit(workers=0, manoeuvre=False)


def is_found(fit, planted, name):
    return abs(fit.values[name] - planted[name]) < max(0.02 * abs(planted[name]), 3.0 * fit.spreads[name])


def test_a_delay_of_a_sensor_is_none_of_its_clock_if_it_is_fitted(tmp_path):
    """It is longer than what is taken for the offset of a clock otherwise."""
    planted = {"robot.motion.lag": 0.12, "robot.pose.delay": 0.4, "robot.track": 0.37}
    noise = "".join(f'pose.noise(gaussian=0.01, field="{field}")\n' for field in ("x", "y", "yaw"))
    fit = fitted(
        tmp_path,
        ROVER,
        noise,
        planted,
        lambda rng: ("motion", {"v": 0.9 * rng.uniform(-1.0, 1.0), "w": 1.5 * rng.uniform(-1.0, 1.0)}),
        12,
    )
    assert not any(clock.is_applied for clock in fit.comparison.clocks.values())
    for name in planted:
        assert is_found(fit, planted, name), str(fit)
        assert fit.spreads[name] < 0.15 * planted[name]


@pytest.mark.slow
def test_a_delay_of_commands_is_found_where_errors_change_by_jumps(tmp_path):
    """A joint of constant speed turns back in a tick, whenever in this tick the command comes."""
    (tmp_path / "arm.urdf").write_text(ARM_FILE)
    planted = {
        "robot.arm.lag": 0.0718,
        "robot.arm.delay": 0.0519,
        "robot.shoulder.gain": 126.0,
        "robot.arm.state.bias.shoulder": -0.017,
    }
    fit = fitted(
        tmp_path,
        ARM,
        "state.noise(gaussian=0.002)\n",
        planted,
        lambda rng: ("arm", {"shoulder": 1.2 * rng.uniform(-1.0, 1.0)}),
        12,
    )
    assert fit.errors["robot.arm.state.shoulder"] == pytest.approx(0.002, rel=0.2)
    for name in ("robot.arm.delay", "robot.arm.lag"):
        assert is_found(fit, planted, name), str(fit)
        assert fit.spreads[name] < 0.15 * planted[name]


# -- clocks ----------------------------------------------------------------------------------


def late(shift):
    """A sensor whose times are later than in its simulation by a function of time."""
    rng = np.random.default_rng(2)
    made = np.arange(3600) / 60.0
    signal = np.convolve(rng.normal(size=3600), np.ones(30) / 30.0, "same")
    times = np.arange(1200) / 20.0
    seen = np.interp(times - shift(times), made, signal)
    channel = Channel("robot.pose", "x", -1, False, "m")
    comparison = Comparison({"robot.pose": Samples(times, {"x": seen})}, [channel], {"robot.pose": Clock()})
    return comparison, {"robot.pose": Samples(made, {"x": signal})}


def test_a_constant_offset_is_that_of_the_clock_unless_a_delay_is_fitted():
    comparison, traces = late(lambda times: 0.4)
    align(comparison, traces)
    (clock,) = comparison.clocks.values()
    assert clock.is_applied
    assert clock.delay == pytest.approx(0.4, abs=0.01)
    assert shifts(comparison, traces) == {}
    comparison, traces = late(lambda times: 0.4)
    align(comparison, traces, fitted=["robot.pose"])
    (clock,) = comparison.clocks.values()
    assert not clock.is_applied
    assert shifts(comparison, traces) == {"robot.pose": pytest.approx(0.4, abs=0.01)}


def test_a_clock_that_is_seconds_off_is_corrected_even_if_a_delay_is_fitted():
    comparison, traces = late(lambda times: 2.5)
    align(comparison, traces, fitted=["robot.pose"])
    (clock,) = comparison.clocks.values()
    assert clock.is_applied
    assert clock.delay == pytest.approx(2.5, abs=0.01)


def test_what_grows_evenly_is_the_drift_of_a_clock():
    comparison, traces = late(lambda times: 0.005 * times)
    align(comparison, traces)
    (clock,) = comparison.clocks.values()
    assert clock.drift == pytest.approx(0.005, rel=0.1)
    # 60 ms between the thirds is hardly a sample; and what comes and goes is the motion of the robot
    for shift in (lambda times: 0.0015 * times, lambda times: np.where(times < 20.0, 0.0, 0.2)):
        comparison, traces = late(shift)
        align(comparison, traces)
        (clock,) = comparison.clocks.values()
        assert clock.drift == 0.0


@pytest.mark.parametrize("frequencies", [(0.1, 1.0), (1.0, 0.1)])
@pytest.mark.parametrize("lag", [0.1, 0.3])
@pytest.mark.parametrize("offset", [0.0, 0.3])
def test_a_lag_in_a_motion_that_changes_its_speed_is_no_drift(frequencies, lag, offset):
    """The phase of a first-order lag is late by atan(w lag) / w, which falls with the frequency."""
    made, times = np.arange(3600) / 60.0, np.arange(1200) / 20.0
    low, high = frequencies
    angular = 2.0 * np.pi * (low + (high - low) * made / 60.0)
    phase = 2.0 * np.pi * (low * made + (high - low) * made**2 / 120.0)
    true = np.sin(phase - np.arctan(angular * lag)) / np.hypot(1.0, angular * lag)
    seen = np.interp(times - offset, made, true) + np.random.default_rng(4).normal(0.0, 0.02, len(times))
    channel = Channel("robot.pose", "x", -1, False, "m")
    comparison = Comparison({"robot.pose": Samples(times, {"x": seen})}, [channel], {"robot.pose": Clock()})
    align(comparison, {"robot.pose": Samples(made, {"x": np.sin(phase)})})
    assert comparison.clocks["robot.pose"].drift == 0.0
