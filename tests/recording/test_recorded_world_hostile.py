"""Damaged poses, names and appearances in a recording are refused with a message, or have no effect."""

import contextlib
import json
import math
import random
import struct
from pathlib import Path
from typing import Any

import pytest
import zstandard
from hypothesis import given, settings
from hypothesis import strategies as st
from recorded import drive, scene

import morse
from morse.recording.errors import RecordingError
from morse.recording.fields.poses import LOOKS, NODES, POSES, POSES_TYPE, TEXT_TYPE
from morse.recording.mcap import records
from morse.recording.mcap.reader import LARGEST, McapFile
from morse.recording.mcap.records import Message
from morse.recording.mcap.writer import McapWriter
from morse.recording.recorder import BEGINNING
from morse.recording.recording import RecordedWorld, Recording
from morse.rosmsgs.cdr import encode
from morse.rosmsgs.definitions import definition
from morse.simulation.recordings.timeline import _is_look
from tests.kit.effort import examples
from tests.kit.programs import python


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


# -- damaged and malicious files -------------------------------------------------------------------

_HEAD = records.MAGIC + records.header("ros2", "test")
#: maximum memory for reading a malicious file, bytes
_MEMORY = 2 * LARGEST + (256 << 20)


def read_all(path: Path) -> int:
    with McapFile(path) as file:
        for name in file.attachments:
            file.attachment(name)
        return sum(1 for _ in file)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("whole") / "run.mcap"
    with morse.load(scene) as sim:
        sim.step(1)
        with sim.record(path):
            drive(sim)
    return path.read_bytes()


@pytest.mark.parametrize("size", [0, 1, 7, 8, 9, 1000])
def test_random_bytes_are_no_recording(tmp_path: Path, size: int) -> None:
    path = tmp_path / "random.mcap"
    path.write_bytes(random.Random(size).randbytes(size))
    with pytest.raises(RecordingError, match=r"random\.mcap: this is not a recording"):
        read_all(path)


@settings(max_examples=examples(60))
@given(data=st.data())
def test_changed_bytes_never_crash_the_reader(
    whole: bytes, tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    path = tmp_path_factory.getbasetemp() / "changed.mcap"
    changed = bytearray(whole)
    for _ in range(data.draw(st.integers(1, 4))):
        changed[data.draw(st.integers(8, len(changed) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(changed)
    with contextlib.suppress(RecordingError):  # anything else would be a crash
        read_all(path)


def chunk(size: int, compressed: bytes, announced: int | None = None) -> bytes:
    """A chunk with a given declared size."""
    content = records.CHUNK_HEAD.pack(0, 1, size, 0) + records.text("zstd")
    content += struct.pack("<Q", len(compressed) if announced is None else announced) + compressed
    return records.record(records.CHUNK, content)


def bomb(size: int) -> bytes:
    compressor = zstandard.ZstdCompressor(level=1).compressobj()
    block = bytes(1 << 20)
    return b"".join(compressor.compress(block) for _ in range(size >> 20)) + compressor.flush()


def test_lies_about_sizes_are_told_and_cost_no_memory(tmp_path: Path) -> None:
    contents = [
        chunk(2**63, b"x"),
        chunk(LARGEST + 1, b"x"),
        chunk(10, b"x", announced=2**62),
        chunk(LARGEST, bomb(4 * LARGEST)),
        chunk(100, bomb(LARGEST)),
        chunk(10, zstandard.compress(b"short")),
        records.PREFIX.pack(records.CHUNK, 2) + b"xx",
        records.record(records.CHUNK, records.CHUNK_HEAD.pack(0, 0, 9, 0) + records.text("lz4") + struct.pack("<Q", 0)),
        records.record(records.METADATA, struct.pack("<I", 2**32 - 1)),
        records.record(records.SCHEMA, b""),
        records.record(0, b""),
        records.message(records.Message(1, 1, 1, 1, b"outside of any chunk")),
    ]
    paths = [tmp_path / f"{number}.mcap" for number in range(len(contents))]
    for path, content in zip(paths, contents, strict=True):
        path.write_bytes(_HEAD + content)
    program = (
        "import resource, sys\n"
        f"resource.setrlimit(resource.RLIMIT_AS, ({_MEMORY}, {_MEMORY}))\n"
        "from morse.recording.mcap.reader import McapFile\n"
        "from morse.recording.errors import RecordingError\n"
        "for path in sys.argv[1:]:\n"
        "    try:\n"
        "        with McapFile(path) as file:\n"
        "            print(sum(1 for _ in file))\n"
        "    except RecordingError as error:\n"
        "        print('refused:', str(error).replace(chr(10), ' '))\n"
    )
    done = python("-c", program, *paths)
    assert done.returncode == 0, done.stderr
    for path, line in zip(paths, done.stdout.splitlines(), strict=True):
        assert line.startswith("refused:"), path
        assert path.name in line


def test_a_record_that_reaches_beyond_the_end_is_where_the_file_broke_off(tmp_path: Path) -> None:
    path = tmp_path / "off.mcap"
    path.write_bytes(_HEAD + records.PREFIX.pack(records.CHUNK, 2**63) + b"abc")
    with McapFile(path) as file:
        assert not file.complete
        assert list(file) == []
