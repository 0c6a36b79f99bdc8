import json
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.helpers.transformation import Transformation3d
from morse.mathutils import Euler, Matrix, Quaternion, Vector
from morse.wire.encoding import from_json, to_json

scalars = st.none() | st.booleans() | st.integers() | st.floats() | st.text()
values = st.recursive(scalars, lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner), max_leaves=20)
numbers = st.recursive(st.floats() | st.integers(), lambda inner: st.lists(inner), max_leaves=30)


def same(a: Any, b: Any) -> bool:
    if isinstance(a, float) and isinstance(b, float) and math.isnan(a):
        return math.isnan(b)
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, dict) and isinstance(b, dict):
        return list(a) == list(b) and all(same(a[key], b[key]) for key in a)
    return bool(a == b)


@given(values)
def test_any_value_of_json_survives_in_one_line(value: object) -> None:
    text = to_json(value)
    assert b"\n" not in text
    assert same(json.loads(text), json.loads(json.dumps(value)))


@given(st.dictionaries(st.from_regex(r"[a-z_][a-z_0-9]{0,8}", fullmatch=True), numbers))
def test_the_data_of_a_sensor_looks_as_the_json_module_writes_it(data: dict[str, object]) -> None:
    text, plain = to_json(data).decode(), json.dumps(data)
    assert same(json.loads(text), data)
    # numbers may have another notation (1e16 for 1e+16), but everything between them is the same
    digits = str.maketrans("", "", "0123456789.+-e")
    assert text.translate(digits) == plain.translate(digits)


def test_the_lines_of_1_4() -> None:
    pose = {"timestamp": 1.14, "x": 2.5, "y": 1.0, "z": 0.0, "yaw": 0.0, "pitch": 0.0, "roll": 0.0}
    assert to_json(pose) == b'{"timestamp": 1.14, "x": 2.5, "y": 1.0, "z": 0.0, "yaw": 0.0, "pitch": 0.0, "roll": 0.0}'
    assert to_json({"a": [1, [2.5, -3]], "b": {"c": []}}) == b'{"a": [1, [2.5, -3]], "b": {"c": []}}'
    assert to_json({"null": 1.0, "a,b": 2, "c:d": 3}) == b'{"null": 1.0, "a,b": 2, "c:d": 3}'
    assert to_json({"near": {"cat": 1.5}, "label": "a, b: c"}) == b'{"near": {"cat": 1.5}, "label": "a, b: c"}'


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (Vector((1.0, 2.0, 3.5)), b"[1.0, 2.0, 3.5]"),
        (Matrix(((1.0, 2.0), (3.0, 4.0))), b"[[1.0, 2.0], [3.0, 4.0]]"),
        (Quaternion((1.0, 2.0, 3.0, 4.0)), b'{"x": 2.0, "y": 3.0, "z": 4.0, "w": 1.0}'),
        (Euler((0.1, 0.2, 0.3)), b'{"yaw": 0.3, "pitch": 0.2, "roll": 0.1}'),
        (math.inf, b"Infinity"),
        ([-math.inf, math.nan], b"[-Infinity, NaN]"),
        ({"range": math.inf}, b'{"range": Infinity}'),
        ({"pose": Vector((1.0, math.inf))}, b'{"pose": [1.0, Infinity]}'),
        ({"a": None, "b": True}, b'{"a": null, "b": true}'),
        (np.float32(0.5), b"0.5"),
        (np.float64(0.25), b"0.25"),
        (np.int64(3), b"3"),
        ({"scan": np.array([[1.5, 2.0]])}, b'{"scan": [[1.5, 2.0]]}'),
        ({"hit": np.bool_(True)}, b'{"hit": true}'),
        ({"raw": b"\x00\xff"}, b'{"raw": "AP8="}'),
        ({"raw": bytearray(b"abc")}, b'{"raw": "YWJj"}'),
        ((1, 2), b"[1, 2]"),
        ({1: 2}, b'{"1": 2}'),
        (2**70, b"1180591620717411303424"),
        ("größe", rb'"gr\u00f6\u00dfe"'),
    ],
)
def test_the_form_of_every_type(value: object, text: bytes) -> None:
    assert to_json(value) == text


def test_a_transformation_is_a_position_and_three_angles() -> None:
    text = to_json({"pose": Transformation3d()})
    assert json.loads(text) == {"pose": {"x": 0.0, "y": 0.0, "z": 0.0, "yaw": 0.0, "pitch": 0.0, "roll": 0.0}}


def test_what_has_no_form_is_named() -> None:
    with pytest.raises(TypeError, match=r"object .* cannot be written as JSON"):
        to_json({"a": object()})


def test_what_holds_itself_is_refused() -> None:
    loop: list[object] = []
    loop.append(loop)
    with pytest.raises(ValueError, match=r"."):
        to_json(loop)
    with pytest.raises(ValueError, match=r"."):
        to_json({"a": loop})


@given(values)
def test_what_the_json_module_writes_can_be_read(value: object) -> None:
    assert same(from_json(json.dumps(value).encode()), value)


@given(st.binary())
def test_any_bytes_are_read_or_refused(data: bytes) -> None:
    try:
        from_json(data)
    except ValueError:
        return


@pytest.mark.parametrize("text", [b"", b"{", b"[" * 100_000, b'{"a":' * 100_000, b"1 2", b"\xff", b"nan", b"{'a': 1}"])
def test_what_is_no_json_is_refused(text: bytes) -> None:
    with pytest.raises(ValueError, match=r"."):
        from_json(text)
