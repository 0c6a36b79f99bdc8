"""The binary messages of Foxglove: numbers are little-endian."""

from __future__ import annotations

import struct
from typing import NamedTuple

_DATA, _TIME, _ANSWER, _ASSET = 1, 2, 3, 4
_PUBLISH, _CALL = 1, 2
_HEAD = struct.Struct("<BI")
_ASSET_HEAD = struct.Struct("<BIBI")
_CALL_HEAD = struct.Struct("<BIII")


class Published(NamedTuple):
    """A message of a channel of the client."""

    channel: int
    data: bytes


class Call(NamedTuple):
    """A call of a service."""

    service: int
    call: int
    encoding: str
    data: bytes


def parse(frame: bytes) -> Published | Call:
    """A binary message of a client.

    Raises:
        ValueError: it is not a valid message.
    """
    opcode = frame[0] if frame else None
    if opcode == _PUBLISH and len(frame) >= _HEAD.size:
        return Published(_HEAD.unpack_from(frame)[1], frame[_HEAD.size :])
    if opcode == _CALL and len(frame) >= _CALL_HEAD.size:
        _, service, call, length = _CALL_HEAD.unpack_from(frame)
        end = _CALL_HEAD.size + length
        if end <= len(frame):
            return Call(service, call, frame[_CALL_HEAD.size : end].decode("utf-8", "replace"), frame[end:])
    raise ValueError(f"{len(frame)} bytes with the opcode {opcode} are not a message of a client")


def message(subscription: int, tail: bytes) -> bytes:
    """A message of a topic.

    Args:
        subscription: id that the client has chosen.
        tail: time and data, see `morse.middleware.foxglove.datastream.FoxgloveHub.frame`.
    """
    return _HEAD.pack(_DATA, subscription) + tail


def time(stamp: int) -> bytes:
    """Simulated time, ns."""
    return bytes([_TIME]) + max(0, stamp).to_bytes(8, "little")


def answer(service: int, call: int, encoding: str, data: bytes) -> bytes:
    """The answer to a call."""
    name = encoding.encode()
    return _CALL_HEAD.pack(_ANSWER, service, call, len(name)) + name + data


def asset(request: int, error: str, data: bytes) -> bytes:
    """A file that a client has asked for; an error unless it is empty."""
    text = error.encode()
    return _ASSET_HEAD.pack(_ASSET, request, bool(text), len(text)) + text + data
