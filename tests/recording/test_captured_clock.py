"""Simulated time is stored in the tick also if odometry moves the frames; frames are recorded in each tick."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from morse.launch.load import load
from morse.recording import keeping, motion
from morse.recording.captures.capture import Capture
from morse.recording.mcap.reader import McapFile
from morse.recording.recording import Recording
from morse.verification.resimulation import resimulate

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

SCRIPT = """
from morse.builder import *

robot = ATRV()
motion, odometry, pose = MotionVW(), Odometry(), Pose()
odometry.translate(0.2, 0.1, 0.0)
for part in (motion, odometry, pose):
    robot.append(part)
env = Environment("empty", fastmode=True)
env.configure_stream_manager("ros2", tf_rate=10)
"""


@pytest.fixture
def record(tmp_path: Path) -> Callable[[str], dict[str, list[tuple[int, int, bytes]]]]:
    """Record a run; its messages by topic, without those of the log, which name the file."""
    script = tmp_path / "scene.py"
    script.write_text(SCRIPT)

    def recorded(name: str) -> dict[str, list[tuple[int, int, bytes]]]:
        path = tmp_path / name
        with load(script) as sim, sim.record(path):
            sim.robot.motion.publish({"v": 0.5, "w": 0.3})
            sim.step(30)
        found: dict[str, list[tuple[int, int, bytes]]] = {}
        with McapFile(path) as file:
            for one in file:
                found.setdefault(file.channels[one.channel].topic, []).append((one.sequence, one.log_time, one.data))
        found.pop("/rosout", None)
        return found

    return recorded


def test_messages_are_those_of_the_streams(
    record: Callable[[str], dict[str, list[tuple[int, int, bytes]]]], monkeypatch: pytest.MonkeyPatch
) -> None:
    kept: list[str] = []
    encode = Capture.encode

    def counted(self: Capture, batch: object, begins: object, *rest: object) -> None:
        kept.extend([type(self).__name__] * len(begins))  # type: ignore[arg-type]
        encode(self, batch, begins, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(Capture, "encode", counted)
    found = record("kept.mcap")
    assert kept.count("FramesCapture") > 20
    monkeypatch.setattr(keeping, "records", lambda: None)
    monkeypatch.setattr(motion, "records", lambda: None)
    assert found == record("plain.mcap")
    for topic in ("/clock", "/tf", "/robot/odometry", "/robot/pose"):
        assert [tick for tick, *_ in found[topic]] == list(range(1, 31)), topic


def test_a_scene_with_few_frames_is_simulated_again(
    record: Callable[[str], dict[str, list[tuple[int, int, bytes]]]], tmp_path: Path
) -> None:
    record("run.mcap")
    with Recording(tmp_path / "run.mcap") as recording:
        assert resimulate(recording, told=lambda _: None).departure is None
