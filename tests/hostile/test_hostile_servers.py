"""A program that uses pymorse survives any server: it gets an error in time, and its memory is bounded."""

import contextlib
import json
import re
import socket
import threading
import time
import tracemalloc
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morse.core.clients.web_access import Access
from pymorse import Morse, MorseServiceFailed, __main__, discovery, frames, names, stream, stubs
from tests.kit.effort import examples


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


SENSOR = {"stream_interfaces": [["x", "OUT"]], "services": ["get_local_data"]}


def _simulation(
    server: Any, robots: Any, *, port: str = "4444", data: str | None = "{}", details: str | None = None
) -> int:
    """A server that answers requests like a simulation; without data, it never tells those of a sensor."""
    answers = {"details": details or f"SUCCESS {json.dumps({'robots': robots})}", "get_stream_port": f"SUCCESS {port}",
               "get_local_data": data and f"SUCCESS {data}"}  # fmt: skip

    def act(connection: socket.socket) -> None:
        # the fixture has read the first bytes of the first request
        connection.sendall(f"0 {answers['details']}\n".encode())
        with connection.makefile("rb") as lines:
            lines.readline()
            for line in lines:
                number, _, service, *_ = line.decode().split()
                if answers.get(service):
                    connection.sendall(f"{number} {answers[service]}\n".encode())

    return int(server(act))


def _robot(name: str, *parts: str, services: Any = ()) -> dict[str, Any]:
    return {"name": name, "services": services, "components": dict.fromkeys(parts, SENSOR)}


@pytest.mark.parametrize(
    "robot",
    [_robot("close\x1b]0;title\x07"), _robot("r", "r.\x9b31m.get"), _robot("r\u202e"), _robot("\ud800"),
     _robot("r" * 10_000), _robot("r", "r" + ".a" * 5_000), _robot("r", services=["\x1b[2J"]),
     _robot("r", "r.a") | {"components": {"r.a": SENSOR | {"services": ["\x1b[2J"]}}}],
    ids=["title", "colours", "direction", "surrogate", "long", "deep", "service of a robot", "service of a component"],
)  # fmt: skip
def test_names_are_those_of_a_simulation(server: Any, robot: Any) -> None:
    with pytest.raises(ConnectionError, match="expected a name of at most 256 printable characters") as caught:
        Morse("127.0.0.1", _simulation(server, [robot]))
    assert str(caught.value).isprintable()
    assert len(str(caught.value)) < 700


def test_a_name_takes_no_more_memory_than_its_length(server: Any) -> None:
    """Each part of a name becomes a component with the whole name so far: 40 KB were 400 MB."""
    port = _simulation(server, [_robot("r", "r" + ".a" * 20_000)])
    tracemalloc.start()
    try:
        with pytest.raises(ConnectionError):
            Morse("127.0.0.1", port)
        assert tracemalloc.get_traced_memory()[1] < 20e6
    finally:
        tracemalloc.stop()


def test_many_names_of_a_series_are_sorted_soon() -> None:
    begin = time.process_time()
    many = [f"m_{number:06d}" for number in range(50_000)]
    assert names.series([*many, "m"])["ms"] == ["m", *many]
    assert time.process_time() - begin < 10.0


@pytest.mark.parametrize("port", ["1e400", "NaN", "-1", "0", "65536", "4444.5", "[]", "true", '"x"', "9" * 4000])
def test_a_port_is_a_port(server: Any, port: str) -> None:
    with pytest.raises(ConnectionError, match="expected a port from 1 to 65535"):
        Morse("127.0.0.1", _simulation(server, [_robot("r", "r.a")], port=port))


@pytest.mark.parametrize("status", ["FAILED", "PREEMPTED"])
def test_a_refusal_is_named_and_controls_no_terminal(
    server: Any, status: str, capsys: pytest.CaptureFixture[str]
) -> None:
    port = _simulation(server, [], details=status + r' "\u001b]0;title\u0007"')
    assert __main__.main(["127.0.0.1", str(port)]) == 1
    assert "did not answer in the format of MORSE" in capsys.readouterr().err
    port = _simulation(server, [_robot("r", "r.a")], details=None)
    with Morse("127.0.0.1", port) as simu:
        assert simu.robots == ["r"]


@pytest.mark.parametrize("data", [None, '{"x": ' + "[" * 900 + "]" * 900 + "}", r'{"\ud800\u001b": 1}', "3"])
@pytest.mark.parametrize("robots", [[_robot("r", "r.a")], [_robot("x: int = exit()")], []])
def test_types_are_a_module_or_an_error(
    server: Any, robots: Any, data: str | None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(stubs, "TIMEOUT", 0.5, raising=False)
    assert __main__.main(["127.0.0.1", str(_simulation(server, robots, data=data))]) == 0
    text = capsys.readouterr().out
    compile(text, "types", "exec")
    assert not re.search("[^ -~\n]", text)


def test_errors_of_services_control_no_terminal(server: Any) -> None:
    robots = [_robot("r", "r.a")]
    with Morse("127.0.0.1", _simulation(server, robots)) as simu:
        future = simu.call("r.a", "unanswered")
        failure = rb'FAILED "\u001b]0;title\u0007 of\n two lines"'
        simu._services.handle_msg(b"%d %b" % (future.request, failure))
        with pytest.raises(MorseServiceFailed, match="two lines") as caught:
            future.result(60.0)
    assert str(caught.value) == "\\x1b]0;title\\x07 of\n two lines"


def test_layouts_of_frames_that_are_large_are_not_kept() -> None:
    frames._layout.cache_clear()
    tracemalloc.start()
    try:
        for number in range(100):
            text = json.dumps({"numbers": [], "arrays": [], "fields": {str(number): "x" * 1_000_000}}).encode()
            text += b" " * (-len(text) % 8)
            frame = frames.HEAD.pack(frames.MAGIC, frames.VERSION, frames.DATA, 1, len(text), 0) + text
            assert frames.decode(frame) == {str(number): "x" * 1_000_000}
        assert tracemalloc.get_traced_memory()[0] < 20e6
    finally:
        tracemalloc.stop()


# -- host headers that only look like this machine -------------------------------------------------

_STRANGE = [
    "evil.com@127.0.0.1:8765", "127.0.0.1#.evil", "127.0.0.1?.evil", "127.0.0.1/evil", "127.0.0.1\\.evil",
    "user:secret@localhost", "@localhost", "localhost@", "localhost:99999", "localhost:8765x", "localhost:-1",
    "localhost: 80", " localhost", "localhost ", "localhost\t", "[127.0.0.1]", "[::1", "::1", "[::1]x", "[::1%lo]",
    "localhost,evil.com", "localhost;evil", "localhost..", "", ":8765", "local\u017fhost", "%6cocalhost",
    "127.0.0.1%00.evil", "localhost:80:80", "127.0.0.1:8\u0660",
]  # fmt: skip


def _refusal(host: str) -> str | None:
    return Access("127.0.0.1", None).refusal("/", {"Host": host}, secret=False, cookie="")


@pytest.mark.parametrize("host", _STRANGE)
def test_a_host_that_only_looks_like_this_machine_is_refused(host: str) -> None:
    assert _refusal(host) is not None


@pytest.mark.parametrize(
    "host", ["localhost", "LocalHost:8765", "localhost.:80", "127.0.0.1", "127.0.0.1:8765", "127.1.2.3", "[::1]:8765"]
)
def test_this_machine_is_accepted(host: str) -> None:
    assert _refusal(host) is None


@given(st.text("localhost127.0:@#?/\\[]%;, \t\x00evil", max_size=30))
@settings(max_examples=examples(200))
def test_what_is_accepted_is_a_name_or_an_address_and_a_port(host: str) -> None:
    if _refusal(host) is None:
        name, _, port = host.partition(":")
        assert name in ("localhost", "localhost.") or all(part.isdecimal() for part in name.split("."))
        assert port == "" or port.isdecimal()
