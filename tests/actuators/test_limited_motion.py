"""Limits of speed, acceleration and jerk, against closed forms of the ramps."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.actuators.limited_motion import Ramp

DT = 1.0 / 60.0
LIMITS = st.one_of(st.just(0.0), st.floats(0.05, 50.0))


def ticks_to(wanted: float, limits: tuple[float, float, float]) -> int:
    ramp, ticks = Ramp(), 0
    while abs(ramp.speed[0] - wanted) > 1e-9:
        ramp.follow([wanted], DT, limits)
        ticks += 1
        assert ticks < 10000
    return ticks


@pytest.mark.parametrize(
    ("limits", "time"),
    [
        ((0.0, 0.5, 0.0), 2.0 / 0.5),
        # the acceleration limit is reached and left: v / a + a / j
        ((0.0, 1.0, 2.0), 2.0 / 1.0 + 1.0 / 2.0),
        # the acceleration limit is never reached: 2 sqrt(v / j)
        ((0.0, 100.0, 2.0), 2.0 * math.sqrt(2.0 / 2.0)),
        ((0.0, 0.0, 0.5), 2.0 * math.sqrt(2.0 / 0.5)),
        ((0.0, 0.0, 0.0), 0.0),
    ],
)
def test_the_time_of_a_ramp(limits: tuple[float, float, float], time: float) -> None:
    assert ticks_to(2.0, limits) * DT == pytest.approx(time, abs=3 * DT)
    assert ticks_to(-2.0, limits) * DT == pytest.approx(time, abs=3 * DT)


@given(
    st.lists(st.tuples(st.floats(-20, 20), st.floats(-20, 20)), min_size=1, max_size=4),
    LIMITS,
    LIMITS,
    LIMITS,
)
def test_no_limit_is_ever_exceeded(wanted: Any, most: float, acceleration: float, jerk: float) -> None:
    ramp = Ramp(2)
    speed, change = [0.0, 0.0], [0.0, 0.0]
    for goal in wanted:
        for _ in range(40):
            now = list(ramp.follow(goal, DT, (most, acceleration, jerk)))
            rate = [(b - a) / DT for a, b in zip(speed, now, strict=True)]
            if most:
                assert math.hypot(*now) <= most * (1 + 1e-9)
            if acceleration and not most:
                assert math.hypot(*rate) <= acceleration * (1 + 1e-6)
            if jerk and not most:
                assert math.dist(rate, change) / DT <= jerk * (1 + 1e-6) + 1e-6
            speed, change = now, rate


@given(st.floats(-20, 20), st.floats(0.5, 50.0), st.floats(1.0, 50.0))
def test_a_speed_is_reached_and_not_overshot(wanted: float, acceleration: float, jerk: float) -> None:
    ramp = Ramp()
    seen = [ramp.follow([wanted], DT, (0.0, acceleration, jerk))[0] for _ in range(4000)]
    assert seen[-1] == pytest.approx(wanted, abs=1e-9)
    # the change of velocity by one step of the jerk in a tick
    assert max(map(abs, seen)) <= abs(wanted) + jerk * DT * DT


ROBOT = """
robot = ATRV()
motion = {0}
motion.properties({1})
robot.append(motion)
pose = Pose()
robot.append(pose)
"""


@pytest.mark.parametrize(("kind", "field"), [("MotionVW", "v"), ("MotionXYW", "x")])
def test_the_way_of_a_robot_that_accelerates(simulate: Any, kind: str, field: str) -> None:
    sim = simulate(ROBOT.format(kind + "()", "MaxAcceleration=0.5, ControlType='Position'"), sockets=False)
    sim.step(10)
    begun = sim.robot.pose.get()["x"]
    sim.robot.motion.publish({field: 1.0})
    sim.step(180)
    # 2 s of acceleration to 1 m/s, and 1 s at that speed
    assert sim.robot.pose.data["x"] - begun == pytest.approx(0.5 * 0.5 * 2.0**2 + 1.0, abs=0.03)


def test_a_limit_that_is_set_at_run_time_does_not_stop_the_robot(simulate: Any) -> None:
    sim = simulate(ROBOT.format("MotionVW()", "ControlType='Position'"), sockets=False)
    sim.robot.motion.publish({"v": 1.0, "w": 0.0})
    sim.step(60)
    sim.robot.motion.set_property("MaxAcceleration", 1.0).result()
    begun = sim.robot.pose.get()["x"]
    sim.robot.motion.publish({"v": 0.0})
    sim.step(120)
    # a braking distance of v² / 2a
    assert sim.robot.pose.data["x"] - begun == pytest.approx(0.5, abs=0.04)


def test_turning_has_limits_of_its_own_and_a_saved_ramp_goes_on(simulate: Any) -> None:
    sim = simulate(
        ROBOT.format("MotionVW()", "MaxAngularAcceleration=0.5, MaxAngularSpeed=0.5, ControlType='Position'"),
        sockets=False,
    )
    sim.step(10)
    sim.robot.motion.publish({"w": 3.0})
    sim.step(30)
    kept = sim.save()
    sim.step(60)
    # 1 s of acceleration to 0.5 rad/s, and 0.5 s at that rate
    yaw = sim.robot.pose.data["yaw"]
    assert yaw == pytest.approx(0.25 + 0.25, abs=0.02)
    sim.restore(kept)
    sim.step(60)
    assert sim.robot.pose.data["yaw"] == yaw


def test_wheels_have_limits_too(simulate: Any) -> None:
    sim = simulate(
        "robot = Pioneer3DX()\nmotion = MotionVWDiff()\nmotion.properties(MaxSpeed=0.3, MaxAcceleration=0.3)\n"
        "robot.append(motion)\npose = Pose()\nrobot.append(pose)\n",
        sockets=False,
    )
    sim.step(60)
    begun = sim.robot.pose.get()
    sim.robot.motion.publish({"v": 5.0})
    sim.step(180)
    now = sim.robot.pose.data
    assert math.dist((begun["x"], begun["y"]), (now["x"], now["y"])) == pytest.approx(0.15 + 0.6, abs=0.05)


@pytest.mark.parametrize("value", [-1.0, float("nan"), "fast", None])
def test_limits_that_cannot_be_are_refused(simulate: Any, value: Any) -> None:
    sim = simulate(ROBOT.format("MotionVW()", ""), sockets=False)
    with pytest.raises(Exception, match="MaxSpeed"):
        sim.robot.motion.set_property("MaxSpeed", value).result()
