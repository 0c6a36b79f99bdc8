"""Damaged poses, names and appearances in a recording are refused with a message, or have no effect."""

import json
import math
from pathlib import Path
from typing import Any

import pytest

from morse.recording.errors import RecordingError
from morse.recording.fields.poses import LOOKS, NODES, POSES, POSES_TYPE, TEXT_TYPE
from morse.recording.mcap.records import Message
from morse.recording.mcap.writer import McapWriter
from morse.recording.recorder import BEGINNING
from morse.recording.recording import RecordedWorld, Recording
from morse.rosmsgs.cdr import encode
from morse.rosmsgs.definitions import definition
from morse.simulation.recordings.timeline import _is_look


def poses(*places: tuple[float, float, float], frame: str = "map") -> bytes:
    every = [{"position": dict(zip("xyz", place, strict=True))} for place in places]
    return encode(POSES_TYPE, {"header": {"frame_id": frame}, "poses": every})


def text(content: Any) -> bytes:
    return encode(TEXT_TYPE, {"data": content if isinstance(content, str) else json.dumps(content)})


def world(path: Path, names: bytes, poses: bytes, looks: bytes | None = None) -> RecordedWorld:
    """Of a recording of one tick."""
    with open(path, "wb", buffering=0) as file:
        writer = McapWriter(file)
        writer.metadata(BEGINNING, {"tick": "0", "seed": "0"})
        messages = []
        for topic, kind, data in ((NODES, TEXT_TYPE, names), (LOOKS, TEXT_TYPE, looks), (POSES, POSES_TYPE, poses)):
            channel = writer.channel(topic, writer.schema(kind, definition(kind)), {})
            if data is not None:
                messages.append(Message(channel, 1, 10, 10, data))
        writer.chunk(messages)
        writer.finish()
    return RecordedWorld(Recording(path))


def test_what_is_whole_is_read(tmp_path: Path) -> None:
    found = world(tmp_path / "a.mcap", text(["a", "b"]), poses((1.0, 2.0, 3.0), (4.0, 5.0, 6.0)), text([{"name": "a"}]))
    assert found.at(9) is None
    moment = found.at(10)
    assert moment is not None
    assert moment.names == ("a", "b")
    assert moment.poses.tolist() == [[1, 2, 3, 1, 0, 0, 0], [4, 5, 6, 1, 0, 0, 0]]
    assert found.looks(-1, 10) == [{"name": "a"}]
    assert found.looks(10, 20) == []


@pytest.mark.parametrize(
    "data",
    [
        poses(),
        poses((1.0, 2.0, 3.0)),
        poses((1.0, 2.0, math.nan), (4.0, 5.0, 6.0)),
        poses((1.0, 2.0, 3.0), (4.0, 5.0, math.inf)),
        poses((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))[:-1],
        poses((1.0, 2.0, 3.0), (4.0, 5.0, 6.0), frame="a longer name of a frame"),
        b"",
    ],
)
def test_damaged_poses_are_refused(tmp_path: Path, data: bytes) -> None:
    found = world(tmp_path / "a.mcap", text(["a", "b"]), data)
    with pytest.raises(RecordingError, match="poses of tick 1 are damaged"):
        found.at(10)


@pytest.mark.parametrize(
    "names", [b"", b"\0", text("{"), text({"a": 1}), text([1, 2]), text(["a" * 5000]), text("[" * 9999)]
)
def test_damaged_names_are_refused(tmp_path: Path, names: bytes) -> None:
    with pytest.raises(RecordingError, match="damaged"):
        world(tmp_path / "a.mcap", names, poses((1.0, 2.0, 3.0)))


FINE = {"name": "a", "visible": True, "color": [1.0, 0.5, 0.0, 1.0], "light": None}


@pytest.mark.parametrize(
    "change",
    [
        {"name": 3}, {"name": None}, {"visible": 1}, {"visible": None}, {"color": [1.0]}, {"color": "red"},
        {"color": [1.0, 2.0, "x"]}, {"color": [math.nan] * 3}, {"light": 5}, {"light": {}},
        {"light": {"color": [1.0, 1.0, 1.0], "energy": math.inf, "distance": 1.0, "spot_size": 1.0}},
    ],
)  # fmt: skip
def test_damaged_appearances_have_no_effect(change: dict[str, Any]) -> None:
    assert _is_look(FINE)
    assert not _is_look({**FINE, **change})
    assert not _is_look([])
