"""ROS 1, with a real master and a real node of rospy in another process."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from master import environment, master, need_ros, run, simulation

import morse
from morse.core.exceptions import MorseError

if TYPE_CHECKING:
    from collections.abc import Iterator

HERE = Path(__file__).parent
SCENE = """
from morse.builder import *
robot = ATRV()
robot.append(MotionVW("motion"))
robot.append(Pose("pose"))
robot.append(Odometry("odometry"))
scan = Hokuyo("scan"); scan.translate(0.2, 0.0, 0.6); robot.append(scan)
robot.append(IMU("imu"))
robot.append(Proximity("near"))
eye = VideoCamera("eye"); eye.properties(cam_width=32, cam_height=24); robot.append(eye)
ptu = PTU("ptu"); robot.append(ptu); ptu.append(PTUPosture("posture"))
robot.add_default_interface("ros")
other = ATRV(); other.translate(0.0, 8.0, 0.0)
other.append(Teleport("jump"))
other.append(Pose("pose"))
other.add_default_interface("ros")
env = Environment("empty")
env.add_service("ros")
"""
RATE = 60.0


@pytest.fixture(scope="module")
def uri() -> Iterator[str]:
    need_ros()
    with master() as address:
        yield address


@pytest.fixture(scope="module")
def said(uri: str, tmp_path_factory: pytest.TempPathFactory) -> Any:
    scene = tmp_path_factory.mktemp("ros1") / "scene.py"
    scene.write_text(SCENE)
    with simulation(scene, uri):
        return json.loads(run(HERE / "ros1_peer.py", uri))


def test_a_node_drives_the_robot_and_sees_what_it_does(said: Any) -> None:
    assert said["missing"] == []
    assert said["x"] > 0.3
    assert said["speed"] == pytest.approx(0.5, abs=0.02)
    assert said["gravity"] == pytest.approx(9.81, abs=0.5)
    assert said["joints"][0] == ["pan", "tilt"]
    # in a Vector3, y is pan and z is tilt
    assert said["joints"][1] == pytest.approx([0.4, -0.2], abs=0.06)
    assert "other" in said["near"], "the other robot has jumped there"


def test_stamps_are_simulated_time(said: Any) -> None:
    ticks = [stamp * 1e-9 * RATE for stamp in said["stamps"]]
    assert ticks == sorted(ticks)
    assert all(abs(tick - round(tick)) < 1e-6 for tick in ticks)
    assert ticks[-1] < 60.0 * RATE * 60.0


def test_names_of_frames_are_those_of_1_4(said: Any) -> None:
    frames = said["frames"]
    assert frames["/robot/pose"] == "/map"
    assert (frames["/robot/odometry"], said["child"]) == ("/odom", "/base_footprint")
    assert frames["/robot/scan"] == "/base_laser_link"
    assert frames["/robot/imu"] == "/imu"
    assert frames["/robot/eye/image"] == frames["/robot/eye/camera_info"] == "/robot/eye"
    assert ["/odom", "/base_footprint"] in said["tf"]
    assert ["/base_link", "/robot/eye"] in said["tf"]


def test_messages_keep_their_definitions(said: Any) -> None:
    count, first, last, step, nearest = said["scan"]
    assert last == pytest.approx(first + (count - 1) * step, abs=1e-4)
    assert first == pytest.approx(-math.radians(135.0), abs=1e-4)
    assert nearest == pytest.approx(0.3)
    assert said["image"] == ["rgba8", 32, 24, 128, 32 * 24 * 4]
    focal, width, distortion, model = said["info"]
    assert (width, distortion, model) == (32, [0.0] * 5, "plumb_bob")
    assert focal > 0.0
    assert said["robots"] == [True, '["robot","other"]']


def test_without_a_master_the_error_says_what_to_start(tmp_path: Path) -> None:
    need_ros()
    scene = tmp_path / "scene.py"
    scene.write_text(SCENE)
    done = subprocess.run(
        [sys.executable, "-m", "morse", "run", "--headless", str(scene)],
        env=environment("http://127.0.0.1:9/"), capture_output=True, text=True, timeout=100, check=False,
    )  # fmt: skip
    assert done.returncode == 1
    assert "there is no master at http://127.0.0.1:9/" in done.stdout
    assert "roscore" in done.stdout
    assert "Traceback" not in done.stdout + done.stderr


def test_where_rospy_is_missing_the_error_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rospy", None)  # as if it could not be imported
    scene = tmp_path / "scene.py"
    scene.write_text(SCENE)
    with pytest.raises(MorseError, match="sudo apt install python3-rospy"):
        morse.load(scene, sockets=True)
