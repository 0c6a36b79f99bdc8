"""Recordings and saved states that ask for much more work than their size suggests."""

import base64
import json
import struct

import msgspec
import zstandard
from hostile_meshes import Maker, late

from morse.recording.inputs import TOPIC as INPUTS
from morse.recording.inputs import TYPE
from morse.recording.made.writing import TOPIC as MADE
from morse.recording.mcap import records
from morse.recording.recorder import BEGINNING, FORMAT, PRESENT
from morse.rosmsgs.cdr import encode

_EXACT = base64.b64encode(b"x").decode()
_INPUT = json.dumps({"tick": 1, "kind": "command", "name": "a", "content": "", "exact": _EXACT})
_NAMES = json.dumps({"name": "a", "description": "d", "position": [0, 0, 0], "rotation": [0, 0, 0], "input": 1})


def _chunk(plain: bytes, packed: bytes) -> bytes:
    return records.chunk_head(0, 1, len(plain), "zstd", len(packed)) + packed


def _file(*parts: bytes) -> bytes:
    facts = {FORMAT: str(PRESENT), "seed": "1", "tick": "0"}
    metadata = records.record(records.METADATA, records.text(BEGINNING) + records.table(facts))
    return records.MAGIC + records.header("", "morse") + metadata + b"".join(parts)


def _messages(topic: str, text: str, count: int, chunks: int) -> bytes:
    one = records.message(records.Message(1, 1, 1, 1, encode(TYPE, {"data": text})))
    plain = one * count
    chunk = _chunk(plain, zstandard.compress(plain))
    head = records.schema(1, TYPE, "ros2msg", b"string data") + records.channel(1, 1, topic, "cdr", {})
    return _file(head, *[chunk] * chunks)


def _records(opcode: int, size: int, count: int, chunks: int) -> bytes:
    plain = records.record(opcode, bytes(size)) * count
    return _file(*[_chunk(plain, zstandard.compress(plain))] * chunks)


def _attachments(count: int, size: int, messages: int) -> bytes:
    packed = zstandard.compress(bytes(size))
    parts = [
        records.record(
            records.ATTACHMENT,
            struct.pack("<QQ", 0, 0)
            + records.text(f"d{i}")
            + records.text("")
            + struct.pack("<Q", len(packed))
            + packed,
        )
        for i in range(count)
    ]
    text = _NAMES.replace('"d"', '"d0"')
    one = records.message(records.Message(1, 1, 1, 1, encode(TYPE, {"data": text})))
    plain = one * messages
    head = records.schema(1, TYPE, "ros2msg", b"") + records.channel(1, 1, MADE, "cdr", {})
    return _file(head, *parts, _chunk(plain, zstandard.compress(plain)))


def _state(value: bytes) -> bytes:
    return b"MORSE state 1\n" + b"\x81\xa5clock" + value


RECORDINGS: dict[str, Maker] = {
    "recording: 20,000,000 inputs": late(".mcap", lambda: _messages(INPUTS, _INPUT, 1_000_000, 20)),
    "recording: 20,000,000 messages": late(".mcap", lambda: _messages("/rosout", "", 1_000_000, 20)),
    "recording: 20,000,000 ticks": late(".mcap", lambda: _messages("/clock", "", 1_000_000, 20)),
    "recording: 200,000,000 empty records": late(".mcap", lambda: _records(0x7F, 0, 20_000_000, 10)),
    "recording: 5 GB of zeros": late(".mcap", lambda: _records(0x7F, 250_000_000, 1, 20)),
    "recording: a chunk of 2 GB": late(".mcap", lambda: _file(
        records.chunk_head(0, 1, 2 << 30, "zstd", 100) + zstandard.compress(bytes(1 << 20))[:100])),
    "recording: chunks that are cut off": late(".mcap", lambda: _messages("/clock", "", 1000, 5)[:-7]),
    "recording: 40 descriptions of 250 MB": late(".mcap", lambda: _attachments(40, 250_000_000, 100_000)),
    "recording: one description, 500,000 times": late(".mcap", lambda: _attachments(1, 30_000_000, 100_000)),
    "recording: tables of 100 MB": late(".mcap", lambda: _file(*[records.record(
        records.METADATA, records.text(f"m{i}") + records.table({"k": "x" * 10_000_000}))for i in range(10)])),
    "state: nested lists": late(".state", lambda: _state(b"\x91" * 3_000_000 + b"\x00")),
    "state: 4,000,000,000 items": late(".state", lambda: _state(b"\xdd\xff\xff\xff\xff" + b"\x00" * 100)),
    "state: nested long lists": late(".state", lambda: _state(b"\xdd\xff\xff\xff\xf0" * 1000)),
    "state: 4 GB of bytes": late(".state", lambda: _state(b"\xc6\xff\xff\xff\xff" + b"\x00" * 100)),
    "state: keys that are lists": late(".state", lambda: _state(b"\x81\x91\x01\x01")),
    "state: cut off": late(".state", lambda: _state(b"\x82\xa1a\x01")),
    "state: 10,000,000 numbers": late(".state", lambda: _state(msgspec.msgpack.encode([0] * 10_000_000))),
    "state: another file": late(".state", lambda: b"MORSE state 9\n"),
}  # fmt: skip
