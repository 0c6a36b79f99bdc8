"""Damaged and malicious states: refused, with nothing changed and nothing executed."""

import copy
import itertools
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
import state_scenes as scenes
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from morse.core.state import StateError
from morse.simulation.states.state import State
from tests.kit.effort import examples

PLAN = {"robots": [True], "things": 1, "scan": False, "seed": 5}
PART = "robot.everything"


@pytest.fixture(scope="module")
def simulation() -> Iterator[Any]:
    with scenes.load(PLAN) as loaded:
        scenes.go(loaded, PLAN, 9)
        yield loaded


def refused(simulation: Any, state: Any, text: str = ".") -> None:
    before = simulation.state_hash()
    with pytest.raises(StateError, match=text):
        simulation.restore(state)
    assert simulation.state_hash() == before


def with_attribute(simulation: Any, value: Any, name: str = "new") -> State:
    """A state of a component with an additional attribute."""
    parts = copy.deepcopy(simulation.save().parts)
    parts[PART][1].append([name, value])
    return State.from_bytes(State(parts).to_bytes())


@pytest.mark.parametrize("name", ["position_3d", "frequency", "_active"])
def test_an_attribute_that_every_component_has_is_not_missing(simulation: Any, name: str) -> None:
    """A damaged name would otherwise deactivate the component in the next tick."""
    parts = copy.deepcopy(simulation.save().parts)
    entry = next(entry for entry in parts[PART][1] if entry[0] == name)
    entry[0] = name + "x"
    refused(simulation, State.from_bytes(State(parts).to_bytes()), f"'{name}' of robot.everything is missing")


def _twister(place: int) -> list[Any]:
    state = ["dict", [["key", ["array", "<u4", [624], b"\0" * 2496]], ["pos", place]]]
    return ["random", "MT19937", ["dict", [["bit_generator", "MT19937"], ["state", state]]]]


def _came(kind: str, position: list[float]) -> list[Any]:
    newcomer = ["list", ["x", kind, ["list", position], ["list", [0.0] * 3]]]
    return ["dict", [["came", ["list", [newcomer]]], ["gone", ["list", []]]]]


def _gone(name: str) -> list[Any]:
    return ["dict", [["came", ["list", []]], ["gone", ["list", [name]]]]]


HARMFUL = {
    "a class of Python": ["object", "subprocess:Popen", [["args", "touch /tmp/harm"]]],
    "a class that a module of MORSE has imported": [
        "object",
        "morse.simulation.states.state:tempfile._TemporaryFileCloser",
        [],
    ],
    "a function as a class": ["object", "os:system", []],
    "an own state of a class of Python": ["own", "logging.config:DictConfigurator", ["dict", []]],
    "the simulation": ["object", "morse.simulation.simulation:Simulation", []],
    "the engine": ["own", "morse.physics.world:World", ["dict", []]],
    "a class that is none": ["object", "state_parts_of_users:HOME", []],
    "no class at all": ["object", 17, []],
    "an attribute of objects": ["object", "state_parts_of_users:Estimate", [["__class__", 1]]],
    "another attribute of objects": ["object", "state_parts_of_users:Estimate", [["__dict__", ["dict", []]]]],
    "a method of the engine": ["method", ["part", "world"], "__reduce__"],
    "a method that there is not": ["method", ["part", "component robot"], "no_such"],
    "a variable that there is not": ["global", "os:environ", ["dict", []]],
    "a variable of MORSE": ["global", "morse.core.context:_alive", ["dict", []]],
    "a part that there is not": ["part", "component robot.nobody"],
    "a word that there is not": ["pickle", b"cos\nsystem\n(S'touch /tmp/harm'\ntR."],
    "an array of objects": ["array", "|O", [1], b"\0" * 8],
    "objects of a huge shape": ["objects", [10**10], []],
    "objects of a negative shape": ["objects", [-1, -1], [1]],
    "an array of a huge shape": ["array", "<f8", [10**10], b""],
    "an array that overflows": ["array", "<f8", [2**62, 2**62], b""],
    "a view out of its array": ["view", ["array", "<f8", [2], b"\0" * 16], "<f8", [4], 0, [8]],
    "a view before its array": ["view", ["array", "<f8", [2], b"\0" * 16], "<f8", [1], -8, [8]],
    "a view with long strides": ["view", ["array", "<f8", [2], b"\0" * 16], "<f8", [2], 0, [2**40]],
    "a view of no array": ["view", ["list", []], "<f8", [1], 0, [8]],
    "a type that is none": ["array", "<f99", [1], b"\0" * 8],
    "a structure of objects": ["array", ["list", [["tuple", ["a", "|O"]]]], [1], b"\0" * 8],
    "met before, but not": ["again", 10**6],
    "met before, from the end": ["again", -1],
    "nothing": [],
    "a list as a word": [[[]], 1],
    "a key that is a list": ["dict", [[["list", []], 1]]],
    "a generator beyond its table": _twister(10**6),
    "a generator before its table": _twister(-1),
    "a generator that is none": ["random", "Popen", ["dict", []]],
    "a deque of a negative length": ["deque", -5, []],
    "an enumeration that is none": ["enum", "subprocess:Popen", "PIPE", -1],
    "a member that there is not": ["enum", "state_parts_of_users:Mood", "ANGRY", 3],
    "a tuple that is none": ["named tuple", "subprocess:Popen", []],
    "a simple thing that is none": ["simple", "system", "touch /tmp/harm"],
    "an integer that is none": ["integer", "zz"],
    "a pose of two numbers": ["pose", [1.0, 2.0], []],
    "a vector that is none": ["values", "Vector", "ab"],
    "a raw dictionary": {"a": 1},
}


@pytest.mark.parametrize("value", HARMFUL.values(), ids=HARMFUL.keys())
def test_what_would_do_harm_is_refused(simulation: Any, value: Any) -> None:
    refused(simulation, with_attribute(simulation, value))


def test_what_is_nested_deeply_is_refused(simulation: Any) -> None:
    deep: Any = 1
    for _ in range(300):
        deep = ["list", [deep]]
    refused(simulation, with_attribute(simulation, deep), "deep")
    refused(simulation, with_attribute(simulation, deep, "estimate"), "deep")


def test_a_file_nested_too_deeply_for_its_format_is_refused() -> None:
    with pytest.raises(StateError):
        State.from_bytes(b"MORSE state 1\n" + b"\x81\xa5clock" + b"\x91" * 100_000)


@pytest.mark.parametrize("name", ["default_action", "action", "finalize"])
def test_a_method_cannot_be_replaced(simulation: Any, name: str) -> None:
    refused(
        simulation, with_attribute(simulation, ["method", ["part", "component robot"], "toggle_active"], name), name
    )
    refused(simulation, with_attribute(simulation, 3, name), name)


@pytest.mark.parametrize(
    ("part", "value"),
    [
        ("clock", ["dict", [["tick", -1], ["seed", 0]]]),
        ("clock", ["dict", [["tick", 2**62], ["seed", 0]]]),
        ("clock", ["dict", [["tick", 5]]]),
        ("clock", ["dict", [["tick", 5], ["seed", "x"]]]),
        ("controls", ["dict", [["keys", 3], ["axes", ["list", []]], ["robot", None]]]),
        ("controls", 7),
        ("population", ["dict", [["came", 3], ["gone", ["list", []]]]]),
        ("population", _gone("nobody")),
        ("population", _gone("robot")),
        ("population", _gone("crate0")),
        ("population", _came("NoRobot", [0.0] * 3)),
        ("population", _came("ATRV", [0.0])),
        ("population", _came("ATRV", [float("nan")] * 3)),
        ("population", _came("/etc/passwd", [0.0] * 3)),
        ("inputs", ["dict", [["robot.motion", ["dict", [["v", "fast"]]]]]]),
        ("inputs", ["dict", [["robot.nobody", ["dict", []]]]]),
        ("physics", ["dict", []]),
        ("physics", 3),
        (PART, 3),
        (PART, ["list", []]),
        ("robot.pose", ["dict", [["local_data", 3]]]),
    ],
)
def test_parts_that_are_damaged_are_refused(simulation: Any, part: str, value: Any) -> None:
    parts = {**simulation.save().parts, part: value}
    try:
        state = State.from_bytes(State(parts).to_bytes())
    except StateError:
        return
    refused(simulation, state)


def _names(data: Any, path: tuple[int, ...] = ()) -> Iterator[tuple[int, ...]]:
    """The positions of all strings in a saved state: names of attributes and classes, words of the format."""
    if isinstance(data, str):
        yield path
    elif isinstance(data, list):
        for place, item in enumerate(data):
            yield from _names(item, (*path, place))


@pytest.mark.parametrize("every", [6, pytest.param(1, marks=pytest.mark.slow)])
def test_names_that_are_damaged_are_refused_or_harmless(simulation: Any, every: int) -> None:
    """A renamed attribute is missing under its own name: changes before the detection are undone."""
    kept = simulation.save()
    refusals = 0
    for part, saved in kept.parts.items():
        for place in itertools.islice(_names(saved), 0, None, every):
            parts = {**kept.parts, part: copy.deepcopy(saved)}
            data = parts[part]
            for step in place[:-1]:
                data = data[step]
            data[place[-1]] += "X"
            try:
                simulation.restore(State(parts))
            except StateError:
                refusals += 1
                assert simulation.state_hash() == kept.hash(), (part, place)
            simulation.restore(kept)
            assert simulation.state_hash() == kept.hash(), (part, place)
    assert refusals > 50 // every


def test_a_state_that_lacks_parts_or_has_others_is_refused(simulation: Any) -> None:
    parts = simulation.save().parts
    for name in ("population", "physics", PART, "inputs", "controls"):
        refused(simulation, State({key: part for key, part in parts.items() if key != name}))
    refused(simulation, State({**parts, "more": 1}), "more")


@given(data=st.data())
@settings(max_examples=examples(150), suppress_health_check=list(HealthCheck))
def test_damaged_files_are_refused_or_harmless(simulation: Any, data: st.DataObject) -> None:
    """Lost or changed bytes: the state is refused, or it is another valid state; no other exception is raised."""
    content = bytearray(simulation.save().to_bytes())
    kept = simulation.save()
    if data.draw(st.booleans()):
        del content[data.draw(st.integers(0, len(content) - 1)) :]
    else:
        for _ in range(data.draw(st.integers(1, 4))):
            content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    try:
        simulation.restore(State.from_bytes(bytes(content)))
    except StateError:
        assert simulation.state_hash() == kept.hash()
    simulation.restore(kept)
    assert simulation.state_hash() == kept.hash()


@given(content=st.binary(max_size=200), headed=st.booleans())
def test_random_bytes_are_refused(content: bytes, headed: bool) -> None:
    with pytest.raises(StateError):
        State.from_bytes(b"MORSE state 1\n" * headed + content)


def test_another_kind_of_file_is_refused(simulation: Any, tmp_path: Path) -> None:
    file = tmp_path / "state"
    file.write_bytes(b"MORSE state 99\n" + msgspec.msgpack.encode({}))
    refused(simulation, file, "version")
    with pytest.raises(FileNotFoundError):
        simulation.restore(tmp_path / "nothing")
    with pytest.raises(IsADirectoryError):
        simulation.restore(tmp_path)


def test_nothing_was_executed(simulation: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """While malicious states are read, no file is opened and no process is started."""
    events: list[str] = []
    watched = ("os.system", "subprocess.Popen", "exec", "open", "os.remove", "socket.connect", "import")
    active = True
    sys.addaudithook(lambda event, _: events.append(event) if active and event in watched else None)
    for value in HARMFUL.values():
        state = with_attribute(simulation, value)
        events.clear()
        with pytest.raises(StateError):
            simulation.restore(state)
        assert not events
    active = False
    assert np.isfinite(simulation.robot.everything.data["number"])
