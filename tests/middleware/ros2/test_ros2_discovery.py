"""Nodes with the default settings of ROS find the simulation, whichever starts first."""

import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from other_side import DOMAIN, PYTHON, SETTINGS, environment, need

import morse

HERE = Path(__file__).parent
LIMIT = 60.0
SCENE = f"""
from morse.builder import *
robot = ATRV()
robot.translate(x=1.0)
robot.append(Pose("pose"))
robot.add_default_interface("ros2")
env = Environment("empty")
env.configure_stream_manager("ros2", domain_id={DOMAIN}, backend="cyclonedds")
"""


class Reader:
    """The node in a process of its own."""

    def __init__(self, folder: Path, simulations: int = 1, **variables: str) -> None:
        self._said = folder / "said"
        command = [PYTHON, str(HERE / "discovery_peer.py"), str(DOMAIN), str(simulations)]
        with self._said.open("w") as said:
            self.process = subprocess.Popen(
                command, stdout=said, stderr=subprocess.STDOUT, env={**environment(PYTHON), **variables}
            )

    def hears(self, line: str, step: Any = lambda: time.sleep(0.05)) -> bool:
        end = time.monotonic() + LIMIT
        while line not in self._said.read_text() and time.monotonic() < end:
            step()
        return line in self._said.read_text()


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    need("cyclonedds")
    need("rclpy", PYTHON)
    for name in SETTINGS:
        monkeypatch.delenv(name, raising=False)
    file = tmp_path / "scene.py"
    file.write_text(SCENE)
    return file


@pytest.mark.parametrize(
    "variables", [{}, {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}], ids=["default", "localhost"]
)
@pytest.mark.peer("ros-jazzy-rclpy")
def test_a_node_that_starts_after_the_simulation_finds_it(
    scene: Path, tmp_path: Path, variables: dict[str, str]
) -> None:
    with morse.load(scene, sockets=True) as sim:
        sim.step(60)
        reader = Reader(tmp_path, **variables)

        def step() -> None:
            sim.step()
            time.sleep(0.01)

        try:
            assert reader.hears("heard 1", step)
        finally:
            reader.process.kill()
            reader.process.wait()


@pytest.mark.slow
@pytest.mark.peer("ros-jazzy-rclpy")
def test_a_node_that_started_before_finds_each_simulation_that_replaces_a_killed_one(
    scene: Path, tmp_path: Path
) -> None:
    reader = Reader(tmp_path, simulations=2)
    try:
        assert reader.hears("ready")
        for place in (1, 2):
            scene.write_text(SCENE.replace("x=1.0", f"x={place}.0"))
            simulation = subprocess.Popen(
                [sys.executable, "-m", "morse", "run", "--headless", str(scene)],
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                cwd=tmp_path,
                env={**environment(sys.executable), "MORSE_SOCKET_PORT": "0"},
            )
            try:
                assert reader.hears(f"heard {place}")
            finally:
                simulation.kill()
                simulation.wait()
    finally:
        reader.process.kill()
        reader.process.wait()
