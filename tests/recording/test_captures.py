"""What is kept in the tick and encoded later are the messages that the streams encode, to the bit."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import morse
from morse.launch.load import load
from morse.recording import disk, gathering, keeping, motion
from morse.recording.captures.capture import Capture
from morse.recording.mcap.reader import McapFile
from morse.recording.mcap.writer import McapWriter
from morse.recording.recording import Recording
from morse.verification.resimulation import resimulate

if TYPE_CHECKING:
    from pathlib import Path

SCRIPT = """
from morse.builder import *

for number in range(4):
    robot = ATRV(f"r{number}")
    robot.translate(3.0 * number, -number, 0.2 + 0.1 * number)
    robot.rotate(0.1 * number, -0.05 * number, 1.3 * number)
    motion = MotionVW(f"motion{number}")
    pose = Pose(f"pose{number}")
    pose.translate(0.1 * number, 0.0, 0.3)
    pose.rotate(3.0 if number == 3 else 0.0, 0.2 * number, 0.5)
    scan = Sick(f"scan{number}")
    scan.translate(0.4, 0.0, 0.9)
    scan.properties(laser_range=4.0)
    near = Pose(f"near{number}")
    near.frequency(20)
    battery = Battery(f"battery{number}")
    for component in (motion, pose, scan, near, battery):
        robot.append(component)
for number in range(6):
    box = Cube(f"box{number}")
    box.translate(2.0 * number, 3.0, 0.5)
env = Environment("empty", fastmode=True)
"""


@pytest.fixture(scope="module")
def script(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("captures") / "scene.py"
    made.write_text(SCRIPT)
    return made


@pytest.fixture
def encoded(monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """How many ticks captures have encoded, by their class."""
    found: Counter[str] = Counter()
    encode = Capture.encode

    def counted(self: Capture, batch: Any, begins: Any, *rest: Any) -> None:
        found[type(self).__name__] += len(begins)
        encode(self, batch, begins, *rest)

    monkeypatch.setattr(Capture, "encode", counted)
    return found


def messages(path: Path) -> dict[str, list[tuple[int, int, int, bytes]]]:
    """Tick, times and bytes of all messages, by topic; the log names the file."""
    with McapFile(path) as file:
        topics = {number: channel.topic for number, channel in file.channels.items()}
        found: dict[str, list[tuple[int, int, int, bytes]]] = {topic: [] for topic in topics.values()}
        for one in file:
            found[topics[one.channel]].append((one.sequence, one.log_time, one.publish_time, one.data))
    del found["/rosout"]
    return found


def run(script: Path, path: Path) -> str:
    with morse.load(script) as sim, sim.record(path):
        for number in range(4):
            getattr(getattr(sim, f"r{number}"), f"motion{number}").publish({"v": 0.4 * number, "w": 0.3 - 0.2 * number})
        sim.step(24)
        sim.restart()
        sim.step(12)
        sim.spawn("guest", "Morsy", [-3.0, 0.0, 0.2])
        sim.step(8)
        return sim.state_hash()


def test_they_are_those_of_the_streams(
    script: Path, tmp_path: Path, encoded: Counter[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    kept, plain = tmp_path / "kept.mcap", tmp_path / "plain.mcap"
    packed: list[memoryview] = []
    # the kernel compresses chunks as if the simulation were fast
    monkeypatch.setattr(disk, "_QUICK", 0.0)
    monkeypatch.setattr(gathering, "_MOST_OTHERS", 1.0)
    # the poses of some rigid groups are copied, as in a large world; the other tests store references
    monkeypatch.setattr(keeping, "_MOST_SHARED", 0)
    write = McapWriter.packed
    monkeypatch.setattr(
        McapWriter, "packed", lambda writer, data, *rest: packed.append(data) or write(writer, data, *rest)
    )
    state = run(script, kept)
    assert sum(map(len, packed)) > 1000
    assert encoded["PoseSensors"] > 25
    assert encoded["Scanners"] > 1
    assert encoded["FramesCapture"] > 20
    monkeypatch.setattr(keeping, "records", lambda: None)
    monkeypatch.setattr(motion, "records", lambda: None)
    before = Counter(encoded)
    assert run(script, plain) == state
    assert encoded == before
    found, wanted = messages(kept), messages(plain)
    assert found.keys() == wanted.keys()
    for topic, every in wanted.items():
        assert found[topic] == every, topic
    assert len(wanted["/r3/pose3"]) == len(wanted["/clock"]) == 44


def test_messages_are_in_the_order_of_the_ticks(script: Path, tmp_path: Path) -> None:
    with morse.load(script) as sim, sim.record(tmp_path / "run.mcap"):
        sim.step(30)
    with McapFile(tmp_path / "run.mcap") as file:
        ticks = [one.sequence for one in file]
    assert ticks == sorted(ticks)
    assert set(ticks) >= set(range(1, 31))


def test_a_sensor_that_is_moved_or_left_alone_is_recorded_at_its_place(script: Path, tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    wanted: list[tuple[float, ...]] = []
    with morse.load(script) as sim, sim.record(path):
        pose: Any = sim.context.components["r1.pose1"]
        for tick in range(24):
            if tick == 8:
                pose.bge_object.applyRotation((0.0, 0.0, 0.5), True)
            if tick == 16:
                pose.output_modifiers.append(_Lifted(pose))  # it acts alone from now on
            sim.step()
            data = pose.local_data
            half = 0.5 * data["yaw"]
            wanted.append((data["x"], data["y"], data["z"], math.sin(half) ** 2))
    with McapFile(path) as file:
        (number,) = [channel.number for channel in file.channels.values() if channel.topic == "/r1/pose1"]
        tails = [np.frombuffer(one.data[-56:], dtype="<f8") for one in file.messages([number])]
    assert [tail[:3].tolist() for tail in tails] == [list(one[:3]) for one in wanted]
    assert tails[16][2] - tails[15][2] == pytest.approx(1.0, abs=0.1)
    assert not np.allclose(tails[7][3:], tails[9][3:], atol=1e-2)


class _Lifted:
    """A modifier: 1 m higher."""

    def __init__(self, component: Any) -> None:
        self._component = component

    def modify(self) -> None:
        self._component.local_data["z"] += 1.0


def test_the_run_can_be_simulated_again(script: Path, tmp_path: Path, encoded: Counter[str]) -> None:
    path = tmp_path / "run.mcap"
    run_without_spawn(script, path)
    assert encoded["PoseSensors"] > 20
    with Recording(path) as recording:
        outcome = resimulate(recording, trust=True, told=lambda _: None)
    assert outcome.departure is None
    assert outcome.messages > 300


def run_without_spawn(script: Path, path: Path) -> None:
    with load(script) as sim, sim.record(path):
        sim.r2.motion2.publish({"v": 1.0, "w": 0.5})
        sim.step(30)


@pytest.mark.parametrize("names", [["r1.pose1", "r3.scan3"], ["r0.battery0"]])
def test_some_sensors_alone(script: Path, tmp_path: Path, names: list[str]) -> None:
    with morse.load(script) as sim, sim.record(tmp_path / "run.mcap", sensors=names):
        sim.step(24)
    found = messages(tmp_path / "run.mcap")
    assert {topic for topic in found if topic.startswith("/r") and "robot_description" not in topic} == {
        "/" + name.replace(".", "/") for name in names
    }
    assert len(found["/clock"]) == 24
