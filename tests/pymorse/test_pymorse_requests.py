import contextlib
import json
import logging
import socket
import threading
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scripted_simulation import ScriptedSimulation

import pymorse
import pymorse.poller
from pymorse.errors import MorseServicePreempted
from pymorse.names import normalize_name, series
from pymorse.poller import Poller
from pymorse.requests import format_request, parse_response
from pymorse.stream import StreamB

json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=10,
)
words = st.text(st.characters(exclude_categories=("Z", "C")), min_size=1)


@given(st.integers(0, 10**9), words, words, st.lists(json_values))
def test_a_request_is_one_line_of_four_parts(
    number: int, component: str, service: str, arguments: list[object]
) -> None:
    line = format_request(number, component, service, arguments)
    assert "\n" not in line
    first, second, third, rest = line.split(maxsplit=3)
    assert (int(first), second, third) == (number, component, service)
    assert json.loads(rest) == arguments


@pytest.mark.parametrize("name", ["", " ", "two words", "line\nbreak", " lead", "tab\t"])
def test_a_name_that_would_change_the_meaning_of_the_line_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match="not the name of a component or service"):
        format_request(0, name, "service", [])
    with pytest.raises(ValueError, match="not the name of a component or service"):
        format_request(0, "component", name, [])


def test_an_argument_that_json_cannot_carry_is_named() -> None:
    with pytest.raises(TypeError, match=r"object at .* cannot be sent"):
        format_request(0, "robot.motion", "goto", [object()])


@given(st.integers(0, 10**9), st.sampled_from(["SUCCESS", "FAILED", "PREEMPTED"]), json_values)
def test_an_answer_is_read_back(number: int, status: str, value: object) -> None:
    text = f"{number} {status} {json.dumps(value)}" if value else f"{number} {status}"
    assert parse_response(text) == (number, status, value or None)


@pytest.mark.parametrize(
    "line",
    ["", "0", "SUCCESS", "x SUCCESS", "0 success", "0 DONE", "0 SUCCESS {", "-1 SUCCESS", "0 SUCCESS " + "[" * 10**5],
)
def test_what_is_no_answer_is_refused(line: str) -> None:
    with pytest.raises(ValueError, match=r"."):
        parse_response(line)


@given(st.text())
def test_any_line_is_read_or_refused(line: str) -> None:
    try:
        response = parse_response(line)
    except ValueError:
        return
    assert response.request >= 0


@pytest.mark.parametrize(("name", "attribute"), [("a.b", "a_b"), ("a-b", "a_b"), ("a~b", "a_b"), ("m_001", "m_001")])
def test_names_become_attributes(name: str, attribute: str) -> None:
    assert normalize_name(name) == attribute


def test_robots_of_a_loop_come_in_a_list_in_their_order() -> None:
    names = ["m_002", "cat", "m", "m_001", "cat_2", "dog_001", "m_010"]
    assert series(names) == {"ms": ["m", "m_001", "m_002", "m_010"]}


# -- a server that sends without end leaves time for the other connections of a client -------------

MANY = 1 << 20


def test_messages_that_take_long_are_read_in_small_chunks() -> None:
    sizes: list[int] = []

    class Slow(StreamB):
        def received(self, data: bytes) -> None:
            sizes.append(len(data))
            time.sleep(0.01)

    server, client = socket.socketpair()
    with server:
        server.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, MANY)
        client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, MANY)
        server.setblocking(False)
        with contextlib.suppress(BlockingIOError):
            sent = server.send(b"1\n" * MANY)
        assert sent > 1 << 17
        poller = Poller(until_empty=True)
        stream = Slow(sock=client, poller=poller)
        poller.start()
        end = time.monotonic() + 60.0
        while sum(sizes) < sent:
            assert time.monotonic() < end
            time.sleep(0.01)
        stream.close()
    # 131,072 messages at once kept the other sockets waiting for more than a second
    assert max(sizes) <= 1 << 14


# -- a client that is connected to a stream, where a server of services is expected ----------------


def test_lines_that_are_no_answers_are_reported_once(
    simulation: ScriptedSimulation, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.ERROR, "pymorse")
    with pymorse.Morse("127.0.0.1", simulation.port) as simu:
        for _ in range(20):
            simulation.rpc.send(b'{"x": 1.0}\n')
        # an answer that is sent after these lines
        assert simu.rpc("simulation", "list_robots") == ["robot1"]
    assert caplog.text.count("is not an answer") == 1


# -- the exception of a service that was cancelled says so, whatever the simulation answered -------


@pytest.mark.parametrize(("value", "text"), [(None, "cancelled, or interrupted"), ("too slow", "too slow")])
def test_the_message(value: object, text: str) -> None:
    assert text in str(MorseServicePreempted(value))


# -- the thread that serves connections, and waiting threads that serve them in its place ----------


@pytest.mark.parametrize("courtesy", [0.0, 1e-6, 1e-4])
def test_a_guest_whom_the_system_lets_wait_is_served_all_the_same(
    courtesy: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    # with such a short grace period, it has expired when the thread checks for a waiting thread, as on a loaded machine
    monkeypatch.setattr(pymorse.poller, "_COURTESY", courtesy)
    poller = Poller()
    poller.start()

    def call_often() -> None:
        for _ in range(3000):
            poller.catch_up()

    guest = threading.Thread(target=call_often, daemon=True)
    guest.start()
    guest.join(60.0)
    assert not guest.is_alive()
    poller.syncstop(5.0)
    assert not poller.is_alive()


class _Turn:
    """A turn for which the thread has to wait until a guest has obeyed the command to stop."""

    def __init__(self, poller: Poller) -> None:
        self._poller = poller

    def __enter__(self) -> None:
        self._poller._stopping = True

    def __exit__(self, *_: object) -> None: ...


def test_the_thread_ends_if_a_guest_was_told_to_stop() -> None:
    poller = Poller()
    poller._turn = _Turn(poller)  # type: ignore[assignment]
    poller.start()
    poller.join(60.0)
    assert not poller.is_alive()
