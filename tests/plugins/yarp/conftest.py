from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from yarp_names import Names

import morse

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
def load(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Any]]:
    """Loads a robot with some components."""
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    running = []

    def made(port: int, components: str, world: str = "empty", fastmode: bool = True, **options: Any) -> Any:
        script = tmp_path / "scene.py"
        script.write_text(SCENE.format(components=components, port=port, world=world, fastmode=fastmode))
        running.append(morse.load(script, sockets=True, **options))
        return running[-1]

    yield made
    for sim in running:
        sim.close()
