"""Scenes that were not made for ROS."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from desk import Desk
from other_side import DOMAIN, need

PARTS = """
robot.append(MotionVW("motion"))
robot.append(Pose("pose"))
robot.append(Odometry("first"))
second = Odometry("second"); second.translate(0.5); robot.append(second)
near = Proximity("near"); robot.append(near)
pair = StereoUnit("pair"); robot.append(pair)
"""


@pytest.mark.parametrize("how", ["command line", "scene"])
def test_everything_is_connected(start: Callable[..., tuple[Any, Desk]], how: str) -> None:
    if how == "scene":
        sim, desk = start(PARTS, "env.add_default_interface('ros2')", connected="")
    else:
        sim, desk = start(PARTS, connected="", interfaces=["ros2"])
    sim.step(2)
    assert {"/robot/pose", "/robot/first", "/robot/second", "/robot/near"} <= desk.publishers.keys()
    assert {"/robot/motion", "/robot/cmd_vel"} <= desk.subscriptions.keys()
    (moving,) = [t for t in desk.last("/tf").transforms if t.child_frame_id == "robot/base_link"]
    assert moving.header.frame_id == "robot/odom", "the first odometry counts"


def test_who_comes_later_is_connected_too(start: Callable[..., tuple[Any, Desk]]) -> None:
    sim, desk = start("", "env.add_default_interface('ros2')", connected="")

    def another() -> Any:
        from morse.builder import ATRV, Pose

        robot = ATRV()
        robot.append(Pose("pose"))
        return robot

    sim.spawn("other", another)
    sim.step(2)
    assert desk.last("/other/pose").header.frame_id == "map"


def test_what_the_script_says_of_a_stream_holds(start: Callable[..., tuple[Any, Desk]]) -> None:
    _, desk = start(
        "pose = Pose(); robot.append(pose); pose.add_stream('ros2', topic='/where')", connected="", interfaces=["ros2"]
    )
    assert "/where" in desk.publishers
    assert "/robot/pose" not in desk.publishers


def test_an_unknown_middleware_is_refused_in_the_line_of_the_scene(start: Callable[..., tuple[Any, Desk]]) -> None:
    from morse.core.exceptions import MorseError

    with pytest.raises(MorseError, match=r"scene\.py:\d+: there is no middleware 'ros3'; did you mean"):
        start("", "env.add_default_interface('ros3')", connected="")


def test_the_option_of_the_command_line(tmp_path: Path) -> None:
    need("cyclonedds")
    scene = tmp_path / "scene.py"
    scene.write_text("from morse.builder import *\nrobot = ATRV()\nrobot.append(Pose())\nenv = Environment('empty')\n")
    kept = {name: value for name, value in os.environ.items() if name != "CYCLONEDDS_URI"}
    done = subprocess.run(
        [sys.executable, "-m", "morse", "run", "--headless", "--ros2", "--speed", "max", "--duration", "1", str(scene)],
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
        env={**kept, "ROS_DOMAIN_ID": str(DOMAIN), "MORSE_SOCKET_PORT": "0"},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"ros2: cyclonedds, domain {DOMAIN}" in done.stdout or f"ros2: rclpy, domain {DOMAIN}" in done.stdout
    assert "Ros2DatastreamManager" in done.stdout
