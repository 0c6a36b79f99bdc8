"""Data of sensors on the page of a recorded run: those of the recording, at the position of the time line."""

import contextlib
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from view_pages import Client

import morse
from morse.launch.playing import playing
from morse.recording.recording import Recording
from morse.viewer.replay_view import ReplayView

SCENE = """
from morse.builder import *

robot = ATRV()
motion, pose, scan, battery = MotionVW(), Pose(), Sick(), Battery()
pose.noise(gaussian=0.1)
scan.translate(0.6, 0.0, 0.4)
scan.properties(laser_range=5.0)
for part in (motion, pose, scan, battery):
    robot.append(part)
other = ATRV()
other.translate(3.0, 0.0, 0.0)
Environment("empty")
"""


def turn_until(view: ReplayView, condition: Callable[[], Any]) -> Any:
    end = time.monotonic() + 60.0
    while time.monotonic() < end:
        view.turn()
        found = condition()
        if found:
            return found
    raise AssertionError("it never happens")


def test_values_are_those_of_the_recording(tmp_path: Path) -> None:
    script, path = tmp_path / "scene.py", tmp_path / "run.mcap"
    script.write_text(SCENE)
    truth: dict[int, dict[str, dict[str, Any]]] = {}
    with morse.load(script, seed=5) as sim, sim.record(path):
        sim.robot.motion.publish({"v": 1.0, "w": 0.5})
        for tick in range(1, 46):
            sim.step()
            components = sim.context.components
            truth[tick] = {
                name: {
                    field: value.tolist() if hasattr(value, "tolist") else value
                    for field, value in components[f"robot.{name}"].local_data.items()
                }
                for name in ("pose", "scan", "battery")
            }
    with Recording(path) as recording, playing(recording, port=0, browser=False) as view:
        view.announce()
        with Client(view.url, close_timeout=0.2) as client:
            turn_until(view, lambda: view._server.watched)
            client.send("pause")
            client.send("watch", values=["robot.pose", "robot.scan", "robot.battery"])
            for position in (40, 7):
                client.send("rewind", time=position / 60)

                def latest(position: int = position) -> dict[str, dict[str, Any]]:
                    with contextlib.suppress(TimeoutError):
                        client.receive(timeout=0.02)
                    values = [one for one in client.messages if one["type"] == "values"]
                    found = {one["component"]: one["data"] for one in values}
                    wanted = truth[position]["pose"]["timestamp"]
                    arrived = found.get("robot.pose", {}).get("timestamp") == pytest.approx(wanted, abs=1e-6)
                    # the components are sent in the order of their names
                    whole = values[-3:] and [one["component"] for one in values[-3:]] == sorted(found)
                    return found if arrived and whole and len(found) == 3 else {}

                found = turn_until(view, latest)
                wanted = truth[position]
                for field in ("x", "y", "z", "yaw", "pitch", "roll"):
                    # with noise: it is not what the sensor would measure again
                    assert found["robot.pose"][field] == pytest.approx(wanted["pose"][field], abs=1e-9), field
                assert found["robot.scan"]["range_list"] == pytest.approx(wanted["scan"]["range_list"], rel=1e-6)
                assert min(found["robot.scan"]["range_list"]) < 4.0
                assert found["robot.battery"]["charge"] == pytest.approx(wanted["battery"]["charge"], rel=1e-5)
