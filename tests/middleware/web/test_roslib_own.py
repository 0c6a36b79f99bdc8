"""roslib.js (npm: roslib) on Node, with its default settings and with each compression; fragments by hand."""

import base64
import json
import math
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from peers import talk
from test_rosbridge import SENSORS, Client, start

from morse.rosmsgs import cdr

cbor2 = pytest.importorskip("cbor2")


__all__ = ["start"]

pytestmark = pytest.mark.long

#: where .ci/foxglove has installed the library
LIBRARY = Path(os.environ.get("MORSE_TEST_FOXGLOVE") or Path(__file__).parents[3] / ".foxglove")


@pytest.mark.peer("roslib", does="each compression, topics, services, commands")
@pytest.mark.skipif(not (LIBRARY / "node_modules/roslib").is_dir() or not shutil.which("node"), reason="no roslib.js")
def test_roslib_js(start: Callable[..., tuple[Any, int]]) -> None:
    sim, port = start(SENSORS, world="sandbox")
    seen = talk("roslib_own.mjs", sim.step, LIBRARY, port)
    for name in ("default", "png"):
        assert len(seen[name]["scan"]["ranges"]) == 1081
        assert seen[name]["odometry"]["header"]["frame_id"] == "robot/odom"
    packed = seen["cbor"]["scan"]["ranges"]
    assert packed["kind"] == "Float32Array"
    plain = seen["default"]["scan"]["ranges"]
    assert len(packed["items"]) == len(plain)
    pairs = list(zip(packed["items"], plain, strict=True))
    assert {a for a, b in pairs if b is None} <= {"Infinity", "-Infinity", "NaN"}
    assert all(a == pytest.approx(b, abs=0.05) for a, b in pairs if b is not None)
    raw = seen["cbor-raw"]["odometry"]
    odometry = cdr.decode("nav_msgs/msg/Odometry", bytes(raw["bytes"]["items"]))
    assert odometry["header"]["stamp"] == {"sec": raw["secs"], "nanosec": raw["nsecs"]}
    assert seen["image"]["data"]["kind"] == "Uint8Array"
    assert {"/robot/odometry", "/robot/scan", "/clock"} <= set(seen["topics"])
    assert "no argument fast" in str(seen["refused"])
    assert seen["speed"] == pytest.approx(0.4, abs=0.05)


def test_cbor_has_what_json_cannot_say(start: Callable[..., tuple[Any, int]]) -> None:
    sim, port = start(SENSORS)
    client = Client(sim, port)
    client.send(op="subscribe", topic="/robot/scan", compression="cbor")
    frame = None
    while not isinstance(frame, bytes):
        sim.step()
        frame = client.receive()
    message = cbor2.loads(frame)
    assert (message["op"], message["topic"]) == ("publish", "/robot/scan")
    ranges = message["msg"]["ranges"]
    assert ranges.tag == 85, "float32, little-endian (RFC 8746)"
    assert np.isinf(np.frombuffer(ranges.value, "<f4")).all(), "there is nothing to hit"


@pytest.mark.parametrize(
    "value",
    [
        0, 23, 24, 255, 256, 65_535, 65_536, 2**32 - 1, 2**32, 2**64 - 1, -1, -24, -25, -(2**63), True, False, None,
        0.1, math.inf, "", "Zürich" * 30, b"", bytes(300), [], [1, ["a"]], {}, {"a": {"b": [1.5]}},
    ],
)  # fmt: skip
def test_cbor_of_every_length(value: object) -> None:
    from morse.middleware.rosbridge.forms import encode_cbor

    assert cbor2.loads(encode_cbor(value)) == value


@pytest.mark.parametrize("kind", ["u2", "u4", "u8", "i1", "i2", "i4", "i8", "f4", "f8", "?", "u1", ">f4"])
def test_cbor_of_arrays(kind: str) -> None:
    from morse.middleware.rosbridge.forms import encode_cbor

    decoded = cbor2.loads(encode_cbor(np.array([0, 1, 1], kind)))
    if kind == "?":
        assert decoded == [False, True, True]
    elif kind == "u1":
        assert decoded == b"\0\1\1"
    else:
        assert np.frombuffer(decoded.value, "<" + kind[-2:]).tolist() == [0, 1, 1]


def test_fragments_in_both_directions(start: Callable[..., tuple[Any, int]]) -> None:
    sim, port = start(SENSORS)
    client = Client(sim, port)
    client.send(op="subscribe", topic="/robot/camera/image", fragment_size=1000, queue_length=1)
    pieces: dict[int, str] = {}
    total = 1
    while len(pieces) < total:
        sim.step()
        frame = client.receive()
        message = json.loads(frame) if frame else {}
        if message.get("op") == "fragment":
            total = message["total"]
            pieces[message["num"]] = message["data"]
            assert len(message["data"]) <= 1000
    image = json.loads("".join(pieces[number] for number in range(total)))
    assert (image["op"], len(base64.b64decode(image["msg"]["data"]))) == ("publish", 32 * 24 * 4)
    client.send(op="unsubscribe", topic="/robot/camera/image")
    call = json.dumps({"op": "call_service", "service": "/rosapi/topics", "id": "whole"})
    halves = [call[:20], call[20:]]
    for number in (1, 0):
        client.send(op="fragment", id="f", data=halves[number], num=number, total=2)
    assert client.until(op="service_response", id="whole")["result"]


@pytest.mark.parametrize(
    "operation",
    [
        {"num": 0, "total": 0, "data": "x"}, {"num": 5, "total": 2, "data": "x"}, {"num": -1, "total": 2, "data": "x"},
        {"num": 0, "total": 10**9, "data": "x"}, {"num": 0, "total": 1, "data": "{}"},
        {"num": 0, "total": 1, "data": '{"op":"fragment","num":0,"total":1,"data":"{}"}'},
        {"num": 0, "total": 1, "data": '{"op":"nothing"}'}, {"num": 0, "total": 2, "data": 7},
    ],
)  # fmt: skip
def test_fragments_that_are_none(start: Callable[..., tuple[Any, int]], operation: dict[str, Any]) -> None:
    sim, port = start()
    client = Client(sim, port)
    client.send(op="fragment", id="f", **operation)
    assert client.until(op="status")["level"] == "error"


def test_fragments_that_never_end_take_little(start: Callable[..., tuple[Any, int]]) -> None:
    from morse.middleware.rosbridge.client import MOST, Operation, Puzzle

    puzzle = Puzzle()
    refused = 0
    for number in range(200):
        try:
            assert puzzle.add(Operation("fragment", id=number, data="x" * 200_000, num=0, total=2)) is None
        except ValueError:
            refused += 1
        assert puzzle._size <= MOST
    assert refused
