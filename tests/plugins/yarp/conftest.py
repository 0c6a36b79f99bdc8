from collections.abc import Iterator
from typing import Any

import pytest
from yarp_names import Names

from tests.kit.scenes import Load

SCENE = """
from morse.builder import *
robot = FakeRobot()
robot.translate(1.0, 2.0, 0.5)
{components}
env = Environment("{world}", fastmode={fastmode})
env.configure_stream_manager("yarp", port={port})
"""


@pytest.fixture
def names() -> Iterator[Names]:
    made = Names()
    yield made
    made.close()


@pytest.fixture
def load(load: Load) -> Load:
    """Loads a robot with some components."""

    def start(port: int, components: str, world: str = "empty", fastmode: bool = True, **options: Any) -> Any:
        text = SCENE.format(components=components, port=port, world=world, fastmode=fastmode)
        return load(text, sockets=True, **options)

    return start
