"""A saved state is data: a value of any type at any place is refused or harmless, and nothing is executed."""

import multiprocessing
import time
from collections.abc import Iterator
from typing import Any

import msgspec
import pytest
import state_traps as traps
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from morse.core.state import Reader, StateError
from morse.core.state.attributes import is_data
from morse.simulation.recordings.input_recording import entry_from_bytes
from tests.kit.effort import examples

CHOICES = st.tuples(st.integers(0, 10_000), st.sampled_from(sorted(traps.VALUES)))


class NoReferences:
    """A reader with these references reads data only."""

    def name_of(self, value: Any) -> str | None:
        return None

    def find(self, name: str) -> Any:
        raise StateError(f"there is no {name}")

    def find_class(self, path: str) -> type[Any] | None:
        return None

    def met_class(self, cls: type[Any]) -> None:
        pass

    def global_name(self, value: Any) -> str | None:
        return None

    def find_global(self, name: str) -> Any:
        raise StateError(f"there is no {name}")


@pytest.fixture(scope="module")
def victim(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """Another process with a simulation: a hook for audit events cannot be removed from a process."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        pool.apply(traps.begin, (str(tmp_path_factory.mktemp("victim")),))
        yield pool


@given(choices=st.lists(CHOICES, min_size=1, max_size=2))
@settings(max_examples=examples(60), suppress_health_check=list(HealthCheck))
def test_any_value_at_any_place_is_refused_or_harmless(victim: Any, choices: list[tuple[int, str]]) -> None:
    wrong, _ = victim.apply(traps.attack, (choices,))
    assert not wrong


@pytest.mark.slow
@pytest.mark.parametrize("value", traps.VALUES)
def test_a_value_at_places_all_over_the_state(victim: Any, value: str) -> None:
    first = sorted(traps.VALUES).index(value)
    wrong, _ = victim.apply(traps.attack, ([(first + 61 * step, value) for step in range(16)],))
    assert not wrong


@pytest.mark.parametrize(
    ("component", "attribute", "value", "present"),
    [
        ("r0.pose", "position_3d", "a namespace with a method of a path", "a pose"),
        ("r0.pose", "position_3d", "a namespace with a method of another component", "a pose"),
        ("r0.pose", "position_3d", "a wiper", "a pose"),
        ("r0.trap", "position_3d", "the wiper", "a pose"),
        ("r0.trap", "initial_position_3d", "of the user", "a pose"),
        ("r0.trap", "frequency", "a text", "a number"),
        ("r0.trap", "estimate", "a namespace with a function", "in place of nothing"),
        ("r0.trap", "estimate", "a wiper", "an object of the class Estimate"),
        ("r0.trap", "hook", "a function", "nothing"),
        ("r0.trap", "hook", "a method of another component", "nothing"),
        ("r0.trap", "step", "a wiper", "a function"),
        ("r0.trap", "output_functions", "a list", "not part of"),
        ("r0.motion", "_speed", "an own component", "nothing"),
        ("r0.motion", "local_data", "a namespace with a method of a path", "a dictionary"),
        ("r0", "position_3d", "a path", "a pose"),
    ],
)
def test_a_refusal_names_the_place_and_both_kinds(
    victim: Any, component: str, attribute: str, value: str, present: str
) -> None:
    message = victim.apply(traps.message, (component, attribute, traps.VALUES[value]))
    assert message.startswith(f"{component}: ")
    assert attribute in message
    assert present in message or "not in use" in message
    assert "\n" not in message


@pytest.mark.parametrize("value", traps.VALUES.values(), ids=traps.VALUES)
def test_an_input_of_a_recording_is_data_or_refused(value: Any) -> None:
    content = msgspec.msgpack.encode([0, "service", "x", value])
    try:
        entry = entry_from_bytes(content)
    except StateError:
        return
    assert is_data(entry.content)


def _doubled(depth: int) -> list[Any]:
    """Lists of which each contains the one before twice; all of them are items of one list."""
    levels: list[Any] = [["list", [1.0, 1.0]]]
    levels += [["list", [["again", number + 1], ["again", number + 1]]] for number in range(depth)]
    return ["list", levels]


def _chained(depth: int) -> list[Any]:
    levels: list[Any] = [["list", [1.0]]]
    levels += [["list", [["again", number + 1]]] for number in range(depth)]
    return ["list", levels]


@pytest.mark.parametrize(
    "value",
    [
        _doubled(60),
        _doubled(5_000),
        _chained(5_000),
        ["array", "<f8", [2**40], b""],
        ["array", "<f8", [2**40, 2**40], b""],
        ["view", ["array", "|u1", [1], b"x"], "|u1", [2**40], 0, [0]],
        ["objects", [2**40], []],
        ["objects", [2**62, 2**62, 2**62], []],
        ["scalar", "|V2147483647", b""],
        ["list", [["view", ["array", "|u1", [50_000], bytes(50_000)], "|u1", [50_000], 0, [1]]] * 250],
        traps._nested(400),
        traps._nested(5_000),
    ],
    ids=range(12),
)
def test_what_stands_for_more_than_it_holds_is_refused_at_once(value: Any) -> None:
    begin = time.process_time()
    with pytest.raises(StateError):
        Reader(NoReferences()).part("x", value, [])
    assert time.process_time() - begin < 20.0


def test_shared_lists_and_cycles_are_restored() -> None:
    read = Reader(NoReferences()).part("x", _doubled(12), [])
    assert read[12][0] is read[11]
    ring = Reader(NoReferences()).part("x", ["list", [["again", 0]]], [])
    assert ring[0] is ring


def test_an_own_state_is_restored_whatever_attributes_hold_now(victim: Any) -> None:
    names = ("estimate", "history", "table", "space", "step", "hook", "random", "draw", "array", "path")
    values = ("nothing", "a list", "a text", "a number", "a dictionary")
    assert victim.apply(traps.exchange, (names, values)) == []
