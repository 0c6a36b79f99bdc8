"""Test cases with a middleware: its server runs during the test, and a missing server is reported."""

import contextlib
import socket
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from morse.testing.exceptions import MorseTestingError
from morse.testing.moos import MOOSTestCase
from morse.testing.process import Daemon
from morse.testing.ros import RosTestCase

SERVER = """
port = int(re.search(r"[0-9]+$", sys.argv[-1])[0])
server = socket.socket()
server.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
server.bind(("127.0.0.1", port))
server.listen()
while True:
    server.accept()
"""


@pytest.fixture
def program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str, str], None]:
    """Install a program on an otherwise empty PATH."""
    monkeypatch.setenv("PATH", str(tmp_path))

    def install(name: str, text: str) -> None:
        file = tmp_path / name
        file.write_text(f"#!{sys.executable}\nimport re, socket, sys, time\n{text}\n")
        file.chmod(0o755)

    return install


@pytest.fixture
def port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def listens(port: int) -> bool:
    with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), 1.0):
        return True
    return False


def test_roscore_runs_during_the_test(
    program: Callable[[str, str], None], port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    program("roscore", SERVER)
    monkeypatch.setenv("ROS_MASTER_URI", f"http://localhost:{port}")
    case = RosTestCase()
    case.setUpMw()
    try:
        assert listens(port)
    finally:
        case.doCleanups()
    assert not listens(port)


def test_moosdb_runs_during_the_test(
    program: Callable[[str, str], None], port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    program("MOOSDB", SERVER)
    monkeypatch.setattr(MOOSTestCase, "moos_port", port)
    case = MOOSTestCase()
    case.setUpMw()
    try:
        assert listens(port)
    finally:
        case.doCleanups()
    assert not listens(port)


@pytest.mark.usefixtures("program")
def test_a_missing_middleware_is_named(port: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", f"http://localhost:{port}")
    with pytest.raises(MorseTestingError, match=r"'roscore', which is not on the PATH: install ROS 1"):
        RosTestCase().setUpMw()
    monkeypatch.setattr(MOOSTestCase, "moos_port", port)
    with pytest.raises(MorseTestingError, match=r"'MOOSDB', which is not on the PATH: install MOOS"):
        MOOSTestCase().setUpMw()


def test_a_server_that_already_runs_is_used_and_left(port: int) -> None:
    with socket.create_server(("127.0.0.1", port)):
        Daemon(["no-such-program"], port, "").stop()
        assert listens(port)


def test_a_server_that_ends_or_never_listens_is_an_error(program: Callable[[str, str], None], port: int) -> None:
    program("ends", "sys.exit(3)")
    with pytest.raises(MorseTestingError, match="'ends' ended with status 3"):
        Daemon(["ends"], port, "")
    program("deaf", "time.sleep(60)")
    with pytest.raises(MorseTestingError, match=f"'deaf' did not listen on port {port} within 0.3 s"):
        Daemon(["deaf"], port, "", timeout=0.3)
