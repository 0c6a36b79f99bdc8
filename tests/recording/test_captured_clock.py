"""Time and frames are stored in the tick: time also if odometry moves the frames, and the frames of wheels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from morse.launch.load import load
from morse.recording import keeping, motion
from morse.recording.captures import FramesCapture
from morse.recording.captures.capture import Capture
from morse.recording.mcap.reader import McapFile
from morse.recording.recording import Recording
from morse.verification.resimulation import resimulate

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

ODOMETRY = """
from morse.builder import *

robot = ATRV()
motion, odometry, pose = MotionVW(), Odometry(), Pose()
odometry.translate(0.2, 0.1, 0.0)
for part in (motion, odometry, pose):
    robot.append(part)
env = Environment("empty", fastmode=True)
env.configure_stream_manager("ros2", tf_rate=10)
"""
WHEELS = """
from morse.builder import *

robot = SegwayRMP400()
robot.translate(0.3, -0.2, 0.1)
motion, pose = MotionVWDiff(), Pose()
for part in (motion, pose):
    robot.append(part)
env = Environment("empty", fastmode=True)
"""
TOPICS = {ODOMETRY: ("/clock", "/tf", "/robot/odometry", "/robot/pose"), WHEELS: ("/clock", "/tf", "/robot/pose")}


@pytest.fixture(params=[ODOMETRY, WHEELS], ids=["odometry", "wheels"])
def scene(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def record(scene: str, tmp_path: Path) -> Callable[[str], dict[str, list[tuple[int, int, bytes]]]]:
    """Record a run; its messages by topic, without those of the log, which name the file."""
    script = tmp_path / "scene.py"
    script.write_text(scene)

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
    scene: str, record: Callable[[str], dict[str, list[tuple[int, int, bytes]]]], monkeypatch: pytest.MonkeyPatch
) -> None:
    kept: list[str] = []
    frames: list[int] = []
    encode = Capture.encode

    def counted(self: Capture, batch: object, begins: object, *rest: object) -> None:
        kept.extend([type(self).__name__] * len(begins))  # type: ignore[arg-type]
        if isinstance(self, FramesCapture):
            frames.append(len(self.mountings))
        encode(self, batch, begins, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(Capture, "encode", counted)
    found = record("kept.mcap")
    assert kept.count("FramesCapture") > 20
    assert frames[-1] == (5 if scene == WHEELS else 0), "the base and four wheels"
    monkeypatch.setattr(keeping, "records", lambda: None)
    monkeypatch.setattr(motion, "records", lambda: None)
    assert found == record("plain.mcap")
    for topic in TOPICS[scene]:
        assert [tick for tick, *_ in found[topic]] == list(range(1, 31)), topic


def test_a_scene_with_few_frames_is_simulated_again(
    record: Callable[[str], dict[str, list[tuple[int, int, bytes]]]], tmp_path: Path
) -> None:
    record("run.mcap")
    with Recording(tmp_path / "run.mcap") as recording:
        assert resimulate(recording, trust=True, told=lambda _: None).departure is None
