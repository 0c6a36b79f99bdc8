"""Sensors that act alone: their numbers are stored in the tick and encoded later, to the bit as their streams do."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import morse
from morse.recording import keeping, motion
from morse.recording.captures.capture import Capture
from morse.recording.mcap.reader import McapFile

if TYPE_CHECKING:
    from pathlib import Path

    import pytest

SCRIPT = """
from morse.builder import *

robot = ATRV()
robot.rotate(0.1, -0.05, 1.3)
motion, pose, noisy, scan, near = MotionVW(), Pose(), Pose(), Sick(), Infrared()
pose.translate(0.1, 0.0, 0.3)
pose.rotate(0.2, 0.0, 0.5)
noisy.noise(gaussian=0.01)
scan.translate(0.4, 0.0, 0.9)
near.translate(0.6, 0.0, 0.4)
for component in (motion, pose, noisy, scan, near):
    robot.append(component)
box = Cube()
box.translate(2.0, 1.0, 0.5)
Environment("empty", fastmode=True)
"""


def recorded(folder: Path, name: str) -> tuple[dict[str, list[tuple[int, bytes]]], str]:
    """Ticks and messages by topic, and the state at the end."""
    script, path = folder / "scene.py", folder / name
    script.write_text(SCRIPT)
    with morse.load(script, seed=7) as sim:
        sim.step(5)
        sim.robot.motion.publish({"v": 0.4, "w": 0.3})
        with sim.record(path):
            sim.step(20)
            pose: Any = sim.context.components["robot.pose"]
            pose.bge_object.applyRotation((0.0, 0.0, 0.5), True)
            sim.step(4)
            # it is no longer plain: its stream encodes its messages from now on
            pose.output_modifiers.append(_Lifted(pose))
            sim.step(3)
            sim.robot.scan.set_property("laser_range", 3.0)
            sim.step(13)
        state = sim.state_hash()
    with McapFile(path) as file:
        topics = {number: channel.topic for number, channel in file.channels.items()}
        found: dict[str, list[tuple[int, bytes]]] = {topic: [] for topic in topics.values()}
        for one in file:
            found[topics[one.channel]].append((one.sequence, one.data))
    del found["/rosout"]
    return found, state


class _Lifted:
    """A modifier: 1 m higher."""

    def __init__(self, component: Any) -> None:
        self._component = component

    def modify(self) -> None:
        self._component.local_data["z"] += 1.0

    def get_state(self) -> dict[str, Any]:
        return {}


def test_they_are_those_of_the_streams(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ticks = {"PoseSensors": 0, "Scanners": 0}
    encode = Capture.encode

    def counted(self: Capture, batch: Any, begins: Any, *rest: Any) -> None:
        ticks[type(self).__name__] = ticks.get(type(self).__name__, 0) + len(begins)
        encode(self, batch, begins, *rest)

    monkeypatch.setattr(Capture, "encode", counted)
    found, state = recorded(tmp_path, "kept.mcap")
    assert ticks["PoseSensors"] > 15
    assert ticks["Scanners"] > 4
    before = dict(ticks)
    monkeypatch.setattr(keeping, "records", lambda: None)
    monkeypatch.setattr(motion, "records", lambda: None)
    wanted, plain_state = recorded(tmp_path, "plain.mcap")
    assert ticks == before
    assert plain_state == state
    assert found == wanted
    assert [tick for tick, _ in wanted["/robot/pose"]] == list(range(6, 46))
    assert len(wanted["/robot/near"]) == len(wanted["/robot/scan"]) >= 6
