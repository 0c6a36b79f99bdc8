"""Scans of laser scanners that act together are recorded as they were measured, whatever their fans become."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

import morse
from morse.recording.captures import sensors
from morse.recording.mcap.reader import McapFile
from morse.rosmsgs.cdr import decode

if TYPE_CHECKING:
    from pathlib import Path

    import pytest


def _scene() -> None:
    from morse.builder import ATRV, Environment, MotionVW, Sick

    for number in range(5):
        robot = ATRV(f"r{number}")
        robot.translate(3.0 * number, 0.0, 0.1)
        scan = Sick(f"scan{number}")
        scan.frequency(60)
        scan.properties(laser_range=6.0)
        robot.append(scan)
        robot.append(MotionVW(f"motion{number}"))
    Environment("empty", fastmode=True)


def test_scans_of_a_changed_fan_are_those_of_the_sensor(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    taken: list[bool] = []
    take = sensors.Scanners.take

    def noted(capture: sensors.Scanners, group: Any) -> Any:
        found = take(capture, group)
        taken.append(found is not None)
        return found

    monkeypatch.setattr(sensors.Scanners, "take", noted)
    wanted = []
    with morse.load(_scene) as sim, sim.record(tmp_path / "run.mcap"):
        scanner: Any = sim.context.components["r1.scan1"]
        for tick in range(30):
            if tick == 10:
                for one in scanner.group.members:  # they are still cast together
                    one.set_property("laser_range", 3.0)
            if tick == 20:
                scanner.rays.turn_to(scanner.rays.directions[::-1].copy())
            sim.r1.motion1.publish({"v": 0.1 * tick, "w": 0.5})
            sim.step()
            data = np.array(scanner.local_data["range_list"], dtype=np.float32)
            wanted.append(np.where(data >= scanner.laser_range, np.inf, data).tolist())
    assert sum(taken) > 5
    with McapFile(tmp_path / "run.mcap") as file:
        (number,) = [channel.number for channel in file.channels.values() if channel.topic == "/r1/scan1"]
        messages = [decode("sensor_msgs/msg/LaserScan", one.data) for one in file.messages([number])]
    assert [message["range_max"] for message in messages] == [6.0] * 10 + [3.0] * 20
    assert [np.asarray(message["ranges"]).tolist() for message in messages] == wanted
