"""A program that uses pymorse survives any server: it gets an error in time, and its memory is bounded."""

from __future__ import annotations

import contextlib
import json
import socket
import threading
import time
from typing import TYPE_CHECKING, Any

import pytest

from pymorse import Morse, discovery, stream

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[Callable[[socket.socket], object]], int]]:
    """Call it with what is done with each connection; returns the port."""
    monkeypatch.setattr(discovery, "_TIMEOUT", 1.0)
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def start(act: Callable[[socket.socket], object]) -> int:
            def serve() -> None:
                with contextlib.suppress(OSError), listener.accept()[0] as connection:
                    connection.recv(10)
                    act(connection)

            threading.Thread(target=serve, daemon=True).start()
            return int(listener.getsockname()[1])

        yield start


def _repeat(part: bytes) -> Callable[[socket.socket], None]:
    def act(connection: socket.socket) -> None:
        until = time.monotonic() + 60.0  # without a limit in the client, this ends the test
        while time.monotonic() < until:
            connection.sendall(part)

    return act


@pytest.mark.parametrize("part", [b"999 SUCCESS\n" * 1000, b"x\n" * 5000, b"9" * 9999 + b" SUCCESS 1\n"])
def test_timeouts_hold_while_a_server_sends_without_a_pause(
    server: Any, part: bytes, caplog: pytest.LogCaptureFixture
) -> None:
    begin = time.monotonic()
    with pytest.raises(ConnectionError, match="did not list the robots"):
        Morse("127.0.0.1", server(_repeat(part)))
    assert time.monotonic() - begin < 50.0
    assert len(caplog.messages) <= 2


def test_a_line_has_an_end(server: Any, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    monkeypatch.setattr(stream, "MAX_LINE", 1 << 20, raising=False)
    with pytest.raises(ConnectionError, match="closed the connection"):
        Morse("127.0.0.1", server(_repeat(b"x" * 65536)))
    assert "a line of more than 1048576 bytes" in caplog.text


@pytest.mark.parametrize(
    "robots",
    [3, None, [1], [{}], [{"name": 3, "components": {}}], [{"name": "r", "components": [1]}],
     [{"name": "r", "components": {"r.a": [1]}}], [{"name": "r", "components": {"r.a": None}}]],
)  # fmt: skip
def test_an_answer_in_another_format_is_named(server: Any, robots: Any) -> None:
    answer = b"0 SUCCESS " + json.dumps({"robots": robots}).encode() + b"\n"
    with pytest.raises(ConnectionError, match="format of MORSE"):
        Morse("127.0.0.1", server(lambda connection: (connection.sendall(answer), time.sleep(5.0))))
