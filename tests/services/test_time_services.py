"""The services of the pseudo component ``time``."""

import math
import time

import pytest

from morse.builder import ATRV, Environment, TimeStrategies
from pymorse import Morse, MorseServiceFailed, MorseServicePreempted

HZ = 60


def scene():
    ATRV("robot")
    Environment("empty", fastmode=True)


def test_time_is_what_the_ticks_say(simu: Morse) -> None:
    assert simu.time() == 0.0
    simu.step(90)
    assert simu.time() == pytest.approx(1.5)


def test_the_mode(simu: Morse, simulate) -> None:
    assert simu.rpc("time", "mode") == "Best Effort"

    other = simulate(fixed_step_scene)
    assert other.rpc("time", "mode") == "Fixed Simulation Step"
    statistics = other.rpc("time", "statistics")
    assert set(statistics) == {"mean_time", "variance_time", "diff_real_time"}


def fixed_step_scene():
    ATRV("robot")
    env = Environment("empty", fastmode=True)
    env.set_time_strategy(TimeStrategies.FixedSimulationStep)


def test_statistics_of_a_running_simulation(simu: Morse) -> None:
    simu.resume()
    simu.sleep(0.5)
    statistics = simu.rpc("time", "statistics")
    assert set(statistics) == {"mean_time", "variance_time", "mean_frame_by_sec", "variance_frame_by_sec"}
    assert statistics["mean_time"] > 0.0
    assert statistics["variance_time"] >= 0.0
    assert statistics["mean_frame_by_sec"] == pytest.approx(1.0 / statistics["mean_time"])


def test_sleeping_ends_in_the_tick_that_is_due(simu: Morse) -> None:
    nap, night = simu.call("time", "sleep", 0.5), simu.call("time", "sleep", 1.0)
    simu.step(29)
    assert not nap.done()
    simu.step(1)
    assert nap.result(60) is None
    simu.step(29)
    assert not night.done()
    simu.step(1)
    assert night.result(60) is None


def test_sleepers_are_woken_by_a_new_beginning(simu: Morse) -> None:
    nap = simu.call("time", "sleep", 0.5)
    simu.rpc("simulation", "reset")
    with pytest.raises(MorseServicePreempted):
        nap.result(60)


def test_a_sleeper_can_be_cancelled(simu: Morse) -> None:
    nap = simu.call("time", "sleep", 0.5)
    nap.cancel()
    with pytest.raises(MorseServicePreempted):
        nap.result(60)


def test_the_time_scale(simu: Morse) -> None:
    simu.resume()
    assert simu.rpc("time", "set_time_scale", 1000.0) is True
    begin = time.monotonic()
    simu.sleep(120.0)
    # at a time scale of 1 it takes 120 s; a loaded machine may be slow, but not that slow
    assert time.monotonic() - begin < 100.0
    assert simu.rpc("time", "set_time_scale", 1) is True


@pytest.mark.parametrize("scale", [0, -1.0, math.nan, math.inf, "fast", None, True, [1]])
def test_a_time_scale_that_is_none_is_refused(simu: Morse, scale: object) -> None:
    with pytest.raises(MorseServiceFailed):
        simu.rpc("time", "set_time_scale", scale)


@pytest.mark.parametrize("seconds", [math.nan, math.inf, "long", None, True, [1]])
def test_a_sleep_that_is_none_is_refused(simu: Morse, seconds: object) -> None:
    with pytest.raises(MorseServiceFailed):
        simu.rpc("time", "sleep", seconds)
