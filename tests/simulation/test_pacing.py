"""Keeping up with the wall clock."""

import itertools
import math
import threading
import time
from types import SimpleNamespace

import pytest

from morse.simulation.ticks import pacing
from morse.simulation.ticks.pacing import Pacer


@pytest.fixture
def clock(monkeypatch):
    """A wall clock that the test controls; waiting advances it, too."""

    class Clock:
        now = 100.0

    def sleep(seconds):
        Clock.now += seconds

    monkeypatch.setattr(pacing, "time", SimpleNamespace(perf_counter=lambda: Clock.now, sleep=sleep))
    return Clock


@pytest.mark.parametrize("speed", [0.5, 1.0, 4.0])
def test_ticks_are_spread_over_the_wall_clock(clock, speed):
    pacer = Pacer(1 / 60, speed)
    for _ in range(120):
        clock.now += 0.001
        pacer.wait()
    assert clock.now - 100.0 == pytest.approx(2.0 / speed)
    assert pacer.lost == 0.0


def test_a_short_delay_is_caught_up(clock):
    pacer = Pacer(1 / 60, 1.0)
    clock.now += 0.2
    for _ in range(60):
        pacer.wait()
    assert clock.now - 100.0 == pytest.approx(1.0)
    assert pacer.lost == 0.0


def test_a_long_delay_is_given_up_and_counted(clock):
    pacer = Pacer(1 / 60, 1.0)
    clock.now += 3.0
    pacer.wait()
    before = clock.now
    for _ in range(60):
        pacer.wait()
    assert clock.now - before == pytest.approx(1.0)
    assert pacer.lost == pytest.approx(3.0 - 1 / 60)
    assert pacer.report_due() == pytest.approx(3.0 - 1 / 60)
    assert pacer.report_due() == 0.0


def test_a_hiccup_is_not_worth_a_word(clock):
    pacer = Pacer(1 / 60, 1.0)
    clock.now += 0.3
    pacer.wait()
    assert pacer.report_due() == 0.0


def test_as_fast_as_possible_never_waits(clock):
    pacer = Pacer(1 / 60, math.inf)
    for _ in range(1000):
        pacer.wait()
    assert clock.now == 100.0


def test_the_real_time_factor_is_what_was_reached(clock):
    pacer = Pacer(1 / 60, math.inf)
    for _ in range(600):
        clock.now += 1 / 120
        pacer.wait()
    assert pacer.real_time_factor == pytest.approx(2.0, rel=0.05)


def test_stopping_ends_a_wait_at_once():
    pacer = Pacer(100.0, 1.0)
    threading.Timer(0.05, pacer.stop).start()
    begin = time.monotonic()
    pacer.wait()
    assert time.monotonic() - begin < 60.0


def test_whoever_waits_for_long_is_asked_again_and_again(clock):
    asked = []
    pacer = Pacer(1 / 60, 0.01)
    pacer.while_waiting = lambda: asked.append(clock.now) or True
    pacer.wait()
    assert clock.now - 100.0 == pytest.approx(1 / 0.6)
    assert len(asked) > 20
    assert max(b - a for a, b in itertools.pairwise(asked)) < 0.1


def test_a_wait_ends_when_time_is_stopped_or_goes_faster(clock):
    pacer = Pacer(1 / 60, 0.001)
    pacer.while_waiting = lambda: False
    pacer.wait()
    assert clock.now - 100.0 < 0.1
    pacer.while_waiting = lambda: pacer.set_speed(1.0) or True
    pacer.wait()
    assert clock.now - 100.0 < 0.3


@pytest.mark.parametrize("speed", [1e-300, 1e-9, 0.0])
def test_time_passes_at_any_speed(clock, speed):
    pacer = Pacer(1 / 60, speed)
    pacer.wait()
    assert clock.now - 100.0 < 20.0
    pacer.set_speed(speed)
    pacer.wait()
    assert clock.now - 100.0 < 40.0
