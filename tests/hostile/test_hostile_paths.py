"""Pipes, devices and very large files in place of files that MORSE reads: refused at once, with the reason."""

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import morse
from morse.assets.loader import load
from morse.cli.messages import CommandError
from morse.cli.sites import Sites
from morse.simulation.states.state import State
from morse.system.regular_files import SOURCE_LIMIT, read_regular
from morse.viewer.feeds.sensors import read_sound

pytestmark = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes with names")

SENSOR = """
from morse.core.sensor import Sensor
from morse.core.declarations import add_data

class Eye(Sensor):
    _name = "Eye"
    _short_desc = "Looks"
    add_data("seen", VALUE, "int", "what it sees")
    def default_action(self):
        self.local_data["seen"] = VALUE
"""
SCENE = """
from morse.builder import *
from shop.sensors.eye import Eye
robot = ATRV()
eye = Eye()
robot.append(eye)
env = Environment("empty", fastmode=True)
"""


def _pipe(path: Path) -> None:
    path.unlink(missing_ok=True)
    os.mkfifo(path)


def _device(path: Path) -> None:
    path.unlink(missing_ok=True)
    path.symlink_to("/dev/zero")


def _large(path: Path) -> None:
    path.unlink(missing_ok=True)
    path.write_bytes(b"x = 1\n" * (SOURCE_LIMIT // 6 + 1))


REPLACED = {"a pipe": _pipe, "a device": _device, "larger than": _large}


def soon(call: Callable[[], object]) -> BaseException:
    """The error of a call, which must not wait for anybody."""
    raised: list[BaseException] = []

    def run() -> None:
        try:
            call()
        except BaseException as error:
            raised.append(error)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    thread.join(60.0)
    assert not thread.is_alive()
    assert raised
    return raised[0]


@pytest.mark.parametrize("what", REPLACED)
@pytest.mark.parametrize(
    "read",
    [
        lambda path: read_regular(path),
        lambda path: Sites(path),
        lambda path: ast_of_script(path),
    ],
    ids=["bytes", "configuration", "script"],
)
def test_a_file_that_is_read_whole(tmp_path: Path, what: str, read: Callable[[Path], object]) -> None:
    path = tmp_path / "file.py"
    REPLACED[what](path)
    error = soon(lambda: read(path))
    assert isinstance(error, (OSError, CommandError))
    assert what in str(error)
    assert str(path) in str(error)


def ast_of_script(path: Path) -> object:
    from morse.builder.script import _run
    from morse.core.classes.project_imports import ProjectImports

    return _run(path, ProjectImports(), None)


@pytest.mark.parametrize("suffix", [".glb", ".obj", ".stl", ".ply", ".dae", ".urdf", ".xml", ".blend"])
@pytest.mark.parametrize("what", ["a pipe", "a device"])
def test_models(tmp_path: Path, suffix: str, what: str) -> None:
    path = tmp_path / f"model{suffix}"
    REPLACED[what](path)
    assert "regular file" in str(soon(lambda: load(path)))


@pytest.mark.parametrize("what", ["a pipe", "a device"])
def test_states_and_sounds(tmp_path: Path, what: str) -> None:
    path = tmp_path / "file"
    REPLACED[what](path)
    assert what in str(soon(lambda: State.read(path)))
    assert str(soon(lambda: read_sound(path)))


@pytest.mark.parametrize("what", REPLACED)
def test_the_class_of_a_running_component(tmp_path: Path, what: str, caplog: pytest.LogCaptureFixture) -> None:
    """The simulation goes on with the old class, and the log says what the file is."""
    source, script = tmp_path / "src" / "shop" / "sensors" / "eye.py", tmp_path / "scene.py"
    source.parent.mkdir(parents=True)
    source.write_text(SENSOR.replace("VALUE", "1"))
    script.write_text(SCENE)
    with morse.load(script, watch=True) as simulation:
        simulation.step(2)
        beside = tmp_path / "new"
        REPLACED[what](beside)
        beside.replace(source)
        last = time.monotonic() + 60.0
        while what not in caplog.text and time.monotonic() < last:
            simulation.step()
            time.sleep(0.02)
        assert what in caplog.text
        before = simulation.ticks
        simulation.step(3)
        assert simulation.ticks == before + 3
        assert simulation.context.component("robot.eye").local_data["seen"] == 1


def test_the_command_says_what_a_scene_is(tmp_path: Path) -> None:
    scene = tmp_path / "scene.py"
    _pipe(scene)
    command = [sys.executable, "-c", "from morse.cli import main; main()", "run", "--headless", str(scene)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode != 0
    assert "Traceback" not in done.stdout + done.stderr
