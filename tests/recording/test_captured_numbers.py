"""Sensors of all kinds: their numbers are stored in the tick and encoded later, to the bit as their streams do."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import morse
from morse.recording import keeping, motion
from morse.recording.captures import copies
from morse.recording.mcap.reader import McapFile
from morse.rosmsgs.cdr import decode

if TYPE_CHECKING:
    from pathlib import Path

ALONE = ["Accelerometer", "Airspeed", "Attitude", "Barometer", "Battery", "Bumper", "GPS", "Gyroscope", "IMU"]
ALONE += ["Magnetometer", "Pose", "RadarAltimeter", "Thermometer", "Velocity"]
SCRIPT = f"""
from morse.builder import *
from morse.builder import sensors

robot = ATRV()
robot.rotate(0.1, -0.05, 1.3)
robot.append(MotionVW("motion"))
for name in {ALONE}:
    sensor = getattr(sensors, name)(name.lower())
    sensor.translate(0.1, 0.2, 0.3)
    sensor.rotate(0.2, 0.0, 0.5)
    if name in ("Pose", "Gyroscope"):
        sensor.noise(gaussian=0.01)
    robot.append(sensor)
arm = KukaLWR("arm")
robot.append(arm)
arm.append(ArmaturePose("joints"))
for number in range(4):
    other = Morsy(f"m{{number}}")
    other.translate(3.0 * number, 5.0, 1.0 + number)
    for name in ("IMU", "GPS", "Velocity"):
        other.append(getattr(sensors, name)(name.lower()))
    other.append(MotionVW("motion"))
env = Environment("empty", fastmode=True)
env.properties(longitude=1.4, latitude=43.6, altitude=150.0)
"""


def run(folder: Path, name: str) -> tuple[dict[str, list[tuple[int, bytes]]], str, set[str]]:
    """Ticks and messages by topic, the state at the end, and the sensors whose streams were silent."""
    script, path = folder / "scene.py", folder / name
    script.write_text(SCRIPT)
    with morse.load(script, seed=7) as sim:
        for robot in (sim.robot, sim.m0, sim.m3):
            robot.motion.publish({"v": 1.0, "w": 0.4})
        recorder = sim.record(path)
        sim.step(10)
        bumper: Any = sim.context.components["robot.bumper"]
        touch = bumper.touched
        for names in (["wall"], ["wall", "door"], []):
            bumper.touched = lambda found=names: found
            sim.step(2)
        bumper.touched = touch
        sim.step(4)
        captures: Any = recorder._streams.captures
        silent = set() if captures is None else {one.name() for one in captures.quiet}
        recorder.stop()
        state = sim.state_hash()
    with McapFile(path) as file:
        topics = {number: channel.topic for number, channel in file.channels.items()}
        found: dict[str, list[tuple[int, bytes]]] = {topic: [] for topic in topics.values()}
        for one in file:
            found[topics[one.channel]].append((one.sequence, one.data))
    del found["/rosout"]
    return found, state, silent


def test_they_are_those_of_the_streams(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found, state, silent = run(tmp_path, "kept.mcap")
    monkeypatch.setattr(keeping, "records", lambda: None)
    monkeypatch.setattr(motion, "records", lambda: None)
    wanted, plain_state, _ = run(tmp_path, "plain.mcap")
    assert plain_state == state
    assert found.keys() == wanted.keys()
    for topic, every in wanted.items():
        assert found[topic] == every, topic
    # the magnetic field of an IMU is turned into its axes by a function, so that its messages are encoded in the tick
    alone = {f"robot.{name.lower()}" for name in ALONE if name != "IMU"} | {"robot.arm.joints"}
    together = {f"m{number}.{name}" for number in range(4) for name in ("gps", "velocity")}
    assert silent >= alone | together
    # a message that changes in other ways than its numbers
    names = [decode("std_msgs/msg/String", data)["data"] for _, data in found["/robot/bumper/names"]]
    assert names == [""] * 10 + ["wall"] * 2 + ["wall,door"] * 2 + [""] * 6
    speeds = [decode("sensor_msgs/msg/Imu", data)["angular_velocity"]["z"] for _, data in found["/m3/imu/data"]]
    assert speeds[-1] == pytest.approx(0.4)


def test_a_failing_function_closes_its_stream_and_not_the_recording(tmp_path: Path) -> None:
    script, path = tmp_path / "scene.py", tmp_path / "run.mcap"
    script.write_text(SMALL)
    with morse.load(script) as sim, sim.record(path) as recorder:
        sim.step(6)
        imu: Any = sim.context.components["robot.imu"]
        captures: Any = recorder._streams.captures
        assert imu in captures.quiet
        bound = recorder._streams.streams["robot.imu"][0].kinds[0]
        bound._sources = [(slot, _Failing()) for slot, _ in bound._sources]
        sim.step(6)
        assert imu.active
        assert recorder.running
    with McapFile(path) as file:
        topics = {channel.topic: number for number, channel in file.channels.items()}
        assert len(list(file.messages([topics["/robot/thermometer"]]))) == 12
        assert 6 <= len(list(file.messages([topics["/robot/imu/data"]]))) < 12


class _Failing:
    def get(self, component: Any) -> Any:
        raise ZeroDivisionError


SMALL = """
from morse.builder import *

robot = ATRV()
imu, thermometer = IMU(), Thermometer()
robot.append(imu)
robot.append(thermometer)
Environment("empty", fastmode=True)
"""


def test_a_message_with_other_numbers_than_those_of_its_slots_is_not_captured(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The places of numbers are verified: a message with doubled numbers does not hold them."""
    tried: list[bool] = []
    agrees = copies.CopiesCapture.agrees_with

    def doubled(self: Any, columns: int, messages: Any) -> bool:
        tried.append(agrees(self, columns, lambda numbers: messages((np.array(numbers) * 2.0).tolist())))
        return tried[-1]

    monkeypatch.setattr(copies.CopiesCapture, "agrees_with", doubled)
    script = tmp_path / "scene.py"
    script.write_text(SMALL)
    with morse.load(script) as sim, sim.record(tmp_path / "run.mcap") as recorder:
        sim.step(6)
        captures: Any = recorder._streams.captures
        assert tried == [False, False]
        assert not captures.quiet
