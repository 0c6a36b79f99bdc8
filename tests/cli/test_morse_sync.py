import io
import socket
import subprocess
import sys
import time
from collections.abc import Iterator

import pytest

from morse.cli.morse_sync import Pace, main


@pytest.mark.parametrize("overhead", [0.0, 0.004, 0.009])
def test_rounds_become_as_long_as_the_period_whatever_else_takes_time(overhead: float) -> None:
    pace = Pace(0.01)
    for _ in range(200):
        pace.took(pace.sleep + overhead)
    assert pace.sleep + overhead == pytest.approx(0.01, rel=1e-3)


def test_a_period_that_cannot_be_met_is_run_without_sleep() -> None:
    pace = Pace(0.01)
    for _ in range(200):
        pace.took(pace.sleep + 0.02)
    assert pace.sleep == 0.0


@pytest.fixture
def server() -> Iterator[socket.socket]:
    with socket.create_server(("127.0.0.1", 0)) as listening:
        listening.settimeout(60)
        yield listening


def start(port: int, *options: str) -> subprocess.Popen[str]:
    program = "import sys; from morse.cli.morse_sync import main; sys.exit(main())"
    words = [sys.executable, "-c", program, "-H", "127.0.0.1", "-P", str(port), *options]
    return subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def receive(connection: socket.socket, count: int) -> bytes:
    data = b""
    while len(data) < count:
        more = connection.recv(count - len(data))
        assert more, "the other side has closed the connection"
        data += more
    return data


def test_it_sends_sync_once_a_period_and_obeys(server: socket.socket) -> None:
    begin = time.monotonic()
    process = start(server.getsockname()[1], "-p", "0.05")
    connection, _ = server.accept()
    connection.settimeout(60)
    assert receive(connection, 4 * 21) == b"sync" * 21
    assert time.monotonic() - begin > 20 * 0.05
    assert process.stdin is not None
    process.stdin.write("faster\nset_period x\nset_period 0.001\n")
    process.stdin.flush()
    assert receive(connection, 4 * 100) == b"sync" * 100
    _, err = process.communicate("quit\n", timeout=60)
    assert process.returncode == 0
    assert "'faster' is not a command" in err
    assert "'x' is not a number of seconds" in err
    connection.close()


def test_it_ends_with_the_simulation(server: socket.socket) -> None:
    process = start(server.getsockname()[1], "-p", "0.01", "-d")
    connection, _ = server.accept()
    connection.settimeout(60)
    receive(connection, 4)
    connection.close()
    _, err = process.communicate(timeout=60)
    assert process.returncode == 0
    assert "the simulation has ended" in err
    assert "period 0.0" in err


def test_no_simulation(
    server: socket.socket, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    port = server.getsockname()[1]
    server.close()
    assert main(["-p", "1", "-t", "0.2", "-H", "127.0.0.1", "-P", str(port)]) == 1
    assert f"127.0.0.1:{port}: no simulation listens there" in capsys.readouterr().err


@pytest.mark.parametrize(
    "arguments", [[], ["-p", "0"], ["-p", "-1"], ["-p", "x"], ["-p", "nan"], ["-p", "1", "-P", "x"]]
)
def test_wrong_options(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert ended.value.code == 2
    assert "morse_sync: error" in capsys.readouterr().err


@pytest.mark.parametrize("port", ["0", "65536", "-1", "6000.5", "99999999999999999999", "\u0661", ""])
def test_a_port_that_is_none_is_named(port: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["-p", "0.1", f"-P{port}" if port else "--port="])
    assert f"'{port}' is not a TCP port from 1 to 65535" in capsys.readouterr().err
