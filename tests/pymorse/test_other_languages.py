"""The clients in C++ and JavaScript of `examples/languages` drive a robot."""

import os
import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest
from test_pymorse_aio import Running, running

from tests.kit.waiting import wait_until

pytestmark = pytest.mark.long

__all__ = ["running"]

FOLDER = Path(__file__).parents[2] / "examples" / "languages"
LIMIT = 120.0


def drive(words: Sequence[str | Path], running: Running) -> None:
    environment = {**os.environ, "MORSE_SOCKET_PORT": str(running.port)}
    said = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=LIMIT)
    assert said.returncode == 0, said.stderr
    found = re.search(r"driven ([\d.]+) m", said.stdout)
    assert found is not None
    assert 0.5 <= float(found[1]) < 1.5
    speed = running.sim.context.components["robot.motion"].local_data
    # the last command is taken in a tick after the program has ended
    wait_until(lambda: (speed["v"], speed["w"]) == (0.0, 0.0), limit=LIMIT)


@pytest.mark.skipif(shutil.which("g++") is None, reason="there is no g++")
@pytest.mark.peer("g++", does="the client in C++ of examples drives a robot")
def test_cpp(running: Running, tmp_path: Path) -> None:
    program = tmp_path / "client"
    build = ["g++", "-std=c++17", "-Wall", "-Wextra", "-Werror", "-o", program, FOLDER / "client.cpp"]
    subprocess.run(build, check=True, timeout=LIMIT)
    drive([program], running)
    # without a simulation it says so, instead of hanging
    other = subprocess.run([program], env={"MORSE_SOCKET_PORT": "9"}, capture_output=True, text=True, timeout=LIMIT)
    assert other.returncode == 1
    assert "no simulation on port 9" in other.stderr


@pytest.mark.skipif(shutil.which("node") is None, reason="there is no node")
@pytest.mark.peer("nodejs", does="the client in JavaScript of examples drives a robot")
def test_javascript(running: Running) -> None:
    drive(["node", FOLDER / "client.mjs"], running)
