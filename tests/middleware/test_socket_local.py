"""The Unix socket of the services, for clients of the same user."""

import os
import socket
import stat
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

import morse
from morse.builder import Environment, FakeRobot, MotionVW, Pose
from morse.core.exceptions import MorseError, MorseMiddlewareError
from morse.middleware.socket.request_manager import listen_locally
from pymorse import Morse

pytestmark = pytest.mark.skipif(not hasattr(socket, "AF_UNIX"), reason="this system has no Unix sockets")
LIMIT = 60.0


def scene() -> None:
    robot = FakeRobot("robot")
    robot.append(Pose("pose"))
    robot.append(MotionVW("motion"))
    robot.add_default_interface("socket")
    Environment("empty", fastmode=True)


@pytest.fixture
def path(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    # a short path, whatever TMPDIR is: systems allow about a hundred bytes
    short = "/tmp" if os.access("/tmp", os.W_OK) else None
    with tempfile.TemporaryDirectory(prefix="m", dir=short) as folder:
        made = Path(folder) / "m.sock"
        monkeypatch.setenv("MORSE_SOCKET_PATH", str(made))
        monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
        yield made


def meanwhile(sim: Any, work: Callable[[], Any]) -> Any:
    """Look after the clients of a paused simulation while another thread works; returns its result."""
    with ThreadPoolExecutor(1) as pool:
        future = pool.submit(work)
        end = time.monotonic() + LIMIT
        while not future.done():
            assert time.monotonic() < end
            sim.step()
        return future.result()


def test_a_client_calls_services_and_reads_streams(path: Path) -> None:
    def work() -> tuple[list[str], Any, Any]:
        with Morse(path=str(path)) as client:
            client.rpc("simulation", "pause")
            seen = client.rpc("simulation", "exchange", {"robot.motion": {"v": 3.0, "w": 0.0}}, ["robot.pose"], 20)
            client.rpc("simulation", "resume")
            return client.robots, seen, client.robot.pose.get(timeout=LIMIT)

    with morse.load(scene, sockets=True) as sim:
        robots, seen, pose = meanwhile(sim, work)
    assert robots == ["robot"]
    # 3 m/s for a third of a second
    assert seen["robot.pose"]["x"] == pytest.approx(1.0, abs=0.06)
    assert pose["x"] >= seen["robot.pose"]["x"]


def test_only_the_owner_may_connect_and_nothing_is_left(path: Path) -> None:
    mask = os.umask(0)
    try:
        with morse.load(scene, sockets=True):
            mode = path.stat().st_mode
            assert os.umask(0) == 0
    finally:
        os.umask(mask)
    assert stat.S_ISSOCK(mode)
    assert stat.S_IMODE(mode) == 0o600
    assert not path.exists()


def test_without_the_variable_there_is_no_such_socket(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("MORSE_SOCKET_PATH")
    with morse.load(scene, sockets=True):
        assert not path.exists()
    with pytest.raises(ConnectionError, match=r"no simulation listens on .*set MORSE_SOCKET_PATH="):
        Morse(path=str(path))


def test_a_socket_that_a_crashed_simulation_left_is_replaced(path: Path) -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as left:
        left.bind(str(path))
    assert path.exists()
    with morse.load(scene, sockets=True), socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as client:
        client.connect(str(path))


def test_what_is_in_the_way_is_named_and_kept(path: Path) -> None:
    path.write_text("precious")
    with pytest.raises(MorseError, match=r"m\.sock exists and is no socket; set another path"):
        morse.load(scene, sockets=True)
    assert path.read_text() == "precious"
    path.unlink()
    with morse.load(scene, sockets=True):
        with pytest.raises(MorseMiddlewareError, match="another simulation listens on"):
            listen_locally(str(path))
        assert path.exists()
    for wrong in (path.parent / "nowhere" / "m.sock", path.parent / ("x" * 200)):
        with pytest.raises(MorseMiddlewareError, match="MORSE_SOCKET_PATH: cannot listen on"):
            listen_locally(str(wrong))
