"""Bottles and messages byte by byte, as the documentation of YARP has them."""

import asyncio
import struct
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.mathutils import Quaternion, Vector
from morse.plugins.yarp import wire
from morse.plugins.yarp.bottle import BottleError, Vocab, decode, encode, from_text, to_text
from morse.plugins.yarp.datastream import encode_image

#: of yarp/os/Bottle.h
INT32, INT64, FLOAT64, STRING, VOCAB, LIST = 1, 17, 10, 4, 9, 256


def ints(*numbers: int) -> bytes:
    return struct.pack(f"<{len(numbers)}i", *numbers)


def test_a_bottle_of_one_type_has_its_tag_once() -> None:
    assert encode([5, -6]) == ints(LIST | INT32, 2, 5, -6)
    assert encode([1.5]) == ints(LIST | FLOAT64, 1) + struct.pack("<d", 1.5)
    assert encode([]) == ints(LIST, 0)


def test_a_bottle_of_several_types_has_a_tag_for_each_value() -> None:
    wanted = ints(LIST, 4, INT32, 1, FLOAT64) + struct.pack("<d", 0.25) + ints(STRING, 3) + b"abc"
    wanted += ints(LIST | FLOAT64, 2) + struct.pack("<2d", 1.0, 2.0)
    assert encode([1, 0.25, "abc", np.array([1.0, 2.0])]) == wanted


def test_values_of_components_have_a_form() -> None:
    values = decode(encode([True, {"a": 1, "b": [2.0]}, Vector((1, 2, 3)), None, 2**40, Quaternion((1, 0, 0, 0))]))
    assert values == [
        1,
        [["a", 1], ["b", [2.0]]],
        [1.0, 2.0, 3.0],
        Vocab("null"),
        2**40,
        [["x", 0.0], ["y", 0.0], ["z", 0.0], ["w", 1.0]],
    ]


def test_what_has_no_form_is_refused() -> None:
    endless: list[Any] = []
    endless.append(endless)
    for value in (endless, 2**64, object()):
        with pytest.raises(BottleError):
            encode([value])


def test_words_are_booleans_or_vocabularies() -> None:
    data = ints(LIST, 3, VOCAB) + b"1\0\0\0" + ints(VOCAB, 0, VOCAB) + b"add\0"
    assert decode(data) == [True, False, Vocab("add")]


@given(st.binary(max_size=80))
def test_any_data_are_a_bottle_or_refused(data: bytes) -> None:
    try:
        values = decode(data)
    except BottleError:
        return
    assert isinstance(values, list)


@pytest.mark.parametrize(
    "data",
    [
        ints(LIST, 2**31 - 1),
        ints(LIST | INT32, 2**30, 1),
        ints(LIST, 1, STRING, -1),
        ints(LIST, 1, STRING, 2**31 - 1) + b"x",
        ints(LIST, 1, 77, 1),
        ints(*[LIST, 1] * 60),
        ints(LIST, 0, 0),
    ],
)
def test_lengths_that_lie_are_refused(data: bytes) -> None:
    with pytest.raises(BottleError):
        decode(data)


VALUES = st.recursive(
    st.integers(-(2**63), 2**63 - 1) | st.floats(allow_nan=False) | st.text(max_size=8) | st.booleans(),
    lambda inner: st.lists(inner, max_size=4),
    max_leaves=12,
)


@given(st.lists(VALUES, max_size=6))
def test_a_text_has_the_values_of_the_bottle(values: list[Any]) -> None:
    assert from_text(to_text(values)) == values


def test_the_text_of_a_bottle_is_that_of_yarp() -> None:
    assert to_text([1, 2.5, "hello world", "x", Vocab("add"), ["a", 1], True]) == (
        '1 2.5 "hello world" x [add] (a 1) true'
    )
    assert from_text('[list] [out] "/reader" 0x10 .5 -inf, a_b\\ ') == [
        Vocab("list"), Vocab("out"), "/reader", 16, 0.5, -float("inf"), "a_b\\",
    ]  # fmt: skip
    for wrong in ('"open', "(1 2", "1)", "(" * 60 + ")" * 60, "{300}"):
        with pytest.raises(BottleError):
            from_text(wrong)


def test_headers_are_those_of_the_documentation() -> None:
    assert wire.header("tcp", "/a") == b"YA\xe4\x1e\0\0RP" + ints(3) + b"/a\0"
    assert wire.header("fast_tcp", "/a")[:8] == b"YA\x64\x1e\0\0RP"
    assert wire.carrier_of(b"YA\xe4\x1e\0\0RP") == "tcp"
    assert wire.carrier_of(b"YA\x64\x1e\0\0RP") == "fast_tcp"
    assert wire.carrier_of(b"CONNECT ") == "text"
    for other, name in ((b"YA\x61\x1e\0\0RP", "udp"), (b"YA\x62\x1e\0\0RP", "mcast"), (b"GET / HT", "number")):
        with pytest.raises(wire.WireError, match=name):
            wire.carrier_of(other)


def test_a_message_is_read_as_it_was_written() -> None:
    data = encode(["go", 1.5])
    written = b"".join(wire.message("D", data))
    # length of the index; two blocks of data, one of a reply; their lengths; the command
    assert written.startswith(b"YA\x0a\0\0\0RP\x02\x01" + b"\xff" * 8 + ints(8, len(data), 0) + b"\0\0\0\0~D\0\1")

    async def reading(stream: bytes, largest: int) -> wire.Arrived:
        reader = asyncio.StreamReader()
        reader.feed_data(stream)
        reader.feed_eof()
        return await wire.read_message(reader, largest)

    def read(stream: bytes, largest: int = 1000) -> wire.Arrived:
        # in a thread: tests of the page leave an event loop running in the main thread
        with ThreadPoolExecutor(1) as pool:
            return pool.submit(asyncio.run, reading(stream, largest)).result()

    assert read(written) == wire.Arrived("D", data)
    with_envelope = b"YA\x0a\0\0\0RP\x02\x01" + b"\xff" * 8 + ints(18, len(data), 0) + ints(10) + b"~\0\0\1D 12 0.5\0\0"
    assert read(with_envelope + data).command == "D"
    for wrong in (written.replace(b"YA\x0a", b"YA\x0b"), written.replace(ints(8, len(data)), ints(-8, len(data)))):
        with pytest.raises(wire.WireError):
            read(wrong)
    with pytest.raises(wire.WireError, match="expected 8 to 10"):
        read(written, 10)


def test_an_image_has_the_header_of_yarp_and_padded_rows() -> None:
    pixels = np.arange(2 * 3 * 4, dtype=np.uint8).reshape(2, 3, 4)
    data = encode_image(pixels, "rgba8")
    name, kind, form, stored = decode(data)
    assert (name, kind) == (Vocab("mat"), Vocab("rgba"))
    # size of a pixel, of the image, padding, width, height
    assert form == [4, 32, 8, 3, 2]
    rows = np.frombuffer(stored, np.uint8).reshape(2, 16)
    assert np.array_equal(rows[:, :12].reshape(pixels.shape), pixels)
    depths = encode_image(np.ones((2, 4), np.float32), "32FC1")
    assert decode(depths)[1] == Vocab("dec")
    assert decode(depths)[2][:2] == [4, 32]
