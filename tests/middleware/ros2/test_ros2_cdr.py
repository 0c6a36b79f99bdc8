"""Encoded messages, compared with the definitions and the decoder of the rosbags package."""

import contextlib
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morse.rosmsgs.cdr import CdrError, decode, encode
from morse.rosmsgs.definitions import PRIMITIVES, SEQUENCE, SINGLE, fields_of, messages
from tests.kit.effort import examples

typesys = pytest.importorskip("rosbags.typesys", reason="rosbags is not installed: pip install rosbags")
STORE: Any = typesys.get_typestore(typesys.Stores.ROS2_JAZZY)
SIZES = {"b": 8, "h": 16, "i": 32, "q": 64}


def numbers(type_name: str) -> st.SearchStrategy[Any]:
    letter = PRIMITIVES[type_name]
    if letter == "?":
        return st.booleans()
    if letter in "fd":
        return st.floats(width=32 if letter == "f" else 64)
    bits = SIZES[letter.lower()]
    return st.integers(0, 2**bits - 1) if letter.isupper() else st.integers(-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def values(type_name: str, size: int) -> st.SearchStrategy[Any]:
    if size != SINGLE:
        length = {"min_size": size, "max_size": size} if size != SEQUENCE else {"max_size": 4}
        if type_name in PRIMITIVES:
            dtype = np.dtype(PRIMITIVES[type_name])
            return st.lists(numbers(type_name), **length).map(lambda v: np.array(v, dtype=dtype))
        return st.lists(values(type_name, SINGLE), **length)
    if type_name == "string":
        return st.text(st.characters(exclude_characters="\0", exclude_categories=("Cs",)), max_size=9)
    if type_name in PRIMITIVES:
        return numbers(type_name)
    return st.fixed_dictionaries({f.name: values(f.type, f.size) for f in fields_of(type_name)})


#: the store has no vision_msgs
NAMES = sorted(name for name in messages() if name in STORE.fielddefs)


def message_of(draw: st.DataObject) -> tuple[str, dict[str, Any]]:
    name = draw.draw(st.sampled_from(NAMES))
    return name, draw.draw(values(name, SINGLE))


def as_plain(value: Any) -> Any:
    """Messages decoded by rosbags, as dictionaries."""
    if hasattr(value, "__dataclass_fields__"):
        fields = [name for name in value.__dataclass_fields__ if name == name.lower() and name[0] != "_"]
        return {name: as_plain(getattr(value, name)) for name in fields}
    return [as_plain(v) for v in value] if isinstance(value, list) else value


def assert_same(a: Any, b: Any) -> None:
    if isinstance(a, dict):
        assert a.keys() == b.keys()
        for key in a:
            assert_same(a[key], b[key])
    elif isinstance(a, list):
        assert len(a) == len(b)
        for one, other in zip(a, b, strict=True):
            assert_same(one, other)
    elif isinstance(a, (float, np.ndarray)):
        np.testing.assert_array_equal(a, b)
    elif isinstance(a, int) and a < 0 <= b:  # rosbags reads an octet of the type `byte` with a sign
        assert a + 256 == b
    else:
        assert a == b


@pytest.mark.parametrize("name", NAMES)
def test_fields_are_those_of_the_definition(name: str) -> None:
    theirs = []
    for field, (node, what) in STORE.fielddefs[name][1]:
        inner, size = (what, SINGLE) if node.name in ("BASE", "NAME") else (what[0][1], what[1])
        word = inner if isinstance(inner, str) else inner[0]
        # old words for bytes
        theirs.append((field, "uint8" if word in ("char", "byte") else word, size))
    assert [(field.name, field.type, field.size) for field in fields_of(name)] == theirs


@given(st.data())
@settings(max_examples=examples(150), deadline=None)
def test_others_read_what_we_write(data: st.DataObject) -> None:
    name, message = message_of(data)
    assert_same(as_plain(STORE.deserialize_cdr(encode(name, message), name)), message)


@given(st.data(), st.booleans())
@settings(max_examples=examples(150), deadline=None)
def test_we_read_what_others_write(data: st.DataObject, little: bool) -> None:
    name, message = message_of(data)
    theirs = STORE.deserialize_cdr(encode(name, message), name)
    assert_same(decode(name, bytes(STORE.serialize_cdr(theirs, name, little_endian=little))), message)


@given(st.sampled_from(NAMES), st.binary(max_size=200), st.booleans())
@settings(max_examples=examples(300), deadline=None)
def test_garbage_is_refused_or_read_but_nothing_else(name: str, garbage: bytes, header: bool) -> None:
    with contextlib.suppress(CdrError):
        decode(name, b"\x00\x01\x00\x00" + garbage if header else garbage)


def test_a_huge_length_is_refused_at_once() -> None:
    with pytest.raises(CdrError, match="too few"):
        decode("tf2_msgs/msg/TFMessage", b"\x00\x01\x00\x00\xff\xff\xff\xff")
    with pytest.raises(CdrError, match="too few"):
        decode("sensor_msgs/msg/JointState", b"\x00\x01\x00\x00" + bytes(16) + b"\xff\xff\xff\xff")


def test_half_a_message_is_refused() -> None:
    whole = encode("geometry_msgs/msg/Twist", {"linear": {"x": 1.0}})
    for length in range(len(whole)):
        with pytest.raises(CdrError):
            decode("geometry_msgs/msg/Twist", whole[:length])


def test_what_a_message_lacks_has_its_default() -> None:
    assert decode("geometry_msgs/msg/Pose", encode("geometry_msgs/msg/Pose", {}))["orientation"]["w"] == 1.0
    assert decode("sensor_msgs/msg/NavSatStatus", encode("sensor_msgs/msg/NavSatStatus", {}))["status"] == -2


def test_unknown_fields_are_refused() -> None:
    with pytest.raises(ValueError, match="yaw"):
        encode("geometry_msgs/msg/Point", {"yaw": 1.0})


TF = "tf2_msgs/msg/TFMessage"
STAMPED = {
    "nav_msgs/msg/Odometry": 85,
    "geometry_msgs/msg/TransformStamped": 7,
    "geometry_msgs/msg/PoseStamped": 7,
    "geometry_msgs/msg/TwistStamped": 6,
    "sensor_msgs/msg/Temperature": 2,
}


@pytest.mark.parametrize("name", STAMPED)
@given(data=st.data())
def test_stamped_messages_have_the_bytes_of_the_library(name: str, data: st.DataObject) -> None:
    numbers = st.lists(st.floats(allow_nan=False), min_size=STAMPED[name], max_size=STAMPED[name])
    given_numbers = data.draw(numbers)
    text = st.text(st.characters(exclude_characters="\0", exclude_categories=("Cs",)), max_size=20)
    frame, child = data.draw(text), data.draw(text)
    stamp = data.draw(st.integers(0, 2**31 * 10**9 - 1))
    left = iter(given_numbers)
    message = _filled(name, left)
    message["header"] = {"stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9}, "frame_id": frame}
    if "child_frame_id" in message:
        message["child_frame_id"] = child
    packed = encode(name, message)
    theirs = STORE.deserialize_cdr(packed, name)
    assert (theirs.header.frame_id, theirs.header.stamp.sec) == (frame, stamp // 10**9)
    assert theirs.header.stamp.nanosec == stamp % 10**9
    assert getattr(theirs, "child_frame_id", child) == child
    assert bytes(STORE.serialize_cdr(theirs, name)) == packed
    assert [one for one in _flat(as_plain(theirs)) if not isinstance(one, str)] == given_numbers
    assert encode(name, decode(name, packed)) == packed
    # the same message anywhere in another one: its offset, and so its padding, differs
    frames = {"transforms": [{"child_frame_id": "x" * size} for size in range(4)]}
    assert bytes(STORE.serialize_cdr(STORE.deserialize_cdr(encode(TF, frames), TF), TF)) == encode(TF, frames)


def _filled(name: str, numbers: Any) -> dict[str, Any]:
    """A message with numbers in all of its fields, in their order."""
    empty = decode(name, encode(name, {}))

    def fill(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: inner if key == "header" else fill(inner) for key, inner in value.items()}
        if isinstance(value, np.ndarray):
            return [next(numbers) for _ in value]
        return value if isinstance(value, str) else next(numbers)

    return dict(fill(empty))


def _flat(value: dict[str, Any]) -> Any:
    for name, inner in value.items():
        if isinstance(inner, dict):
            yield from _flat(inner) if name != "header" else ()
        elif isinstance(inner, (list, np.ndarray)):
            yield from inner
        else:
            yield inner


@pytest.mark.parametrize("count", [35, 37])
def test_a_wrong_number_of_numbers_is_refused(count: int) -> None:
    with pytest.raises(ValueError, match="has 36 items"):
        encode("nav_msgs/msg/Odometry", {"pose": {"covariance": [0.0] * count}})
