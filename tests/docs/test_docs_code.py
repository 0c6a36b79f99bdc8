"""The examples of the documentation run, with the documented results."""

import contextlib
import logging
import math
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from doc_pages import DOCS, Block, blocks, named

import morse
from morse.cli.app import execute
from morse.testing.process import SimulationProcess
from pymorse import Morse, MorseServiceFailed, MorseServicePreempted

pytestmark = pytest.mark.long

# tests/middleware runs the examples that need another program
ELSEWHERE = {
    DOCS / f"{name}.md"
    for name in ("ros1", "ros2", "text-files", "rosbridge", "foxglove", "mqtt", "moos", "yarp", "mavlink", "multinode")
}
SCENES = [
    block
    for block in blocks("python")
    if block.is_scene and "ranger_sim" not in block.text and block.page not in ELSEWHERE
]
# tests/journey runs the examples of the tutorial, in their own scenes
CLIENTS = [block for block in blocks("python") if block.is_client and block.page != DOCS / "tutorial.md"]


def begin_again(process: SimulationProcess) -> int:
    """The port of a simulation, after a restart."""
    with Morse("127.0.0.1", process.port) as simu:
        simu.reset(0)
        simu.resume()
    return process.port


@pytest.fixture(scope="module")
def ranger(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[[], int]]:
    """Begins a simulation of the scene that `morse create` creates, a robot with motion and pose: its port."""
    folder = tmp_path_factory.mktemp("template")
    started: list[SimulationProcess] = []

    def begin() -> int:
        if started:
            with contextlib.suppress(ConnectionError):  # a client has ended it
                return begin_again(started[-1])
        process = SimulationProcess(
            folder / "example_sim" / "default.py",
            folder / f"log{len(started)}",
            options=("--headless", "--strict"),
        )
        started.append(process)
        process.wait_initialized()
        return process.port

    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HOME", str(folder))
        patch.setenv("USERPROFILE", str(folder))
        patch.chdir(folder)
        assert execute(["create", "example_sim"]) == 0
        yield begin
    for process in started:
        process.kill()
        assert process.watch.error is None


PROGRAMS = [block for block in blocks("python") if block.text.startswith("import morse\n")]


@pytest.mark.parametrize("block", named(PROGRAMS))
def test_programs_run(block: Block, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.setenv("MORSE_RESOURCE_PATH", str(DOCS.parent))  # for models of examples
    script = tmp_path / "program.py"
    script.write_text(block.text, encoding="utf-8")
    done = run([sys.executable, str(script)], tmp_path)
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    assert "warning" not in done.stderr.lower()


def block_with(page: str, text: str) -> str:
    """The block of a page that contains some text."""
    return next(block.text for block in blocks("python") if block.page == DOCS / page and text in block.text)


@pytest.mark.parametrize("block", named(SCENES))
def test_scenes_run(block: Block, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture):
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    script = tmp_path / "example.py"
    # two examples may use the same fixed port at the same time
    script.write_text(block.text.replace("sync_port=6000", "sync_port=0"), encoding="utf-8")
    with morse.load(script, sockets=True, strict=True, speed=math.inf) as simulation:
        simulation.step(30)
        assert simulation.robots
        assert simulation.context.failed == set()
    assert [record.getMessage() for record in caplog.records if record.levelno >= logging.WARNING] == []


@pytest.mark.parametrize("block", named(CLIENTS))
def test_clients_run(block: Block, ranger: Callable[[], int], tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    script = tmp_path / "client.py"
    script.write_text(block.text, encoding="utf-8")
    monkeypatch.setenv("MORSE_SOCKET_PORT", str(ranger()))
    done = run([sys.executable, str(script)], tmp_path)
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr


def test_loops_name_their_robots(simulate, tmp_path: Path):
    script = tmp_path / "loop.py"
    script.write_text(block_with("scenes.md", "close_context"), encoding="utf-8")
    simu = simulate(script)
    assert set(simu.robots) == {"m", "m_001", "m_002", "chief"}
    assert len(simu.ms) == 3


def test_the_transcript_of_the_socket(ranger: Callable[[], int]):
    import socket

    (transcript,) = [block.text for block in blocks("text") if block.page == DOCS / "socket.md"]
    with socket.create_connection(("127.0.0.1", ranger()), timeout=60) as connection:
        replies = connection.makefile(encoding="utf-8")
        for line in transcript.splitlines():
            way, _, text = line.partition(" ")
            if way == "→":
                connection.sendall(text.encode() + b"\n")
                continue
            assert way == "←"
            reply = replies.readline().rstrip("\n")
            if "…" in text:
                assert reply.startswith(text.partition("…")[0])
            else:
                assert reply == text


def own_component(folder: Path, code: str, name: str, kind: str, robot: str) -> Path:
    """A scene with a user's component on a robot: path of the script."""
    package = folder / "own"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "part.py").write_text(code, encoding="utf-8")
    base = f"{kind.capitalize()}Creator"
    script = folder / "scene.py"
    script.write_text(
        "from morse.builder import *\n"
        f"class {name}({base}):\n"
        f"    _classpath = 'own.part.{name}'\n"
        f"{robot}\n"
        f"part = {name}()\n"
        "robot.append(part)\n"
        "robot.add_default_interface('socket')\n"
        "env = Environment('empty')\n"
    )
    return script


def test_a_service_that_takes_its_time(simulate, tmp_path: Path):
    code = block_with("services.md", "class Door(Actuator)")
    simu = simulate(own_component(tmp_path, code, "Door", "actuator", "robot = FakeRobot()"))
    door = simu.robot.part
    simu.rpc("simulation", "pause")
    opening = door.open_to(0.2)
    # half a radian a second, 60 ticks a second: a fifth is reached after 24 ticks
    simu.rpc("simulation", "step", 20)
    assert not opening.done()
    assert door.get_angle().result() == pytest.approx(20 * 0.5 / 60)
    simu.rpc("simulation", "step", 10)
    assert opening.result(60) == pytest.approx(0.2)
    first, second = door.open_to(1.0), door.open_to(0.0)
    with pytest.raises(MorseServicePreempted):
        first.result(60)
    second.cancel()
    with pytest.raises(MorseServicePreempted):
        second.result(60)
    with pytest.raises(MorseServiceFailed):
        door.open_to("wide").result(60)


def test_random_numbers_follow_from_the_seed(simulate, tmp_path: Path):
    code = block_with("time.md", "class Dice(Sensor)")
    simu = simulate(own_component(tmp_path, code, "Dice", "sensor", "robot = FakeRobot()"))

    def throws(seed: int) -> list[Any]:
        simu.rpc("simulation", "pause")
        simu.rpc("simulation", "reset", seed)
        found = []
        for _ in range(20):
            simu.rpc("simulation", "step")
            found.append(simu.robot.part.get_local_data().result()["eyes"])
        return found

    first = throws(7)
    assert throws(7) == first
    assert throws(8) != first
    assert set(first) <= set(range(1, 7))


def test_the_pytest_example(tmp_path: Path):
    (tmp_path / "conftest.py").write_text(block_with("testing.md", "pytest_plugins"), encoding="utf-8")
    (tmp_path / "test_it.py").write_text(block_with("testing.md", "def test_it_drives("), encoding="utf-8")
    (tmp_path / "test_both.py").write_text(block_with("testing.md", "def test_it_drives_both"), encoding="utf-8")
    done = run([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"], tmp_path)
    assert done.returncode == 0, done.stdout
    assert "3 passed" in done.stdout


def test_the_unittest_example(tmp_path: Path):
    (tmp_path / "stands.py").write_text(block_with("testing.md", "MorseTestCase"), encoding="utf-8")
    done = run([sys.executable, "stands.py"], tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "OK" in done.stderr


def run(command: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a program in a folder."""
    source = os.path.dirname(os.path.dirname(morse.__file__))
    path = os.pathsep.join(filter(None, [source, os.environ.get("PYTHONPATH")]))
    return subprocess.run(
        command,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )


def test_the_stepping_example_gives_the_same_numbers_twice(ranger: Callable[[], int], tmp_path: Path, monkeypatch):
    script = tmp_path / "client.py"
    script.write_text(block_with("services.md", "simu.step("), encoding="utf-8")
    monkeypatch.setenv("MORSE_SOCKET_PORT", str(ranger()))
    outputs = [run([sys.executable, str(script)], tmp_path).stdout for _ in range(2)]
    assert len(outputs[0].splitlines()) == 100
    assert outputs[0] == outputs[1]
