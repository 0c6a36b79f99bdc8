"""States that the page can restore."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from morse.viewer import page_inputs
from morse.viewer.page_inputs import Rewinder, size_of

PERIOD = 1 / 60


class Counter:
    """A simulation whose state is the number of its tick, and a value that tests write."""

    def __init__(self) -> None:
        self.tick = 0
        self.note = ""
        self.paused = False
        self.size = 0
        self.told: list[list[float]] = []
        self.wall, self.factor, self.cost = 0.0, 1.0, 0.0
        server: Any = SimpleNamespace(send=lambda message: self.told.append(message.times))
        self.history = Rewinder(self, lambda: self.tick * PERIOD, server, lambda: self.wall)

    def save(self) -> Any:
        self.wall += self.cost
        return {"tick": self.tick, "note": self.note, "ballast": np.zeros(self.size, np.uint8)}

    def restore(self, state: Any) -> None:
        self.tick, self.note = state["tick"], state["note"]

    def pause(self) -> None:
        self.paused = True

    def run(self, ticks: int) -> None:
        for _ in range(ticks):
            self.tick += 1
            self.wall += PERIOD / self.factor
            self.history.keep(paused=self.paused)


@pytest.fixture
def counter() -> Counter:
    return Counter()


def test_every_half_second_of_the_last_minute_is_kept(counter: Counter) -> None:
    counter.run(90 * 60)
    times = counter.told[-1]
    assert np.diff(times) == pytest.approx(0.5)
    assert 60.0 - 0.5 <= times[-1] - times[0] <= 60.0
    assert times[-1] == pytest.approx(90.0, abs=0.5)


def test_a_fast_simulation_is_saved_less_often(counter: Counter) -> None:
    counter.factor, counter.cost = 200.0, 0.005
    counter.run(40_000)
    saved = len(counter.told)
    assert saved * counter.cost < 0.013 * counter.wall
    assert np.diff(counter.told[-1])[1:] == pytest.approx(100.0, abs=2.0)
    assert len(counter.told[-1]) == saved  # all of the last minute on the wall clock
    counter.paused = True
    counter.run(3)
    assert np.diff(counter.told[-1])[-2:] == pytest.approx(PERIOD)


def test_a_state_is_gone_back_to_and_forward_again(counter: Counter) -> None:
    counter.run(300)
    counter.history.rewind(2.2)
    assert counter.paused
    assert counter.tick * PERIOD == pytest.approx(2.0, abs=0.5)
    before = counter.tick
    counter.history.rewind(4.0)
    assert counter.tick > before
    counter.history.rewind(0.0)
    assert counter.tick == 1
    assert len(counter.told) == 10  # going back and forth deletes nothing


def test_step_back_goes_a_tick_where_ticks_were_taken_one_by_one(counter: Counter) -> None:
    counter.run(60)
    counter.paused = True
    counter.run(5)
    for tick in (64, 63, 62, 61):
        counter.history.step_back()
        assert counter.tick == tick
    counter.history.step_back()
    assert counter.tick == 31  # half a second before
    for _ in range(3):
        counter.history.step_back()
    assert counter.tick == 1


def test_what_came_after_is_forgotten_when_time_goes_on_from_there(counter: Counter) -> None:
    counter.run(300)
    counter.history.rewind(2.0)
    counter.note = "another way"
    counter.run(1)
    assert counter.told[-1][-1] == pytest.approx(counter.tick * PERIOD)
    counter.paused = False
    counter.run(120)
    counter.history.rewind(1.0)
    assert counter.note == ""
    counter.history.rewind(100.0)
    assert counter.note == "another way"


def test_large_states_are_kept_fewer(counter: Counter, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page_inputs, "_MOST_BYTES", 1_000_000)
    counter.size = 95_000
    counter.run(60 * 60)
    assert len(counter.told[-1]) == 10
    counter.size = 5_000_000
    counter.run(60)
    assert len(counter.told[-1]) == 1  # the newest at least


def test_a_reset_has_no_past(counter: Counter) -> None:
    counter.run(300)
    counter.tick = 0
    counter.history.restarted()
    assert counter.told[-1] == []
    counter.history.step_back()
    counter.history.rewind(3.0)
    assert counter.tick == 0
    counter.run(31)
    assert counter.told[-1] == pytest.approx([1 * PERIOD, 31 * PERIOD])


def test_the_size_of_plain_data() -> None:
    assert size_of(np.zeros(1000)) == pytest.approx(8000, rel=0.1)
    assert size_of({"a": [np.zeros(1000), b"x" * 1000], "b": {"c": "y" * 500}}) == pytest.approx(9500, rel=0.1)
    assert size_of(None) < 100
