"""The share of the time that requests may take."""

import pytest

from morse.core.clients.budgets import TimeShare

PERIOD = 1 / 60


class Clock:
    """Wall-clock time that passes only when a test says so."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now

    def advance(self, seconds: float) -> None:
        self.now += seconds


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr("morse.core.clients.budgets.perf_counter", made)
    return made


@pytest.mark.parametrize("cost", [0.001, 0.02, 0.3])
def test_endless_requests_take_about_a_quarter_of_the_whole_time(clock: Clock, cost: float) -> None:
    share, spent, begin = TimeShare(), 0.0, clock.now
    while clock.now < begin + 10.0:
        clock.advance(PERIOD)  # the other work of a tick
        if not share.begin():
            continue
        while True:
            clock.advance(cost)
            assert share.spend() == pytest.approx(cost)
            spent += cost
            if share.is_used():
                break
    assert spent / (clock.now - begin) == pytest.approx(0.25, abs=0.06)


def test_a_long_request_makes_the_next_ones_wait(clock: Clock) -> None:
    share = TimeShare()
    clock.advance(PERIOD)
    assert share.begin()
    clock.advance(0.1)
    share.spend()
    assert share.is_used()
    assert share.is_owing
    waited = 0
    while not share.begin():
        clock.advance(PERIOD)
        waited += 1
    assert waited * PERIOD == pytest.approx(0.3, abs=0.03)
    assert not share.is_owing


def test_short_requests_are_served_in_every_tick(clock: Clock) -> None:
    """Also in ticks without a pause between them, as when a client steps the simulation."""
    share = TimeShare()
    for _ in range(100):
        clock.advance(0.001)
        assert share.begin()
        clock.advance(0.0002)
        share.spend()
        assert not share.is_used()
