"""Panels of a recorded run: fields from messages of ROS, commands, and notes about what is not in the recording."""

import contextlib
import time
from typing import Any

import pytest
from view_pages import Client

import morse
from morse.builder import ATRV
from morse.launch.playing import playing
from morse.recording.recording import Recording
from morse.viewer.replay_view import ReplayView

SCENE = """
from morse.builder import *

robot = ATRV()
motion, gps, contact = MotionVW(), GPS(), Collision()
odometry, imu = Odometry(), IMU()
odometry.translate(0.3, 0.2, 0.5)
odometry.rotate(z=1.0)
for part in (motion, gps, odometry, imu, contact):
    robot.append(part)
Environment("empty")
"""
#: 33 ticks
END = 33 / 60
RECORDED = ("robot.odometry", "robot.imu", "robot.contact")


def visitor() -> ATRV:
    return ATRV()


class Run:
    """A recorded run that is shown: the true data at its end, the log, and what the page receives."""

    def __init__(self) -> None:
        self.truth: dict[str, dict[str, Any]] = {}
        self.told: list[str] = []
        self.values: dict[str, dict[str, Any]] = {}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("notes")
    script, path = folder / "scene.py", folder / "run.mcap"
    script.write_text(SCENE)
    found = Run()
    with morse.load(script) as sim, sim.record(path, sensors=RECORDED):
        sim.step(3)
        sim.robot.motion.publish({"v": 1.0, "w": 0.5})
        sim.spawn("visitor", visitor, (5.0, 0.0, 0.0))
        sim.step(30)
        found.truth = {name: dict(sim.context.components[name].local_data) for name in RECORDED}
    with Recording(path) as recording, playing(recording, say=found.told.append, port=0, browser=False) as view:
        view.announce()
        names = [*RECORDED, "robot.gps", "robot.motion", "robot"]
        with Client(view.url, close_timeout=0.2) as client:
            client.send("pause")
            client.send("rewind", time=1e3)
            client.send("watch", values=names)
            _turn(view, client, names)
        values = [one for one in client.messages if one["type"] == "values"]
        found.values = {one["component"]: one for one in values}
    return found


def _turn(view: ReplayView, client: Client, names: list[str]) -> None:
    end = time.monotonic() + 60.0
    while time.monotonic() < end:
        view.turn()
        with contextlib.suppress(TimeoutError):
            client.receive(timeout=0.02)
        # values of earlier times may arrive after the jump to the end
        last = {m["component"]: m["time"] for m in client.messages if m["type"] == "values"}
        if last.keys() >= set(names) and min(last.values()) > END - 0.02:
            return
    raise AssertionError("the values never come")


def test_odometry_is_that_of_the_sensor_not_of_the_robot(run: Run) -> None:
    data = run.values["robot.odometry"]["data"]
    for field in ("x", "y", "z", "yaw", "vx", "vy", "vz", "wx", "wy", "wz"):
        assert data[field] == pytest.approx(run.truth["robot.odometry"][field], abs=1e-9), field
    assert run.truth["robot.odometry"]["x"] != 0.0


def test_other_messages_have_the_fields_of_the_sensor(run: Run) -> None:
    imu = run.values["robot.imu"]["data"]
    assert imu["angular_velocity"] == pytest.approx(run.truth["robot.imu"]["angular_velocity"], abs=1e-9)
    assert imu["linear_acceleration"][2] == pytest.approx(9.8, abs=0.5)


def test_an_actuator_shows_the_last_command(run: Run) -> None:
    assert run.values["robot.motion"]["data"] | {"v": 1.0, "w": 0.5} == run.values["robot.motion"]["data"]
    assert run.values["robot.motion"]["note"] == "the last recorded command"


def test_what_is_not_in_the_recording_is_said(run: Run) -> None:
    for name in ("robot.gps", "robot"):
        assert run.values[name]["note"] == "not recorded"
        assert run.values[name]["data"] == {}
    assert run.values["robot.imu"]["note"] == ""


def test_a_robot_from_a_function_needs_no_remark(run: Run) -> None:
    assert run.told == []
