"""Recordings that were cut off, written as complete files."""

from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from recorded import drive, read_by_rosbags, scene
from rosbags.highlevel import AnyReaderError

import morse
from morse.recording.errors import RecordingError
from morse.recording.export import Rewritten, rewrite, selected
from morse.recording.mcap.reader import McapFile
from morse.recording.mcap.records import Message
from morse.recording.mcap.writer import McapWriter


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("recording") / "run.mcap"
    with morse.load(scene) as sim, sim.record(path):
        drive(sim)
    return path


def complete(source: Path, target: Path, *topics: str) -> Rewritten:
    with McapFile(source) as file:
        return rewrite(file, target, selected(file, topics))


@pytest.fixture
def cut(whole: Path, tmp_path: Path) -> Path:
    """The recording without its end, as of a process that was killed."""
    with McapFile(whole) as file:
        last = file.chunks[-1]
    path = tmp_path / "cut.mcap"
    path.write_bytes(whole.read_bytes()[: last.offset + last.size])
    return path


def test_a_cut_recording_is_completed_for_readers_that_need_an_end(whole: Path, cut: Path) -> None:
    with pytest.raises(AnyReaderError):
        read_by_rosbags(cut)
    path = cut.parent / "complete.mcap"
    complete(cut, path)
    before, after = read_by_rosbags(whole), read_by_rosbags(path)
    assert after.keys() == before.keys()
    for topic, messages in before.items():
        assert [time for time, _ in after[topic]] == [time for time, _ in messages]
    with whole.open("rb") as old, path.open("rb") as new:
        kept = {(one.name, one.media_type, one.data) for one in make_reader(new).iter_attachments()}
        assert kept == {(one.name, one.media_type, one.data) for one in make_reader(old).iter_attachments()}


def test_some_topics_make_a_smaller_file(whole: Path, tmp_path: Path) -> None:
    path = tmp_path / "some.mcap"
    complete(whole, path, "/robot/pose")
    assert set(read_by_rosbags(path)) == {"/robot/pose"}
    with pytest.raises(RecordingError, match="exists; choose another name by -o"):
        complete(whole, path)


def test_a_damaged_chunk_is_left_out(whole: Path, tmp_path: Path) -> None:
    damaged, path = tmp_path / "damaged.mcap", tmp_path / "rest.mcap"
    data = bytearray(whole.read_bytes())
    with McapFile(whole) as file:
        bad = file.chunks[0]
        good = len([message for chunk in file.chunks[1:] for message in file.messages_of(chunk)])
    data[bad.offset + bad.size - 20] ^= 0xFF
    damaged.write_bytes(data)
    assert complete(damaged, path) == Rewritten(good, damaged=1)
    with path.open("rb") as new:
        assert make_reader(new).get_summary() is not None


def test_a_picture_in_two_topics_takes_its_room_once(tmp_path: Path) -> None:
    pictures = [np.random.default_rng(seed).bytes(1 << 20) for seed in range(4)]
    path = tmp_path / "run.mcap"
    with open(path, "xb", buffering=0) as file:
        writer = McapWriter(file)
        schema = writer.schema("std_msgs/msg/UInt8MultiArray", "")
        for topic in ("/fields", "/image"):
            writer.channel(topic, schema, {})
        writer.chunk([Message(channel, n, n, n, one) for channel in (1, 2) for n, one in enumerate(pictures)])
        writer.finish()
    assert path.stat().st_size < 1.01 * sum(map(len, pictures))
    with open(path, "rb") as file:
        assert [one.data for _, _, one in make_reader(file).iter_messages(log_time_order=False)] == 2 * pictures
