"""Rates of components."""

import itertools
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.simulation.schedule import Schedule


def acting(frequency, base, ticks):
    component = SimpleNamespace(frequency=frequency)
    schedule = Schedule([component], base)
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
