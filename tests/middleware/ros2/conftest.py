from typing import Any

import pytest
from desk import Desk

from tests.kit.scenes import Load

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
def start(load: Load, monkeypatch: pytest.MonkeyPatch) -> Load:
    """Loads a robot with some components; a desk collects the published messages."""
    typesys = pytest.importorskip("rosbags.typesys", reason="rosbags is not installed: pip install rosbags")
    desk = Desk(typesys.get_typestore(typesys.Stores.ROS2_JAZZY))
    monkeypatch.setattr("morse.middleware.ros2.domain.make_backend", lambda options: desk)

    def start(
        components: str,
        options: str = "",
        name: str = "robot",
        connected: str = 'robot.add_default_interface("ros2")',
        **arguments: Any,
    ) -> tuple[Any, Desk]:
        text = SCENE.format(components=components, options=options, name=name, connected=connected)
        return load(text, sockets=True, **arguments), desk

    return start
