"""The bytes of binary frames: the simulation writes what the client reads."""

import contextlib
import json
import math
import struct
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from morse.core.streams.local_data import Later, LocalData
from morse.middleware.socket.frames import TYPES, data_frame, line_frame, notice_frame
from pymorse import frames

values = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**53), 2**53) | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=8,
)
numeric = st.sampled_from(sorted(TYPES)).flatmap(
    lambda kind: arrays(kind, array_shapes(min_dims=0, min_side=0, max_dims=3, max_side=4))
)
messages = st.dictionaries(st.text(max_size=8), values | st.binary(max_size=40) | numeric, max_size=6)


def same(a: Any, b: Any) -> bool:
    if isinstance(a, np.ndarray):
        return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
    if isinstance(a, float) and isinstance(b, float):
        return a == b or (math.isnan(a) and math.isnan(b))
    if isinstance(a, dict):
        return set(a) == set(b) and all(same(a[key], b[key]) for key in a)
    if isinstance(a, list):
        return len(a) == len(b) and all(map(same, a, b))
    return type(a) is type(b) and bool(a == b)


@given(messages, st.integers(0, 2**32 - 1))
def test_what_is_written_is_read(message: dict[str, Any], number: int) -> None:
    frame = data_frame(number, message)
    head = frames.read_head(frame)
    assert head is not None
    assert (head.kind, head.stream, head.size) == (frames.DATA, number, len(frame))
    assert same(message, frames.decode(frame))


def test_the_bytes_of_a_frame_are_as_documented() -> None:
    frame = data_frame(7, {"x": 1.5, "ranges": np.array([1, 2, 3], "u2"), "name": "sick"})
    text = b'{"numbers":["x"],"arrays":[["ranges","<u2",[3]]],"fields":{"name":"sick"}}'
    text += b" " * (-len(text) % 8)
    assert frame[:16] == struct.pack("<2sBBIII", b"MF", 1, 1, 7, len(text), 16)
    assert frame[16:] == text + struct.pack("<d3H2x", 1.5, 1, 2, 3)


def test_numbers_keep_their_bits() -> None:
    message = {"a": 0.1, "b": -0.0, "c": math.inf, "d": 5e-324}
    assert struct.pack("<4d", *frames.decode(data_frame(1, message)).values()) == struct.pack("<4d", *message.values())


def test_integers_and_booleans_stay_what_they_are() -> None:
    message = {"n": 3, "on": True, "x": 1.0, "nothing": None}
    read = frames.decode(data_frame(1, message))
    assert read == message
    assert {name: type(value) for name, value in read.items()} == {name: type(value) for name, value in message.items()}


def test_fields_that_are_computed_on_demand_are_computed() -> None:
    data = LocalData(timestamp=0.5, ranges=Later(lambda: np.arange(3.0)))
    assert frames.decode(data_frame(1, data))["ranges"].tolist() == [0.0, 1.0, 2.0]


def test_arrays_of_other_types_are_lists() -> None:
    read = frames.decode(data_frame(1, {"names": np.array(["a", "b"]), "half": np.array([0.5], "f2")}))
    assert read == {"names": ["a", "b"], "half": [0.5]}


def test_arrays_that_are_not_contiguous_or_of_another_byte_order_are_read_right() -> None:
    table = np.arange(12.0).reshape(3, 4)
    message = {"turned": table.T, "every_second": table[:, ::2], "big": np.array([1, 2], ">i4")}
    read = frames.decode(data_frame(1, message))
    for name, value in message.items():
        np.testing.assert_array_equal(read[name], value)


def test_lists_of_one_message_are_not_those_of_the_next_one() -> None:
    frame = data_frame(1, {"objects": [1, 2]})
    frames.decode(frame)["objects"].append(3)
    assert frames.decode(frame) == {"objects": [1, 2]}


def test_a_line_and_a_notice_are_read() -> None:
    assert frames.decode(line_frame(3, b'{"a": 1}\n')) == {"a": 1}
    assert frames.decode(notice_frame({"closed": "robot.pose"})) == {"closed": "robot.pose"}


def test_what_contains_itself_is_refused() -> None:
    endless: list[Any] = []
    endless.append(endless)
    with pytest.raises(ValueError, match=r"contains itself|[Cc]ircular"):
        data_frame(1, {"endless": endless})


def test_what_has_no_representation_is_refused() -> None:
    with pytest.raises(TypeError, match="cannot be written as JSON"):
        data_frame(1, {"thing": object()})


# without numpy ------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", sorted(TYPES))
def test_without_numpy_arrays_are_memoryviews(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(frames, "_numpy", lambda: None)
    table = np.array([[0, 1, 1], [1, 0, 1]]).astype(kind)
    view = frames.decode(data_frame(1, {"table": table}))["table"]
    assert isinstance(view, memoryview)
    assert view.readonly
    assert (view.shape, view.tolist()) == (table.shape, table.tolist())


def test_without_numpy_an_array_may_be_empty(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(frames, "_numpy", lambda: None)
    assert frames.decode(data_frame(1, {"none": np.zeros((0, 3))}))["none"].tolist() == []


# frames that are wrong ----------------------------------------------------------------------

GOOD = data_frame(5, {"x": 1.0, "ranges": np.arange(4.0), "raw": b"12345", "n": 1})


@given(st.integers(0, len(GOOD) - 1))
def test_a_truncated_frame_is_never_a_message(length: int) -> None:
    with pytest.raises(ValueError, match="expected"):
        frames.decode(GOOD[:length])


@given(st.integers(0, len(GOOD) - 1), st.integers(1, 255))
def test_a_damaged_frame_is_read_or_refused(place: int, change: int) -> None:
    damaged = bytearray(GOOD)
    damaged[place] ^= change
    with contextlib.suppress(ValueError):  # nothing else may be raised
        frames.decode(bytes(damaged))


@given(st.binary(max_size=80))
def test_any_bytes_are_refused_or_incomplete(data: bytes) -> None:
    if not data.startswith(b"MF"):
        with pytest.raises(ValueError, match="expected"):
            frames.decode(data)


def described(**changes: Any) -> bytes:
    text = json.dumps({"numbers": [], "arrays": [], "fields": {}, **changes}).encode()
    text += b" " * (-len(text) % 8)
    return struct.pack("<2sBBIII", b"MF", 1, 1, 5, len(text), 0) + text


@pytest.mark.parametrize(
    "changes",
    [
        {"arrays": [["x", "<f8", [2]]]},
        {"arrays": [["x", "<f8", [1 << 40]]]},
        {"arrays": [["x", "<f8", [1 << 30, 1 << 30, 1 << 30]]]},
        {"arrays": [["x", "<f8", [-1]]]},
        {"arrays": [["x", "<f8", [True]]]},
        {"arrays": [["x", "<f8", 3]]},
        {"arrays": [["x", "|O", [0]]]},
        {"arrays": [["x", "S10", [0]]]},
        {"arrays": [["x"]]},
        {"arrays": 5},
        {"numbers": ["a", "b"]},
        {"numbers": [1]},
        {"numbers": None},
        {"fields": []},
    ],
)
def test_a_description_that_does_not_fit_is_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"expected|describe|shape"):
        frames.decode(described(**changes))


def test_a_huge_length_is_refused_before_anything_is_stored() -> None:
    for text, size in ((1 << 31, 0), (0, (1 << 32) - 8), (1 << 31, 1 << 31)):
        head = struct.pack("<2sBBIII", b"MF", 1, 1, 5, text, size)
        with pytest.raises(ValueError, match="larger than"):
            frames.read_head(head)


def test_another_version_says_so() -> None:
    with pytest.raises(ValueError, match="version 2"):
        frames.read_head(struct.pack("<2sBBIII", b"MF", 2, 1, 5, 0, 0))
