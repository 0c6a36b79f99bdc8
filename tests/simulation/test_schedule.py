"""Rates of components."""

import itertools
import math
import time
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

import morse
from morse.builder import ATRV, Environment, MotionVW
from morse.simulation.ticks.ticking import Schedule
from tests.kit.programs import python


def phase_of(component):
    return component.phase


def acting(frequency, base, ticks, phase=0.0):
    component = SimpleNamespace(frequency=frequency)
    schedule = Schedule([component], base, lambda _: phase)
    return [tick for tick in range(ticks) if schedule.due(tick)]


@pytest.mark.parametrize(("frequency", "expected"), [(60, 60), (10, 10), (7, 7), (1, 1), (59, 59), (0.5, 1), (120, 60)])
def test_a_component_acts_as_often_as_its_rate_says(frequency, expected):
    assert len(acting(frequency, 60, 60)) == expected


def test_the_first_tick_counts():
    assert acting(10, 60, 13) == [0, 6, 12]


@given(st.integers(1, 240), st.integers(1, 240))
def test_gaps_differ_by_one_tick_at_most(frequency, base):
    ticks = acting(frequency, base, 10 * base)
    gaps = {b - a for a, b in itertools.pairwise(ticks)}
    assert len(gaps) <= 2
    assert max(gaps) - min(gaps) <= 1
    assert len(ticks) == 10 * min(frequency, base)


def test_the_order_is_that_of_the_scene():
    fast, slow = SimpleNamespace(frequency=60), SimpleNamespace(frequency=10)
    assert Schedule([slow, fast], 60).due(0) == [slow, fast]
    assert Schedule([slow, fast], 60).due(1) == [fast]


@pytest.mark.parametrize(
    ("phase", "expected"), [(0.05, [3, 9, 15]), (0.1, [6, 12, 18]), (0.04, [3, 9, 15]), (0.25, [15, 21, 27])]
)
def test_a_component_acts_first_when_its_phase_has_passed(phase, expected):
    assert acting(10, 60, 30, phase)[:3] == expected


def test_components_of_other_phases_share_the_work():
    components = [SimpleNamespace(frequency=10, phase=i / 60) for i in range(6)]
    schedule = Schedule(components, 60, phase_of)
    assert [schedule.due(tick) for tick in range(60, 66)] == [[component] for component in components]


@given(st.integers(1, 240), st.integers(1, 240), st.floats(0.0, 2.0))
def test_a_phase_changes_nothing_but_the_beginning(frequency, base, phase):
    late = acting(frequency, base, 6 * base, phase)
    assert min(late) >= phase * base - 1e-6 * base
    assert min(late) < phase * base + 1 + 1e-6 * base
    gaps = {b - a for a, b in itertools.pairwise(late)}
    assert max(gaps) - min(gaps) <= 1
    share = min(frequency, base) * (6 - phase)
    assert abs(len(late) - share) <= 2


@given(st.lists(st.tuples(st.integers(1, 60), st.floats(0.0, 0.5)), min_size=1, max_size=5), st.integers(0, 1000))
def test_what_is_due_does_not_depend_on_what_was_asked_before(rates, tick):
    components = [SimpleNamespace(frequency=rate, phase=phase) for rate, phase in rates]
    asked = Schedule(components, 60, phase_of)
    for before in range(0, tick, 7):
        asked.due(before)
    assert asked.due(tick) == Schedule(components, 60, phase_of).due(tick)


# -- commands of the process to actuators whose speeds last ----------------------------------------


def scene() -> None:
    for number in range(5):
        robot = ATRV(f"r{number}")
        robot.translate(y=3.0 * number)
        robot.append(MotionVW("motion"))
    Environment("empty", fastmode=True)


def test_a_command_arrives_after_the_rows_were_formed_again() -> None:
    with morse.load(scene) as simulation:
        robots = [getattr(simulation, f"r{number}") for number in range(5)]
        for robot in robots:  # the first command of each forms the rows again
            robot.motion.publish({"v": 1.0})
            simulation.step(2)
        for number, robot in enumerate(robots):
            robot.motion.publish({"v": 2.0 + number})
        simulation.step(2)
        assert [robot.motion.data["v"] for robot in robots] == [2.0, 3.0, 4.0, 5.0, 6.0]


# -- robots with wheels do not disturb each other by wrong commands --------------------------------

COUNT = 4


def wrong_wheel_commands_scene():
    from morse.builder import Environment, MotionVWDiff, Pioneer3DX, Pose, SegwayRMP400

    for number in range(COUNT):
        robot = Pioneer3DX(f"r{number}") if number % 2 else SegwayRMP400(f"r{number}")
        robot.translate(3.0 * number, 0.0, 0.2)
        robot.append(MotionVWDiff("motion"))
        robot.append(Pose("pose"))
    Environment("empty", fastmode=True)


@pytest.mark.parametrize("wrong", [math.nan, math.inf, "fast", None])
def test_one_wrong_command_stops_nobody_else(wrong):
    with morse.load(wrong_wheel_commands_scene) as simulation:
        components = simulation.context.components
        for number in range(COUNT):
            components[f"r{number}.motion"].local_data["v"] = 0.5
        simulation.step(10)
        before = [components[f"r{number}.pose"].local_data["x"] for number in range(COUNT)]
        components["r2.motion"].local_data["v"] = wrong
        # with wheels at full speed, robot 2 meets robot 3 after 0.9 s
        simulation.step(40)
        for number in (0, 1, 3):
            assert components[f"r{number}.pose"].local_data["x"] - before[number] == pytest.approx(0.33, abs=0.1)


# -- threads of executors that have nothing to do do not hold up the end of a process, and are not reported

PROGRAM = """
import logging, sys
from concurrent.futures import ThreadPoolExecutor
logging.basicConfig(stream=sys.stdout, format="%(message)s")
from morse.simulation.ending import threads_left
pool = ThreadPoolExecutor(2, thread_name_prefix="idle")
pool.submit(print, "worked").result()
threads_left(7, sys.exit, limit=60.0)
print("ended")
"""


def test_idle_workers_end() -> None:
    begin = time.monotonic()
    ran = python("-c", PROGRAM)
    assert (ran.returncode, ran.stdout.split()) == (0, ["worked", "ended"]), ran.stdout + ran.stderr
    # the limit, for which a thread that does not end is waited for
    assert time.monotonic() - begin < 60.0
