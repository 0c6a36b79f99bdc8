"""Messages between pages and simulator."""

from __future__ import annotations

import json
import math
import re
import struct
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.mathutils import Vector
from morse.viewer import page_messages as pm
from morse.viewer import view_messages as vm
from morse.viewer.live_view import title_of
from morse.viewer.protocol import (
    NotUnderstood,
    decode_page_message,
    encode_server_message,
    page_message_types,
    server_message_types,
)
from morse.viewer.snapshot import HEADER, Snapshot, pack_snapshot
from morse.viewer.typescript import typescript

if TYPE_CHECKING:
    import msgspec


def test_what_a_page_sends_is_read() -> None:
    message = decode_page_message(
        '{"type": "set_property", "request": 3, "component": "r.pose", "name": "x", "value": [1, 2]}'
    )
    assert message == pm.SetProperty(3, "r.pose", "x", [1, 2])


@pytest.mark.parametrize(
    ("frame", "complaint"),
    [
        ("", "truncated"),
        ("null", "object"),
        ("[]", "object"),
        ('{"type": "dance"}', "dance"),
        ('{"held": []}', "type"),
        ('{"type": "keys", "held": "ArrowUp"}', "array"),
        ('{"type": "keys", "held": [1]}', "str"),
        ('{"type": "step", "count": 0}', ">= 1"),
        ('{"type": "step", "count": 1000000}', "10000"),
        ('{"type": "set_speed", "factor": -1}', "> 0"),
        ('{"type": "set_speed", "factor": 1e999}', "out of range"),
        ('{"type": "set_speed", "factor": NaN}', "invalid"),
        ('{"type": "teleport", "request": 1, "node": "a", "position": [0, 0], "quaternion": [1, 0, 0, 0]}', "3"),
        ('{"type": "call_service", "request": -1, "component": "a", "service": "b"}', ">= 0"),
        ("[" * 100_000, "object"),
        (b"\x00\x01", "binary"),
    ],
)
def test_what_is_no_message_is_not_understood(frame: str | bytes, complaint: str) -> None:
    with pytest.raises(NotUnderstood, match=re.escape(complaint)):
        decode_page_message(frame)


@given(st.text() | st.binary())
def test_nothing_a_page_sends_raises_anything_else(frame: str | bytes) -> None:
    with pytest.raises(NotUnderstood):
        decode_page_message(frame)


def test_messages_are_tagged_by_their_names() -> None:
    assert json.loads(encode_server_message(vm.Seat(1, [2], 3))) == {
        "type": "seat", "driver": 1, "asking": [2], "pages": 3,
    }  # fmt: skip


def test_values_of_any_kind_can_be_told() -> None:
    data = {"a": np.float64(1.5), "b": np.arange(3), "c": Vector((1, 2, 3)), "d": object, "e": math.nan, "f": (1, None)}
    told = json.loads(encode_server_message(vm.Values("robot.pose", 1.0, data)))["data"]
    assert told["a"] == 1.5
    assert told["b"] == [0, 1, 2]
    assert told["c"] == [1.0, 2.0, 3.0]
    assert told["e"] is None
    assert told["f"] == [1, None]
    assert isinstance(told["d"], str)


def test_payload_begins_at_a_multiple_of_four() -> None:
    numbers = np.arange(14, dtype="<f4")
    for name in ("a", "ab", "abc", "abcd"):
        frame = encode_server_message(vm.Rays(component=name, payload=numbers.tobytes()))
        assert isinstance(frame, bytes)
        kind, length = struct.unpack_from("<II", frame)
        assert kind == 2
        assert length % 4 == 0
        assert json.loads(frame[8 : 8 + length])["component"] == name
        assert np.frombuffer(frame, "<f4", offset=8 + length).tolist() == numbers.tolist()


def test_newer_news_replaces_older_news_of_the_same_subject_only() -> None:
    assert vm.Values("a", 1.0, {}).subject() == vm.Values("a", 2.0, {}).subject()
    assert vm.Values("a", 1.0, {}).subject() != vm.Values("b", 1.0, {}).subject()
    assert vm.Answer(1, ok=True).subject() is None
    assert vm.Appearance("a", visible=True).lasting
    assert not vm.Answer(1, ok=True).lasting


def test_snapshot_is_header_and_little_endian_poses() -> None:
    poses = np.array([[1, 2, 3, 1, 0, 0, 0]], dtype=np.float32)
    frame = pack_snapshot(Snapshot(7, 0.5, 1, poses, "paused", math.inf, 2.0), revision=9)
    assert HEADER.unpack_from(frame) == (1, 9, 1, 0, 7.0, 0.5, math.inf, 2.0)
    assert struct.unpack_from("<7f", frame, HEADER.size) == (1, 2, 3, 1, 0, 0, 0)
    assert len(frame) == HEADER.size + 28


@pytest.mark.parametrize("struct_type", page_message_types() + server_message_types(), ids=lambda s: s.__name__)
def test_typescript_has_every_message_with_its_fields(struct_type: type[msgspec.Struct]) -> None:
    block = re.search(rf"export interface {struct_type.__name__} {{\n(.*?)\n}}", typescript(), re.DOTALL)
    assert block is not None
    names = [re.match(r"\s*(\w+)\??:", line).group(1) for line in block.group(1).splitlines()]  # type: ignore[union-attr]
    assert names == ["type", *struct_type.__struct_fields__]
    assert f'type: "{struct_type.__struct_config__.tag}";' in block.group(1)


def test_typescript_of_optional_and_nested_types() -> None:
    text = typescript()
    assert 'export interface SetSpeed {\n  type: "set_speed";\n  factor: number | null;\n}' in text
    assert "  held: string[];" in text
    assert "  robot: string | null;" in text
    assert "  components: ComponentDescription[];" in text
    assert "  payload: ArrayBuffer;" in text
    assert "  count?: number;" in text  # a page may omit fields with a default


@pytest.mark.parametrize("arguments", [[], ["--help"], ["-h"], ["one.ts", "two.ts"]])
def test_options_name_no_file_for_the_types(arguments: list[str], tmp_path: Path) -> None:
    command = [sys.executable, "-m", "morse.viewer.typescript", *arguments]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 1
    assert "usage" in run.stderr
    assert not list(tmp_path.iterdir())


# -- the title of a page is the name of the project ------------------------------------------------


@pytest.mark.parametrize(
    ("script", "environment", "title"),
    [
        ("/home/me/ranger_sim/default.py", "sandbox", "ranger_sim"),
        ("/data/examples/laser/scene.py", "indoors-1/boxes", "laser"),
        ("/home/me/ranger_sim/race.py", "sandbox", "race"),
        ("race.py", "sandbox", "race"),
        ("", "sandbox", "sandbox"),
        ("", "", "MORSE"),
    ],
)
def test_titles(script: str, environment: str, title: str) -> None:
    assert title_of(script, environment) == title
