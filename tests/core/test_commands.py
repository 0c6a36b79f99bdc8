import copy
import logging
import math
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

import morse
from morse.builder import ATRV, Environment, MotionVW
from morse.core.clients.complaints import Complaints, Waiting
from morse.core.datastream import DatastreamManager
from morse.core.declarations import add_data
from morse.core.streams.kind_stream import KindStream
from morse.core.validation import CommandError, Commands
from morse.scene import StreamDeclaration

DEFAULTS = {
    "v": 0.0,
    "w": 0.0,
    "gear": 1,
    "lights": False,
    "mode": "slow",
    "target": [0.0, 0.0, 0.0],
    "path": [],
    "options": {},
    "anything": None,
}
json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=10,
)


class Plain:
    """Has data, and declares its fields like components of 1.4."""

    add_data("v", 0.0, "float", "m/s")
    add_data("w", 0.0, "float", "rad/s")
    add_data("gear", 1, "int", "of the box")
    add_data("lights", False, "bool", "on")
    add_data("mode", "slow", "string", "of driving")
    add_data("target", [0.0, 0.0, 0.0], "vec3<float>", "m")
    add_data("path", [], "list", "of points")
    add_data("options", {}, "dict", "of all kinds")
    add_data("anything", None, "", "of any kind")

    context = SimpleNamespace(strict=False)

    def __init__(self) -> None:
        self.local_data: dict[str, Any] = copy.deepcopy(DEFAULTS)


def merged(message: object) -> dict[str, Any]:
    component = Plain()
    Commands(component).take(message)  # type: ignore[arg-type]
    return component.local_data


def test_what_a_message_does_not_have_stays() -> None:
    assert merged({"v": 1.5}) == {**DEFAULTS, "v": 1.5}


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("v", 1),
        ("v", -0.5),
        ("gear", 2),
        ("gear", 2.5),
        ("lights", True),
        ("mode", "fast"),
        ("target", [1, 2, 3]),
        ("target", [1, 2, 3, 4]),
        ("path", [[1, 2], "a"]),
        ("options", {"a": [1]}),
        ("anything", {"a": 1}),
        ("anything", None),
    ],
)
def test_a_value_that_fits_is_taken(field: str, value: object) -> None:
    assert merged({field: value})[field] == value


def test_numbers_arrive_as_the_type_of_the_field() -> None:
    data = merged({"v": 1, "lights": 1, "target": [1, 2, 3]})
    assert type(data["v"]) is float
    assert type(data["lights"]) is bool
    assert [type(x) for x in data["target"]] == [float] * 3


@pytest.mark.parametrize(
    ("field", "value", "expected"),
    [
        ("v", "fast", "a number"),
        ("v", None, "a number"),
        ("v", math.nan, "a number"),
        ("v", True, "a number"),
        ("v", [1.0], "a number"),
        ("v", 10**400, "a finite number"),
        ("v", math.inf, "a finite number"),
        ("v", -math.inf, "a finite number"),
        ("gear", "2", "a number"),
        ("gear", 10**30, "a number"),
        ("gear", math.nan, "a number"),
        ("lights", "on", "a boolean"),
        ("lights", 2, "a boolean"),
        ("mode", 3, "a string"),
        ("target", 1.0, "a list of 3 numbers"),
        ("target", [1.0, 2.0], "a list of 3 numbers"),
        ("target", [1.0, 2.0, None], "a list of 3 numbers"),
        ("target", [1.0, 2.0, math.nan], "a list of 3 numbers"),
        ("target", "123", "a list of 3 numbers"),
        ("path", "a-b", "a list"),
        ("options", [1], "an object"),
    ],
)
def test_a_value_that_does_not_fit_is_refused_with_its_whole_message(field: str, value: object, expected: str) -> None:
    component = Plain()
    with pytest.raises(CommandError, match=rf"'{field}' is .*expected.*{expected}") as caught:
        Commands(component).take({"w": 1.0, field: value, "mode": "fast"} if field != "mode" else {"w": 1.0, "mode": 3})  # type: ignore[arg-type]
    assert caught.value.field == field
    assert component.local_data == DEFAULTS


@pytest.mark.parametrize("message", [[1.0], "v", 3, True])
def test_a_message_is_an_object(message: object) -> None:
    with pytest.raises(CommandError, match="expected a JSON object with some of v, w"):
        merged(message)


def test_a_field_that_is_not_declared_is_kept_and_reported_once() -> None:
    component = Plain()
    fields = Commands(component)  # type: ignore[arg-type]
    assert "'vv'; did you mean 'v'?" in str(fields.take({"vv": 1.0, "w": 2.0}))
    assert fields.take({"vv": 2.0}) is None
    assert component.local_data["w"] == 2.0
    assert component.local_data["vv"] == 2.0


def test_fields_that_are_not_declared_do_not_fill_the_memory() -> None:
    component = Plain()
    fields = Commands(component)  # type: ignore[arg-type]
    for n in range(1000):
        fields.take({f"k{n}": n})
    assert len(component.local_data) < 100


@given(st.dictionaries(st.sampled_from([*DEFAULTS, "extra"]) | st.text(), json_values))
def test_any_message_leaves_the_data_of_the_right_kind(message: dict[str, object]) -> None:
    component = Plain()
    try:
        Commands(component).take(message)  # type: ignore[arg-type]
    except CommandError:
        assert component.local_data == DEFAULTS
    data = component.local_data
    assert set(DEFAULTS) <= set(data)
    assert all(type(data[name]) is type(DEFAULTS[name]) for name in ("v", "w", "lights", "mode", "target", "options"))
    assert not math.isnan(data["v"])
    assert len(data["target"]) >= 3


def test_a_field_that_holds_nothing_yet_takes_what_it_declares() -> None:
    motion = Plain()
    motion.local_data["v"] = None
    with pytest.raises(CommandError):
        Commands(motion).take({"v": "fast"})


def test_what_a_field_holds_counts_more_than_its_default() -> None:
    motion = Plain()
    motion.local_data["mode"] = 1.5
    Commands(motion).take({"mode": 2.5})
    assert motion.local_data["mode"] == 2.5
    with pytest.raises(CommandError):
        Commands(motion).take({"mode": "fast"})


def test_fields_that_are_too_large_are_logged_once() -> None:
    commands = Commands(Plain())  # type: ignore[arg-type]
    remarks = [commands.take({f"field{number}": "x" * 2_000_000}) for number in range(10)]
    assert remarks[0] is not None
    assert "too large" in remarks[0]
    assert remarks[1:] == [None] * 9


# -- what is lost is said --------------------------------------------------------------------------


def test_the_oldest_entries_are_lost_and_counted(caplog: pytest.LogCaptureFixture) -> None:
    now = [0.0]
    complaints = Complaints(logging.getLogger("morse.test"), lambda: now[0])
    waiting: Waiting[int] = Waiting(3, complaints, "motion", "commands")
    for number in range(3):
        waiting.append(number)
    assert caplog.messages == []
    for number in range(3, 8):
        waiting.append(number)
    assert list(waiting) == [5, 6, 7]
    assert caplog.messages == ["motion: commands arrive faster than they are read: the oldest of more than 3 are lost"]
    now[0] = 11.0
    waiting.append(8)
    assert caplog.messages[1].endswith("(4 more of this kind)")


def test_commands_that_are_lost_are_said(caplog: pytest.LogCaptureFixture) -> None:
    def scene() -> None:
        robot = ATRV("robot")
        robot.append(MotionVW("motion"))
        Environment("empty", fastmode=True)

    with morse.load(scene) as simulation:
        manager = DatastreamManager({}, simulation.context)
        component = simulation.context.components["robot.motion"]
        kind = f"{KindStream.__module__}.{KindStream.__name__}"
        manager.connect(component, StreamDeclaration("link", kind, "IN", {}))
        (stream,) = manager.streams["robot.motion"]
        for number in range(100):
            stream.receive(stream.kinds[0], {"linear": [0.01 * number, 0.0, 0.0]})
        simulation.step()
        assert component.local_data["v"] == 0.99
    (line,) = [one for one in caplog.messages if "are lost" in one]
    assert line.startswith("robot.motion: commands arrive faster")
