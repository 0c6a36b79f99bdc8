"""Recordings whose chunks contain zeros, and recordings in the place of a scene: both are refused at once."""

from pathlib import Path

import pytest

from morse.cli.messages import CommandError
from morse.cli.scenes import resolve
from morse.recording.errors import RecordingError
from morse.recording.mcap import records
from morse.recording.mcap.reader import McapFile


def _file(path: Path, content: bytes) -> Path:
    begin = records.MAGIC + records.header("", "")
    path.write_bytes(begin + records.chunk_head(0, 1, len(content), "", len(content)) + content)
    return path


def test_zeros_are_no_records(tmp_path: Path) -> None:
    file = _file(tmp_path / "zeros.mcap", bytes(9 << 10))
    with McapFile(file) as recording, pytest.raises(RecordingError, match="opcode 0"):
        next(iter(recording))


def test_a_recording_is_not_a_scene(tmp_path: Path) -> None:
    file = _file(tmp_path / "run.mcap", b"")
    with pytest.raises(CommandError, match="morse replay"):
        resolve([str(file)])
