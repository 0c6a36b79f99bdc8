"""A package adds message kinds and their messages of ROS by entry points."""

import subprocess
import sys
from pathlib import Path

import pytest

KINDS = """
from morse.core.kinds import Kind, Slot
KINDS = [Kind("wind", {"speed": Slot("speed", unit="m/s")}, True, False, 1, "The wind.")]
"""
ROS = """
from morse.rosmsgs.parts import header
from morse.rosmsgs.table import Outlet, RosExtension, TopicTable, topics

class Wind(TopicTable):
    @topics("wind")
    def wind(self, stream, bound):
        return [Outlet("my_msgs/msg/Wind", lambda m, f: {"header": header(m, f), "speed": m.speed})]

    @topics("pose")
    def pose(self, stream, bound):
        return []

MESSAGES = RosExtension(Wind(), MESSAGE)
"""
VANE = """
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind

class Anemometer(Sensor):
    _name = "Anemometer"
    _short_desc = "The speed of the wind"
    add_data("speed", 7.0, "float", "Speed", unit="m/s")
    add_kind("wind", speed="speed")
"""
PROGRAM = """
import logging
logging.basicConfig()
import morse
from morse.recording.recording import Recording
from morse.rosmsgs.cdr import decode
from morse.builder import *
def scene():
    robot = FakeRobot()
    vane, pose = Anemometer(), Pose()
    robot.append(vane)
    robot.append(pose)
    Environment("empty", fastmode=True)
with morse.load(scene, sockets=False, record="run.mcap") as simulation:
    simulation.step(3)
with Recording("run.mcap") as recording:
    for channel in sorted(recording.channels.values(), key=lambda one: one.topic):
        if channel.topic in ("/robot/vane", "/robot/pose"):
            message = next(iter(recording.messages({channel.number})))
            data = decode(channel.type, bytes(message.data))
            print(channel.topic, channel.type, data.get("speed", ""), "float32 speed" in channel.definition)
"""


@pytest.fixture
def site(tmp_path: Path) -> Path:
    points = (
        "[morse.components]\nmy_lab = my_lab\n[morse.kinds]\nmy_lab = my_lab.kinds:KINDS\n"
        "[morse.ros_messages]\nmy_lab = my_lab.ros:MESSAGES\n"
    )
    for path, text in {
        "my_lab/__init__.py": "",
        "my_lab/kinds.py": KINDS,
        "my_lab/ros.py": ROS.replace("MESSAGE)", repr("my_msgs/Wind: std_msgs/Header header, float32 speed") + ")"),
        "my_lab/sensors/vane.py": VANE,
        "my_lab-1.0.dist-info/METADATA": "Metadata-Version: 2.1\nName: my_lab\nVersion: 1.0\n",
        "my_lab-1.0.dist-info/entry_points.txt": points,
    }.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text)
    return tmp_path


def run(site: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", f"import sys; sys.path.append({str(site)!r})\n" + PROGRAM]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False, cwd=site)


def test_a_message_of_a_package_is_recorded_with_its_definition(site: Path) -> None:
    done = run(site)
    assert done.stdout.splitlines() == [
        "/robot/pose geometry_msgs/msg/PoseStamped  False",  # no package changes the topics of MORSE
        "/robot/vane my_msgs/msg/Wind 7.0 True",
    ], done.stderr


@pytest.mark.parametrize(
    ("messages", "warning"),
    [
        ("my_msgs/Wind: my_msgs/Nothing speed", "the field 'speed' has the unknown type 'my_msgs/msg/Nothing'"),
        ("my_msgs/Wind: float32 a-b", "the field 'a-b' has the unknown type"),
        ("a line of anything", "expected 'package/Name: type name, type name'"),
        (7, "expected a morse.rosmsgs.table.RosExtension"),
    ],
)
def test_a_definition_that_is_none_is_left_out_with_a_warning(site: Path, messages: object, warning: str) -> None:
    (site / "my_lab" / "ros.py").write_text(ROS.replace("MESSAGE)", f"{messages!r})"))
    done = run(site)
    assert warning in done.stderr
    assert "/robot/pose geometry_msgs/msg/PoseStamped  False" in done.stdout, done.stderr


def test_a_package_that_fails_is_left_out_with_a_warning(site: Path) -> None:
    (site / "my_lab" / "ros.py").write_text("raise SystemExit\n")
    done = run(site)
    assert "the ROS messages of my_lab.ros:MESSAGES are left out" in done.stderr
    assert "/robot/vane std_msgs/msg/String" in done.stdout, done.stderr
