"""However a recording ends, the data written before can be read."""

import contextlib
import logging
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from recorded import SCRIPT, drive, read_by_rosbags, scene
from rosbags.highlevel import AnyReaderError

import morse
from morse.recording.disk import Disk
from morse.recording.errors import RecordingError
from morse.recording.export import Rewritten, rewrite, selected
from morse.recording.mcap.reader import McapFile
from morse.recording.mcap.records import Message
from morse.recording.mcap.writer import McapWriter, Messages

_LIMIT = 100.0

_RUN_FOR_EVER = """
import sys, morse
with morse.load(sys.argv[1]) as sim:
    sim.record(sys.argv[2])
    sim.run(speed=1.0)
"""
_FILE_SIZE = """
import resource, sys, morse
resource.setrlimit(resource.RLIMIT_FSIZE, (12_000_000, 12_000_000))
with morse.load(sys.argv[1]) as sim:
    recorder = sim.record(sys.argv[2])
    while recorder.running and sim.ticks < 500_000:
        sim.step(100)
    ended = sim.ticks
    sim.step(100)
    print(ended, sim.ticks, recorder.error)
"""


def clocks(path: Path) -> list[int]:
    """The ticks whose time is in a file."""
    with contextlib.suppress(RecordingError, FileNotFoundError), McapFile(path) as file:
        numbers = [c.number for c in file.channels.values() if c.topic == "/clock"]
        return [one.sequence for one in file.messages(numbers)]
    return []


def test_what_is_a_second_old_survives_kill_9(tmp_path: Path) -> None:
    script, path = tmp_path / "scene.py", tmp_path / "run.mcap"
    script.write_text(SCRIPT)
    child = subprocess.Popen([sys.executable, "-c", _RUN_FOR_EVER, script, path])
    try:
        until = time.monotonic() + _LIMIT
        while len(clocks(path)) < 60:
            assert child.poll() is None
            assert time.monotonic() < until, "nothing reaches the disk while the simulation runs"
            time.sleep(0.05)
    finally:
        child.send_signal(signal.SIGKILL)
        child.wait()
    ticks = clocks(path)
    assert len(ticks) >= 60
    assert ticks == list(range(1, len(ticks) + 1))
    with McapFile(path) as file:
        assert not file.complete
        assert file.metadata["morse"]["seed"] == "0"
        assert file.attachment("scene.py") == SCRIPT.encode()
    found = 0
    with path.open("rb") as stream, contextlib.suppress(McapError):
        for one in StreamReader(stream, validate_crcs=True).records:
            found += type(one).__name__ == "Message"
    assert found > len(ticks)


def test_a_file_that_breaks_off_anywhere_opens(tmp_path: Path) -> None:
    whole, part = tmp_path / "whole.mcap", tmp_path / "part.mcap"
    with morse.load(scene) as sim, sim.record(whole):
        drive(sim)
    data, before = whole.read_bytes(), 0
    for size in range(64, len(data), len(data) // 97):
        part.write_bytes(data[:size])
        with McapFile(part) as file:
            count = sum(1 for _ in file)
        assert count >= before  # no complete data are lost
        before = count
    assert before > 100


def test_a_full_disk_ends_the_recording_and_not_the_run(tmp_path: Path) -> None:
    script, path = tmp_path / "scene.py", tmp_path / "run.mcap"
    script.write_text(SCRIPT)
    done = subprocess.run(
        [sys.executable, "-c", _FILE_SIZE, script, path], capture_output=True, text=True, timeout=_LIMIT, check=True
    )
    ended, last, *error = done.stdout.strip().splitlines()[-1].split(maxsplit=2)
    assert 0 < int(ended) < int(last) == int(ended) + 100
    assert "File too large" in error[0]
    assert str(path) in error[0]
    assert path.stat().st_size <= 12_000_000
    # a fast machine writes many ticks at once: the number of ticks written before the end depends on the machine
    written = clocks(path)
    assert written
    assert written == list(range(1, len(written) + 1))
    # the end of the data in the file, not the time at which the error was seen
    with McapFile(path) as file:
        assert f"up to {max(one.log_time for one in file) / 1e9:.3f} s" in error[0]


def test_a_device_without_room_ends_the_recording(caplog: pytest.LogCaptureFixture) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("this system has no /dev/full")
    with morse.load(scene) as sim, pytest.raises(RecordingError, match="No space left"):
        sim.record("/dev/full")
    with morse.load(scene) as sim:
        sim.step()


def test_the_run_goes_on_when_the_disk_fails_meanwhile(tmp_path: Path) -> None:
    lines: list[str] = []
    listener = logging.Handler()
    listener.emit = lambda record: lines.append(record.getMessage())  # type: ignore[method-assign]
    with morse.load(scene) as sim:
        recorder = sim.record(tmp_path / "run.mcap")
        sim.step(10)
        recorder._disk.error = OSError(28, "No space left on device")
        logging.getLogger("morse").addHandler(listener)
        try:
            sim.step(10)
        finally:
            logging.getLogger("morse").removeHandler(listener)
        assert not recorder.running
        assert sim.recorders == []
        assert sim.ticks == 20
    (line,) = [line for line in lines if "No space left" in line]
    assert "The simulation continues" in line
    assert "the recording" in line


class _SlowFile:
    """Takes a while for each write."""

    def __init__(self, path: Path) -> None:
        self._file = path.open("wb", buffering=0)

    def write(self, data: memoryview) -> int | None:
        time.sleep(0.005)
        return self._file.write(data[: 1 << 20])

    def __getattr__(self, name: str) -> object:
        return getattr(self._file, name)


def test_a_slow_disk_makes_the_giver_wait_and_loses_nothing(tmp_path: Path) -> None:
    path = tmp_path / "slow.mcap"
    disk = Disk(_SlowFile(path))  # type: ignore[arg-type]
    disk.other(lambda file: file.channel("/a", file.schema("std_msgs/msg/String", "string data"), {}))
    noise = random.Random(0).randbytes(1 << 20)
    waiting: list[Messages] = []

    class Source:
        complete = 0

        def take(self, until: int | None) -> list[Messages]:
            some = waiting[:]
            del waiting[: len(some)]
            return some

    disk.begin(Source())
    for number in range(150):
        waiting.append(Messages(1, np.full((1, 3), number), [noise]))
        disk.pass_on(len(noise), number)
    disk.close()
    assert disk.waits > 0
    with McapFile(path) as file:
        assert [one.sequence for one in file] == list(range(150))
        assert file.complete


def test_the_end_of_the_simulation_ends_the_recording(tmp_path: Path) -> None:
    with morse.load(scene) as sim:
        sim.record(tmp_path / "run.mcap")
        sim.step(5)
        wanted = sim.state_hash()
    with McapFile(tmp_path / "run.mcap") as file:
        assert file.complete
        assert file.metadata["morse end"]["tick"] == "5"
        assert file.metadata["morse end"]["state"] == wanted
    assert len(read_by_rosbags(tmp_path / "run.mcap")["/clock"]) == 5


# -- recordings that were cut off, written as complete files ---------------------------------------


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
