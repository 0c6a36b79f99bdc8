"""Data of sensors on the page of a recorded run: those of the recording, at the position of the time line."""

import contextlib
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from view_pages import Client

import morse
from morse.builder import ATRV
from morse.launch.playing import playing
from morse.recording.recording import Recording
from morse.viewer.feeds.recorded import RecordedPicturesFeed
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


# -- panels of a recorded run: fields from messages of ROS, commands, and notes about what is not in the recording

VIEW_RECORDED_NOTES_SCENE = """
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
    script.write_text(VIEW_RECORDED_NOTES_SCENE)
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


# -- what cameras saw in a recorded run, on the page of the replay ---------------------------------

VIEW_RECORDED_PICTURES_SCENE = """
from morse.builder import *

robot = ATRV()
motion = MotionVW()
robot.append(motion)
for name, camera in (("eye", VideoCamera()), ("depth", DepthVideoCamera()), ("ids", SegmentationCamera())):
    camera.name = name
    camera.translate(z=1.0)
    camera.rotate(x={turn})
    camera.properties(cam_width=24, cam_height=16)
    robot.append(camera)
env = Environment("sandbox")
{more}
"""
NAMES = ("eye", "depth", "ids")
#: ticks after which pictures are compared; the last ones go back
PLACES = (30, 60, 45, 12)


def written(path: Path, turn: float, more: str = "") -> Path:
    path.write_text(VIEW_RECORDED_PICTURES_SCENE.format(turn=turn, more=more))
    return path


@pytest.mark.parametrize("more", ["", "env.configure_stream_manager('ros2', namespace='fleet/one')"])
def test_recorded_pictures_are_shown_whatever_the_scene_shows_now(tmp_path, more) -> None:
    script = written(tmp_path / "scene.py", 0.0, more)
    truth: dict[int, dict[str, np.ndarray]] = {}
    with morse.load(script) as sim, sim.record(tmp_path / "run.mcap"):
        sim.robot.motion.publish({"v": 1.0, "w": 1.0})
        for tick in range(1, 61):
            sim.step()
            components = sim.context.components
            if tick in PLACES:
                truth[tick] = {
                    name: np.array(components[f"robot.{name}"].local_data["image"])[
                        :: 1 if components[f"robot.{name}"].vertical_flip else -1
                    ]
                    for name in NAMES
                }
    assert any((truth[30]["eye"] != truth[60]["eye"]).ravel())
    # another scene: the cameras look elsewhere
    other = written(tmp_path / "other.py", 1.2, more)
    with (
        Recording(tmp_path / "run.mcap") as recording,
        playing(recording, str(other), print, port=0, browser=False) as view,
    ):
        feed: Any = view._pictures
        assert isinstance(feed, RecordedPicturesFeed)
        for place in PLACES:
            while not view._timeline.approach(place):
                pass
            for name in NAMES:
                component = view._simulation.context.components[f"robot.{name}"]
                shot = feed.shot(f"robot.{name}", component)
                np.testing.assert_array_equal(shot.image, truth[place][name])
                assert feed.shot(f"robot.{name}", component).source is shot.source


def test_cameras_that_were_not_recorded_are_those_of_the_simulation(tmp_path) -> None:
    script = written(tmp_path / "scene.py", 0.0)
    with morse.load(script) as sim, sim.record(tmp_path / "run.mcap", sensors=["robot.eye"]):
        sim.step(10)
    with Recording(tmp_path / "run.mcap") as recording, playing(recording, port=0, browser=False) as view:
        while not view._timeline.approach(10):
            pass
        feed: Any = view._pictures
        depth = view._simulation.context.components["robot.depth"]
        assert feed.shot("robot.depth", depth).source is depth.local_data["image"]
        eye = view._simulation.context.components["robot.eye"]
        assert feed.shot("robot.eye", eye).source is not eye.local_data["image"]
