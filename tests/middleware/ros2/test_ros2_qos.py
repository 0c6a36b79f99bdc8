"""Readers of rclpy that come late, with every quality of service that readers usually have."""

from pathlib import Path

import pytest
from other_side import DOMAIN, PYTHON, SETTINGS, need, talk

import morse

SCENE = """
from morse.builder import *
robot = ATRV()
robot.append(Odometry("odometry"))
eye = VideoCamera("eye"); eye.properties(cam_width=64, cam_height=48); robot.append(eye)
robot.add_default_interface("ros2")
env = Environment("empty")
env.configure_stream_manager("ros2", domain_id={domain}, backend="cyclonedds")
"""


@pytest.mark.peer("ros-jazzy-rclpy", does="late readers of any quality of service, relative names in a namespace")
def test_each_reader_gets_data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    need("cyclonedds")
    need("rclpy", PYTHON)
    for name in SETTINGS:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    (tmp_path / "scene.py").write_text(SCENE.format(domain=DOMAIN))
    with morse.load(tmp_path / "scene.py", sockets=True) as sim:
        sim.step(60)
        seen = talk("qos_peer.py", sim.step, PYTHON)
    assert seen
    assert not [name for name, count in seen.items() if not count]
