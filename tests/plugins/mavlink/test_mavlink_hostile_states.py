"""A state that a stranger has written is refused, or the autopilot goes on with it."""

import contextlib
import copy
import logging
import math
from collections.abc import Callable, Iterator
from typing import Any

import pytest

pytest.importorskip("pymavlink")

from hypothesis import given, settings
from hypothesis import strategies as st
from test_mavlink_flight import station
from test_mavlink_states import VEHICLES, _altered, under_way

from morse.core.state import StateError
from tests.kit.effort import examples

__all__ = ["station"]

pytestmark = pytest.mark.long

VALUES = st.sampled_from(
    [math.nan, math.inf, 1e308, -1e308, 1e-310, -1, 0, 1, 255, 256, 65_536, 2**31, 2**63, -(2**63), True, None, "x",
     "x" * 10_000, [], [1.0], [math.nan] * 3, [1e300, 1e300, 1e300], {}, {"v": math.nan}, {"velocity": [1.0]}]
)  # fmt: skip


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The path of each value within a state."""
    pairs = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for name, inner in pairs:
        yield (*path, name)
        yield from places(inner, (*path, name))


@pytest.mark.parametrize("kind", VEHICLES)
def test_any_value_in_a_state_is_refused_or_harmless(
    station: Callable[..., Any], kind: str, caplog: pytest.LogCaptureFixture
) -> None:
    ground = station(VEHICLES[kind])
    under_way(ground, kind)
    good = ground.sim.save()
    content: list[Any] = []
    _altered(good, lambda pilot: content.append(copy.deepcopy(pilot)))
    paths = list(places(content[0]))

    @settings(max_examples=examples(400), deadline=None)
    @given(st.lists(st.tuples(st.sampled_from(paths), VALUES), min_size=1, max_size=3))
    def change(changes: list[tuple[tuple[Any, ...], Any]]) -> None:
        caplog.clear()

        def change_some(pilot: Any) -> None:
            for (*way, last), value in changes:
                inner = pilot
                try:
                    for name in way:
                        inner = inner[name]
                    inner[last] = copy.deepcopy(value)  # a later change may be inside it
                except (TypeError, IndexError, KeyError):
                    pass  # another change has removed it

        with contextlib.suppress(StateError):
            ground.sim.restore(_altered(good, change_some))
        ground.step(10)
        ground.sim.restore(good)
        ground.step(2)
        assert [one.getMessage() for one in caplog.records if one.levelno >= logging.ERROR] == []

    change()
