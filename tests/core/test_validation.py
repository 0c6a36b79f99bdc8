"""One validator for all input from outside."""

from __future__ import annotations

import contextlib
import copy
import json
import math
import pickle
from collections.abc import Callable
from types import SimpleNamespace
from typing import Annotated, Any, Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from kind_components import made

from morse.actuators.teleport import Teleport
from morse.actuators.v_omega import MotionVW
from morse.core.declarations import Option, add_data, add_property
from morse.core.exceptions import MorseDeclarationError, MorseRPCTypeError
from morse.core.modifier import AbstractModifier
from morse.core.realism import copied
from morse.core.reports.quoting import closest, nearest
from morse.core.services import service, signature_of
from morse.core.streams.local_data import Later, LocalData
from morse.core.validation import (
    Arguments,
    CommandError,
    Commands,
    OptionError,
    PropertyError,
    Range,
    checked_options,
    checked_property,
)
from morse.wire.encoding import to_json


class Arm:
    add_data("force", [0.0] * 3, "vec3", "", unit="N", shape=3, dtype="float64", low=-10.0, high=10.0)
    add_data("rows", [], "list", "", shape=(None, 2))
    add_data("level", 3, "int", "", low=0, high=9)
    add_data("dial", math.inf, "float", "", low=0.0, high=1.0, allow=("inf",))
    add_data("bytes", [0, 0], "list", "", shape=2, dtype="uint8")
    add_data("path", [], "list", "")
    add_data("anything", None, "", "")
    add_property("_type", "Velocity", "ControlType", "string", "", choices=("Velocity", "Position"))
    add_property("_speed", 1.0, "Speed", "float", "", low=0.0, high=5.0, unit="m/s")
    add_property("_count", 1, "Count", "int", "", low=1)
    add_property("_free", 1.0, "Free", "float", "")


def taken(message: Any) -> dict[str, Any]:
    component = made(Arm)
    Commands(component).take(message)
    return component.local_data


# -- commands ------------------------------------------------------------------------------


def test_a_message_with_thousands_of_fields_is_refused_before_they_are_checked():
    component = made(Arm)
    with pytest.raises(CommandError, match="at most 4096 fields, got 60001"):
        Commands(component).take({"level": 5, **{f"k{number}": 1 for number in range(60_000)}})
    assert component.local_data["level"] == 3


def test_arrays_arrive_in_the_shape_and_dtype_that_are_declared():
    data = taken({"force": [1, 2, 3], "rows": [[1, 2], [3, 4]], "bytes": [0, 255]})
    assert data["force"].dtype == np.float64
    assert data["force"].flags.c_contiguous
    assert data["force"].tolist() == [1.0, 2.0, 3.0]
    assert data["rows"] == [[1.0, 2.0], [3.0, 4.0]]
    assert data["bytes"].dtype == np.uint8
    assert taken({"force": np.array([1.0, 2.0, 3.0], np.float32)})["force"].dtype == np.float64
    assert taken({"rows": []})["rows"] == []


@pytest.mark.parametrize(
    ("field", "value", "expected"),
    [
        ("force", [1, 2], "an array of 3 numbers from -10 to 10 N"),
        ("force", [1, 2, 3, 4], "an array of 3 numbers"),
        ("force", [1, 2, 11], "from -10 to 10 N"),
        ("force", [1, 2, True], "an array of 3 numbers"),
        ("force", [1, 2, "3"], "an array of 3 numbers"),
        ("force", [1, 2, math.nan], "an array of 3 numbers"),
        ("force", np.array([1.0, 2.0, np.inf]), "an array of 3 numbers"),
        ("force", np.array(["a", "b", "c"]), "an array of 3 numbers"),
        ("force", np.zeros((3, 1)), "an array of 3 numbers"),
        ("rows", [[1, 2], [3]], "a list of N x 2 numbers"),
        ("rows", [1, 2], "a list of N x 2 numbers"),
        ("level", 10, "a number from 0 to 9"),
        ("level", 10**4000, "a number from 0 to 9"),
        ("dial", -math.inf, "from 0 to 1"),
        ("dial", 1.5, "a number from 0 to 1"),
        ("bytes", [0, 256], "that fit uint8"),
        ("bytes", [0, 0.5], "that fit uint8"),
        ("path", [math.inf], "finite numbers"),
        ("path", ["\ud800"], "valid Unicode"),
        ("anything", {"\udfff": 1}, "valid Unicode"),
        ("anything", 2**70, "64 bits"),
    ],
)
def test_what_does_not_fit_is_refused_and_changes_nothing(field, value, expected):
    component = made(Arm)
    before = copy.deepcopy(component.local_data)
    with pytest.raises(CommandError, match=expected):
        Commands(component).take({"level": 1, "dial": 0.5, field: value})
    np.testing.assert_equal(component.local_data, before)


def test_infinity_is_taken_where_it_is_allowed():
    assert taken({"dial": math.inf})["dial"] == math.inf


def test_deep_nesting_is_refused_without_recursion():
    deep: Any = []
    for _ in range(100_000):
        deep = [deep]
    with pytest.raises(CommandError, match="nested at most 32 deep"):
        taken({"path": deep})


@pytest.mark.parametrize("name", ["\ud800", "n" * 1000, ""])
def test_names_that_no_field_could_have(name):
    component = made(Arm)
    commands = Commands(component)
    try:
        commands.take({name: 1})
    except CommandError as error:
        str(error).encode()
        assert name not in component.local_data


def test_undeclared_fields_are_bounded_in_number_and_size():
    component = made(Arm)
    commands = Commands(component)
    remark = commands.take({"big": "x" * 2_000_000})
    assert "too large" in remark
    assert "big" not in component.local_data
    for n in range(200):
        commands.take({f"k{n}": "x" * 30_000})
    assert sum(len(v) for k, v in component.local_data.items() if k.startswith("k")) <= 1 << 20
    # an existing one may be replaced any number of times
    for n in range(200):
        commands.take({"k0": "y" * 30_000 + str(n)})
    assert component.local_data["k0"].endswith("199")


def test_a_strict_simulation_refuses_fields_that_are_not_declared():
    component = made(Arm)
    component.context = SimpleNamespace(strict=True)
    with pytest.raises(CommandError, match="no field 'forse'; did you mean 'force'"):
        Commands(component).take({"level": 5, "forse": 1})
    assert component.local_data["level"] == 3


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(st.characters()),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(st.characters()), inner),
    max_leaves=10,
)


@given(st.dictionaries(st.sampled_from(["force", "rows", "level", "dial", "bytes", "path"]) | st.text(), json_values))
def test_any_message_leaves_the_data_as_declared(message):
    component = made(Arm)
    with contextlib.suppress(CommandError):
        Commands(component).take(message)
    data = component.local_data
    assert data["force"].shape == (3,)
    assert (np.abs(data["force"]) <= 10.0).all()
    assert 0 <= data["level"] <= 9
    assert 0.0 <= data["dial"] <= 1.0 or data["dial"] == math.inf


@pytest.mark.parametrize(
    ("cls", "message"),
    [
        (MotionVW, {"v": 1e14}),
        (MotionVW, {"w": 1e160}),
        (MotionVW, {"v": math.inf}),
        (Teleport, {"x": 1e308}),
        (Teleport, {"z": -1e150}),
        (Teleport, {"yaw": 1e200}),
    ],
)
def test_what_no_robot_could_do_is_refused(cls, message):
    component = _data_of(cls)
    with pytest.raises(CommandError, match=r"from -1(0000|e\+0)"):
        Commands(component).take(message)


def _data_of(cls: type) -> Any:
    class Data(cls):  # type: ignore[misc]
        def __init__(self) -> None:
            pass

    return made(Data)


# -- properties ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("ControlType", "Velo", r"'ControlType' of robot.arm is 'Velo', expected one of .*; did you mean 'Velocity'\?"),
        ("ControlType", 5, "one of 'Velocity', 'Position'"),
        ("Speed", 6, "a number from 0 to 5 m/s"),
        ("Speed", "fast", "a number from 0 to 5 m/s"),
        ("Speed", math.nan, "a number"),
        ("Speed", True, "a number"),
        ("Count", 1.5, "an integer from 1 upward"),
        ("Count", 10**400, "an integer"),
        ("Free", math.inf, "a finite number"),
        ("Sped", 1, "no property 'Sped'; did you mean 'Speed'"),
        ("\ud800", 1, "no property"),
        (["Speed"], 1, "no property"),
        ("n" * 10_000_000, 1, "no property"),
    ],
)
def test_properties_that_do_not_fit_are_refused(name, value, expected):
    with pytest.raises(PropertyError, match=expected) as caught:
        checked_property(made(Arm), name, value)
    assert isinstance(caught.value, MorseRPCTypeError)
    assert len(str(caught.value)) < 1000


def test_properties_that_fit_are_stored_as_declared():
    assert checked_property(made(Arm), "Speed", 2) == ("_speed", 2.0)
    assert checked_property(made(Arm), "Count", 2.0) == ("_count", 2)
    assert checked_property(made(Arm), "ControlType", "Position") == ("_type", "Position")


# -- services ------------------------------------------------------------------------------

Share = Annotated[float, Range(0.0, 1.0)]


class Station:
    @service
    def drive(self, v: Annotated[float, Range(-2.0, 2.0, "m/s")], how: Literal["fast", "slow"] = "slow") -> None: ...

    @service
    def go(self, to: Annotated[list[float], Range(-1e3, 1e3, "m", shape=(3,))], share: Share | None = None) -> None: ...

    @service
    def unknown(self, a: Nonsense, b: Share) -> None: ...  # type: ignore[name-defined] # noqa: F821


@pytest.mark.parametrize(
    ("name", "arguments", "expected"),
    [
        ("drive", [3.0], "'v' is a number from -2 to 2 m/s, not 3.0"),
        ("drive", [1.0, "fst"], "'how' is one of 'fast', 'slow'; did you mean 'fast'"),
        ("go", [[1, 2]], "a list of 3 numbers from -1000 to 1000 m"),
        ("go", [[1, 2, 1e150]], "from -1000 to 1000 m"),
        ("go", [[1, 2, 3], 2], "a number from 0 to 1"),
        ("unknown", ["x", 2], "'b' is a number from 0 to 1"),
    ],
)
def test_arguments_have_the_range_of_their_annotation(name, arguments, expected):
    with pytest.raises(MorseRPCTypeError, match=expected):
        Arguments(getattr(Station(), name), name).check(arguments)


def test_arguments_that_fit():
    Arguments(Station().go, "go").check([[1, 2, 3], None])
    Arguments(Station().go, "go").check([[1, 2, 3], 0.5])
    Arguments(Station().drive, "drive").check([-2, "fast"])
    Arguments(Station().unknown, "unknown").check([object(), 1])


def test_signatures_show_plain_types():
    assert str(signature_of(Station().go)).startswith("(to: list[float], share: float | None = None)")


# -- options -------------------------------------------------------------------------------

OPTIONS = {
    "port": Option(int, 5556, low=0, high=65535),
    "rate": Option(float, 1.0, unit="Hz"),
    "mode": Option(str, "a", choices=("a", "b")),
    "size": Option((float, dict), 0.5),
    "at": Option(list, None, shape=(3,)),
}


@pytest.mark.parametrize(
    ("given_", "expected"),
    [
        ({"prot": 1}, "Zmq has no option 'prot'; did you mean 'port'"),
        ({"port": 70000}, "option 'port' of Zmq is 70000, expected an integer from 0 to 65535"),
        ({"port": "5556"}, "an integer"),
        ({"rate": math.nan}, "a number"),
        ({"mode": "c"}, "one of 'a', 'b'"),
        ({"size": "big"}, "float or dict"),
        ({"at": [1, 2]}, "a list of 3 numbers"),
    ],
)
def test_options_that_do_not_fit_are_refused(given_, expected):
    with pytest.raises(OptionError, match=expected):
        checked_options("Zmq", OPTIONS, given_)


def test_options_that_fit():
    assert checked_options("Zmq", OPTIONS, {"port": 0, "rate": 2, "size": {"x": 1.0}, "at": None})["rate"] == 2.0


def test_modifiers_check_the_options_that_they_declare():
    class Shift(AbstractModifier):
        options = {"by": Option(float, 0.0, unit="m")}  # noqa: RUF012

        def modify(self) -> None: ...

    assert Shift(made(Arm), {"by": 1}).kwargs == {"by": 1.0}
    with pytest.raises(OptionError, match="Shift has no option 'bye'; did you mean 'by'"):
        Shift(made(Arm), {"bye": 1})


# -- declarations --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ({"unit": "metre"}, "the unit 'metre' is unknown"),
        ({"unit": "ra"}, "did you mean 'rad'"),
        ({"frame": "wrld"}, "the frame 'wrld' is unknown; did you mean 'world'"),
        ({"dtype": "float46", "shape": 1}, "the dtype 'float46' is unknown; did you mean 'float64'"),
        ({"low": 1.0}, "the default 0.0 is outside 1..inf"),
        ({"low": 2.0, "high": 1.0}, "low=2 is greater than high=1"),
        ({"low": "x"}, "low is a number"),
        ({"angle": True, "unit": "m"}, "an angle has the unit 'rad' or 'deg', not 'm'"),
        ({"shape": (3,)}, "does not have the shape"),
        ({"shape": (0,)}, "shape is a tuple of lengths"),
        ({"quaternion": True}, "does not have the shape"),
        ({"allow": ("infinity",)}, "the value of allow 'infinity' is unknown"),
        ({"allow": "inf"}, "allow is a tuple"),
    ],
)
def test_fields_that_cannot_be_are_refused_with_class_and_line(arguments, expected):
    with pytest.raises(MorseDeclarationError, match=expected) as caught:

        class Wrong:
            add_data("field", 0.0, "float", "", **arguments)

    assert "test_validation.py:" in str(caught.value)
    assert "Wrong: data field 'field'" in str(caught.value)


def test_properties_that_cannot_be_are_refused():
    with pytest.raises(MorseDeclarationError, match="property 'P': the default 'c' is not one of the choices"):

        class Wrong:
            add_property("_p", "c", "P", choices=("a", "b"))


# -- hints ---------------------------------------------------------------------------------


def test_near_misses_are_found_whatever_the_case():
    assert closest("velo", ["Velocity", "Position"]) == "Velocity"
    assert nearest("x" * 10**8, ["a"] * 3) == "; known: a"
    names = [f"object{n}" for n in range(100_000)]
    assert closest("object9999x", names) is not None


# -- fields that are computed when they are read look to every reader as if they had always been there

PLAIN: dict[str, Any] = {"timestamp": 1.5, "point_list": [[1.0, 2.0, 3.0]], "range_list": [4.0, 5.0]}


def lazy() -> LocalData:
    data = LocalData(PLAIN)
    data["point_list"] = Later(lambda: np.array([[1.0, 2.0, 3.0]]))
    data["range_list"] = Later(lambda: np.array([4.0, 5.0]))
    return data


def listed(array: Any) -> Any:
    return array.tolist()


def plain(data: dict[str, Any]) -> dict[str, Any]:
    return {key: listed(value) if isinstance(value, np.ndarray) else value for key, value in data.items()}


WAYS: dict[str, Callable[[Any], Any]] = {
    "dict": dict,
    "stars": lambda data: dict(**data),
    "display": lambda data: {**data},
    "update": lambda data: _updated(data),
    "or": lambda data: {} | data,
    "or, first": lambda data: data | {},
    "items": lambda data: dict(data.items()),
    "values": lambda data: dict(zip(data, data.values(), strict=True)),
    "keys": lambda data: {key: data[key] for key in data},
    "get": lambda data: {key: data.get(key) for key in list(data)},
    "setdefault": lambda data: {key: data.setdefault(key, 0) for key in PLAIN},
    "pop": lambda data: {key: data.pop(key) for key in PLAIN},
    "popitem": lambda data: dict([data.popitem() for _ in PLAIN][::-1]),
    "copy": lambda data: data.copy(),
    "copy.copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda data: pickle.loads(pickle.dumps(data.copy())),
    "copied": copied,
    "json": lambda data: json.loads(json.dumps(data, default=listed)),
    "indented json": lambda data: json.loads(json.dumps(data, indent=1, default=listed)),
    "socket": lambda data: json.loads(to_json(data)),
    "repr": lambda data: eval(repr(data), {"array": np.array}),
}


def _updated(data: LocalData) -> dict[str, Any]:
    result: dict[str, Any] = {}
    result.update(data)
    return result


@pytest.mark.parametrize("way", WAYS)
def test_every_way_of_reading_finds_the_values_in_their_order(way: str) -> None:
    found = WAYS[way](lazy())
    assert list(found) == list(PLAIN)
    assert plain({key: found[key] for key in PLAIN}) == PLAIN
    assert all(type(value) is not Later for value in dict.values(found))


def test_the_messages_are_the_same_byte_for_byte() -> None:
    assert to_json(lazy()) == to_json(PLAIN) == json.dumps(PLAIN).encode()


def test_a_value_is_worked_out_once_and_only_if_it_is_read() -> None:
    calls: list[str] = []
    data = LocalData(timestamp=0.0)
    data["seen"] = Later(lambda: calls.append("seen") or [1.0])
    data["unseen"] = Later(lambda: calls.append("unseen") or [2.0])
    assert "seen" in data
    assert len(data) == 3
    assert calls == []
    data["seen"].append(9.0)  # like a modifier
    assert data["seen"] == [1.0, 9.0]
    assert calls == ["seen"]


def test_what_is_missing_is_missing() -> None:
    with pytest.raises(KeyError):
        lazy()["speed"]
    with pytest.raises(KeyError):
        lazy().pop("speed")
    assert lazy().pop("speed", 3) == 3
    assert lazy().get("speed") is None
    with pytest.raises(TypeError):
        hash(lazy())
