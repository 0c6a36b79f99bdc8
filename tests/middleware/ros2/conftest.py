from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from desk import Desk

import morse

SCENE = """
from morse.builder import *
robot = ATRV("{name}")
robot.translate(1.0, 2.0, 0.0)
{components}
{connected}
env = Environment("empty")
{options}
"""


@pytest.fixture
def start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., tuple[Any, Desk]]]:
    """Loads a robot with some components; a desk collects the published messages."""
    typesys = pytest.importorskip("rosbags.typesys", reason="rosbags is not installed: pip install rosbags")
    desk = Desk(typesys.get_typestore(typesys.Stores.ROS2_JAZZY))
    monkeypatch.setattr("morse.middleware.ros2.domain.make_backend", lambda options: desk)
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    running = []

    def load(
        components: str,
        options: str = "",
        name: str = "robot",
        connected: str = 'robot.add_default_interface("ros2")',
        **arguments: Any,
    ) -> tuple[Any, Desk]:
        scene = tmp_path / "scene.py"
        scene.write_text(SCENE.format(components=components, options=options, name=name, connected=connected))
        running.append(morse.load(scene, sockets=True, **arguments))
        return running[-1], desk

    yield load
    for sim in running:
        sim.close()
