"""Simulated time."""

import pytest

from morse.core import status
from morse.core.clients.budgets import TimeShare
from morse.core.clock import Clock
from morse.core.exceptions import MorseRPCTypeError
from morse.core.validation import Arguments
from morse.scene import TimeStrategies
from morse.scene.scene import Settings
from morse.services.time_services import TimeServices


@pytest.fixture
def clock():
    return Clock(60.0, TimeStrategies.BestEffort)


def test_time_is_the_number_of_ticks_over_the_rate(clock):
    for _ in range(6000):
        clock.advance()
    assert clock.time == 100.0


def test_absolute_time_starts_now():
    import time

    start = Settings(relative_time=False).origin
    assert Clock(60, TimeStrategies.BestEffort, start=start).time == pytest.approx(time.time(), abs=5)


def test_several_clients_sleep_at_once(clock):
    woken = []
    services = TimeServices(clock, lambda speed: None)
    services.sleep(lambda outcome: woken.append(("long", clock.tick, outcome)), 1.0)
    services.sleep(lambda outcome: woken.append(("short", clock.tick, outcome)), 0.5)
    services.sleep(lambda outcome: woken.append(("none", clock.tick, outcome)), 0)
    for _ in range(100):
        services.action()
        clock.advance()
    done = (status.SUCCESS, None)
    assert woken == [("none", 0, done), ("short", 30, done), ("long", 60, done)]


@pytest.mark.parametrize("bad", ["x", None, float("nan"), float("inf"), 1e308, True, []])
def test_sleep_takes_numbers_only(clock, bad):
    with pytest.raises(MorseRPCTypeError, match=r"'seconds' is a( finite)? number up to 1e\+09 s"):
        Arguments(TimeServices(clock, lambda speed: None).sleep, "sleep").check([bad])


@pytest.mark.parametrize("bad", ["x", 0, -1, 1e-9, float("nan"), float("inf"), True])
def test_the_time_scale_is_positive(clock, bad):
    with pytest.raises(MorseRPCTypeError, match=r"'time_scale' is a( finite)? number from 0\.001 to"):
        Arguments(TimeServices(clock, lambda speed: None).set_time_scale, "set_time_scale").check([bad])


def test_the_time_scale_reaches_the_pacing(clock):
    speeds = []
    assert TimeServices(clock, speeds.append).set_time_scale(2) is True
    assert speeds == [2.0]


def test_modes_have_their_old_names(clock):
    assert TimeServices(clock, print).mode() == "Best Effort"
    assert TimeServices(Clock(60, TimeStrategies.FixedSimulationStep), print).mode() == "Fixed Simulation Step"


def test_statistics_have_the_fields_of_their_mode(clock):
    assert set(TimeServices(clock, print).statistics()) == {
        "mean_time",
        "variance_time",
        "mean_frame_by_sec",
        "variance_frame_by_sec",
    }
    fixed = Clock(60, TimeStrategies.FixedSimulationStep)
    assert set(TimeServices(fixed, print).statistics()) == {"mean_time", "variance_time", "diff_real_time"}


# -- the share of the time that requests may take --------------------------------------------------

PERIOD = 1 / 60


class TimeShareClock:
    """Wall-clock time that passes only when a test says so."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now

    def advance(self, seconds: float) -> None:
        self.now += seconds


@pytest.fixture
def time_share_clock(monkeypatch: pytest.MonkeyPatch) -> TimeShareClock:
    made = TimeShareClock()
    monkeypatch.setattr("morse.core.clients.budgets.perf_counter", made)
    return made


@pytest.mark.parametrize("cost", [0.001, 0.02, 0.3])
def test_endless_requests_take_about_a_quarter_of_the_whole_time(time_share_clock: TimeShareClock, cost: float) -> None:
    share, spent, begin = TimeShare(), 0.0, time_share_clock.now
    while time_share_clock.now < begin + 10.0:
        time_share_clock.advance(PERIOD)  # the other work of a tick
        if not share.begin():
            continue
        while True:
            time_share_clock.advance(cost)
            assert share.spend() == pytest.approx(cost)
            spent += cost
            if share.is_used():
                break
    assert spent / (time_share_clock.now - begin) == pytest.approx(0.25, abs=0.06)


def test_a_long_request_makes_the_next_ones_wait(time_share_clock: TimeShareClock) -> None:
    share = TimeShare()
    time_share_clock.advance(PERIOD)
    assert share.begin()
    time_share_clock.advance(0.1)
    share.spend()
    assert share.is_used()
    assert share.is_owing
    waited = 0
    while not share.begin():
        time_share_clock.advance(PERIOD)
        waited += 1
    assert waited * PERIOD == pytest.approx(0.3, abs=0.03)
    assert not share.is_owing


def test_short_requests_are_served_in_every_tick(time_share_clock: TimeShareClock) -> None:
    """Also in ticks without a pause between them, as when a client steps the simulation."""
    share = TimeShare()
    for _ in range(100):
        time_share_clock.advance(0.001)
        assert share.begin()
        time_share_clock.advance(0.0002)
        share.spend()
        assert not share.is_used()
