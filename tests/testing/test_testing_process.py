"""Start, failure and end of simulations; with a replacement for the simulator."""

import socket
from collections.abc import Callable
from pathlib import Path

import pytest

from morse.testing.exceptions import MorseTestingError
from morse.testing.process import SimulationProcess, preferred_port

Install = Callable[[str], None]

SERVES = """
print("PID:", os.getpid(), flush=True)
server = socket.create_server(("127.0.0.1", 0))
print("services are on port", server.getsockname()[1], flush=True)
print(sys.argv[1:], os.environ["MORSE_SOCKET_PORT"], flush=True)
print("[SCENE INITIALIZED]", flush=True)
"""
QUITS = """
connection, _ = server.accept()
print("got", connection.recv(100), flush=True)
"""


def start(tmp_path: Path, port: int = 0) -> SimulationProcess:
    return SimulationProcess(tmp_path / "scene", tmp_path / "log", port=port)


def test_it_runs_and_ends_when_told_to(tmp_path: Path, fake_morse: Install) -> None:
    fake_morse(SERVES + QUITS + 'print("[EXITING SIMULATION]")')
    process = start(tmp_path, 4321)
    process.wait_initialized()
    assert process.pid == process._process.pid
    process.stop()
    log = (tmp_path / "log").read_text()
    assert f"['run', '--headless', '{tmp_path / 'scene'}'] 4321" in log
    assert "got b'id1 simulation quit\\n'" in log


def test_an_error_in_the_scene_is_quoted(tmp_path: Path, fake_morse: Install) -> None:
    fake_morse('print("[ERROR][MORSE] no robot Morsi", flush=True); time.sleep(60)')
    process = start(tmp_path)
    with pytest.raises(MorseTestingError, match=r"did not start: \[ERROR\]\[MORSE\] no robot Morsi"):
        process.wait_initialized()
    assert process._process.poll() is not None


def test_an_early_end_is_reported_with_the_end_of_the_log(tmp_path: Path, fake_morse: Install) -> None:
    fake_morse('print("a last word"); sys.exit(3)')
    with pytest.raises(MorseTestingError, match=r"(?s)status 3.*a last word"):
        start(tmp_path).wait_initialized()


def test_a_start_that_takes_too_long_is_given_up(tmp_path: Path, fake_morse: Install) -> None:
    fake_morse('print("loading", flush=True); time.sleep(60)')
    process = start(tmp_path)
    process.watch.wait(lambda: bool(process.watch.tail), 60)
    with pytest.raises(MorseTestingError, match=r"(?s)within 0.1 s.*loading"):
        process.wait_initialized(0.1)
    assert process._process.poll() is not None


def test_a_simulation_that_does_not_end_is_killed(
    tmp_path: Path, fake_morse: Install, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("morse.testing.process._END_TIMEOUT", 0.2)
    monkeypatch.setattr("morse.testing.process._KILL_TIMEOUT", 0.2)
    fake_morse("import signal; signal.signal(signal.SIGTERM, signal.SIG_IGN)" + SERVES + "time.sleep(60)")
    process = start(tmp_path)
    process.wait_initialized()
    with pytest.raises(MorseTestingError, match="was killed"):
        process.stop()
    assert process._process.poll() is not None


def test_a_simulation_that_broke_off_is_reported(tmp_path: Path, fake_morse: Install) -> None:
    fake_morse(SERVES + 'print("oops", flush=True); os._exit(7)')
    process = start(tmp_path)
    process.wait_initialized()
    with pytest.raises(MorseTestingError, match=r"(?s)failed, with status 7.*oops"):
        process.stop()


def test_a_scene_that_is_to_be_refused(tmp_path: Path, fake_morse: Install) -> None:
    fake_morse('print("[ERROR][MORSE] not like that"); sys.exit(1)')
    assert start(tmp_path).wait_refused() == "[ERROR][MORSE] not like that"


def test_a_scene_that_should_have_been_refused(tmp_path: Path, fake_morse: Install) -> None:
    fake_morse(SERVES + QUITS)
    process = start(tmp_path)
    with pytest.raises(MorseTestingError, match="none was reported"):
        process.wait_refused(60)
    assert process._process.poll() is not None


def test_a_port_in_use_is_not_preferred() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        assert preferred_port(port) == 0
    assert preferred_port(port) == port
