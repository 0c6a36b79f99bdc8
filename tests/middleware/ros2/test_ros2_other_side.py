"""Tests with a real peer in another process."""

import math
import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from other_side import DOMAIN, PYTHON, SETTINGS, has, lent, need, talk

import morse

SCENE = """
from morse.builder import *
robot = ATRV()
robot.translate(1.0, 2.0, 0.0)
robot.rotate(0.0, 0.0, math.pi / 2)
robot.append(MotionVW("motion"))
robot.append(Pose("pose"))
odometry = Odometry("odometry")
odometry.translate(0.3, 0.0, 0.2)
robot.append(odometry)
scan = Hokuyo("scan")
scan.translate(0.2, 0.0, 0.6)
robot.append(scan)
robot.add_default_interface("ros2")
env = Environment("empty", fastmode=True)
env.configure_stream_manager("ros2", domain_id={domain}, backend="{backend}")
"""
RATE = 60.0
MANAGER = "morse.middleware.ros2.datastream.Ros2DatastreamManager"


#: rclpy needs a separate Python: see the last test
BACKENDS = [backend for backend in ("cyclonedds", "rclpy") if has(sys.executable, backend)]


@pytest.fixture(params=BACKENDS)
def simulation(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    for name in SETTINGS:
        monkeypatch.delenv(name, raising=False)
    scene = tmp_path / "scene.py"
    scene.write_text("import math\n" + SCENE.format(domain=DOMAIN, backend=request.param))
    with morse.load(scene, sockets=True) as sim:
        yield sim


def seconds(stamp: dict[str, int]) -> float:
    return stamp["sec"] + stamp["nanosec"] * 1e-9


@pytest.mark.peer(
    "ros-jazzy-rclpy", does="a node drives and reads poses, odometry, scans, frames and time of the wheel backend"
)
def test_a_node_of_rclpy_drives_the_robot_and_sees_what_it_does(simulation: Any) -> None:
    need("rclpy", PYTHON)
    said = talk("rclpy_peer.py", simulation.step, PYTHON)
    messages = said["messages"]
    assert said["types"]["/robot/scan"] == ["sensor_msgs/msg/LaserScan"]
    assert said["types"]["/robot/cmd_vel"] == ["geometry_msgs/msg/Twist"]
    # the simulation is a node, to which its topics belong
    assert said["publishers"] == ["morse"]
    assert {"/clock", "/robot/pose", "/robot/scan"} <= said["published"].keys()
    assert "/robot/cmd_vel" in said["subscribed"]
    for topic, frame in (("pose", "map"), ("odometry", "robot/odom"), ("scan", "robot/scan")):
        received = messages[f"/robot/{topic}"]
        stamps = [seconds(message["header"]["stamp"]) for message in received]
        assert {message["header"]["frame_id"] for message in received} == {frame}
        assert stamps == sorted(set(stamps))
        # simulated time: multiples of the tick, to the ns
        assert all(abs(stamp * RATE - round(stamp * RATE)) < 1e-6 for stamp in stamps)
    times = [seconds(message["clock"]) for message in messages["/clock"]]
    assert [round((b - a) * RATE) for a, b in pairwise(times)].count(0) == 0

    # the robot looks along Y of the world, and drives with 0.5 m/s along its own X
    odometry, pose = messages["/robot/odometry"][-1], messages["/robot/pose"][-1]
    assert odometry["child_frame_id"] == "robot/base_link"
    assert odometry["twist"]["twist"]["linear"]["x"] == pytest.approx(0.5, abs=0.02)
    assert odometry["pose"]["pose"]["position"]["x"] > 0.3
    assert odometry["pose"]["pose"]["position"]["y"] == pytest.approx(0.0, abs=0.02)
    assert pose["pose"]["position"]["y"] > 2.2
    assert pose["pose"]["position"]["x"] == pytest.approx(1.0, abs=0.02)
    assert pose["pose"]["orientation"]["z"] == pytest.approx(math.sqrt(0.5), abs=1e-3)
    assert pose["pose"]["orientation"]["w"] == pytest.approx(math.sqrt(0.5), abs=1e-3)

    scan = messages["/robot/scan"][-1]
    last = scan["angle_min"] + (len(scan["ranges"]) - 1) * scan["angle_increment"]
    assert scan["angle_max"] == pytest.approx(last, abs=1e-5)
    assert scan["angle_min"] == pytest.approx(-math.radians(135.0))
    assert set(scan["ranges"]) == {math.inf}, "there is nothing in this world"


@pytest.mark.peer("cyclonedds")
def test_the_tree_of_frames(simulation: Any) -> None:
    need("cyclonedds")
    for _ in range(30):
        simulation.step()  # later subscribers also get /tf_static
    said = talk("cyclone_peer.py", simulation.step)
    fixed = {t["child_frame_id"]: t for t in said["/tf_static"][-1]["transforms"]}
    assert fixed["robot/odom"]["header"]["frame_id"] == "map"
    assert fixed["robot/odom"]["transform"]["translation"]["x"] == pytest.approx(1.0, abs=1e-3)
    assert fixed["robot/odom"]["transform"]["translation"]["y"] == pytest.approx(2.0, abs=1e-3)
    assert fixed["robot/odom"]["transform"]["rotation"]["z"] == pytest.approx(math.sqrt(0.5), abs=1e-3)
    assert fixed["robot/scan"]["header"]["frame_id"] == "robot/base_link"
    assert fixed["robot/scan"]["transform"]["translation"] == pytest.approx({"x": 0.2, "y": 0.0, "z": 0.6}, abs=1e-6)
    parents = [t["child_frame_id"] for t in said["/tf_static"][-1]["transforms"]]
    assert len(parents) == len(set(parents)), "one parent for each frame"
    (moving,) = said["/tf"][-1]["transforms"]
    assert (moving["header"]["frame_id"], moving["child_frame_id"]) == ("robot/odom", "robot/base_link")
    assert seconds(moving["header"]["stamp"]) > 0.0
    assert moving["transform"]["translation"] == pytest.approx({"x": 0.0, "y": 0.0, "z": 0.0}, abs=0.02)


@pytest.mark.skipif(
    sys.platform != "linux", reason="other systems cannot tell sockets to take packets of one interface"
)
def test_nothing_of_other_machines_is_received(simulation: Any) -> None:
    """UDP sockets are bound to the loopback device, whatever their address."""
    devices = []
    for name in os.listdir("/proc/self/fd"):
        try:
            with socket.socket(fileno=os.dup(int(name))) as one:
                if one.type == socket.SOCK_DGRAM and one.family in (socket.AF_INET, socket.AF_INET6):
                    devices.append(one.getsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, 16))
        except OSError:
            continue  # not a socket
    assert set(devices) == {b"lo\0"}
    assert "this machine only" in simulation.context.stream_managers[MANAGER].backend.opens
    assert not {"ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOCALHOST_ONLY"} & os.environ.keys(), (
        "other programs are not meant"
    )


if "rclpy" not in BACKENDS:

    @pytest.mark.timeout(300)
    @pytest.mark.peer("ros-jazzy-rclpy", does="the same with the backend rclpy")
    def test_the_same_by_the_python_that_has_rclpy() -> None:
        """The simulation itself over rclpy; the wheels of ROS 2 need a separate Python."""
        need("rclpy", PYTHON)
        command = [PYTHON, "-m", "pytest", "-n0", "-q", "-p", "no:cacheprovider", "-k", "rclpy", __file__]
        done = subprocess.run(command, env=lent(), capture_output=True, text=True, timeout=280, check=False)
        assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-2000:]
        assert " passed" in done.stdout
