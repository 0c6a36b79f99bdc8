"""Services over TCP, byte for byte."""

import contextlib
import json
import logging
import socket

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from socket_bench import Bench, Peer

from morse.core import status
from morse.core.exceptions import MorseMiddlewareError
from morse.middleware.socket import service_client
from morse.middleware.socket.request_manager import SocketRequestManager
from morse.wire.server import MAX_CLIENTS
from tests.kit.effort import examples
from tests.kit.waiting import wait_until


def test_the_transcript_of_1_4(bench: Bench, client: Peer) -> None:
    bench.sensor("robot1.pose", port=0)
    bench.actuator("robot1.motion", port=0)
    ports = [bench.port_of("robot1.pose"), bench.port_of("robot1.motion")]
    for request, reply in [
        (b'1 simulation get_stream_port ["robot1.motion"]\n', b"1 SUCCESS %d\n" % ports[1]),
        (b"4 simulation list_streams []\n", b'4 SUCCESS ["robot1.pose", "robot1.motion"]\n'),
        (
            b"5 simulation get_all_stream_ports []\n",
            b'5 SUCCESS {"robot1.pose": %d, "robot1.motion": %d}\n' % (ports[0], ports[1]),
        ),
        (b"13 robot1.motion nothing []\n", b"13 SUCCESS\n"),
    ]:
        assert bench.call(client, request) == reply
    client.send(b"6 robot1.motion goto [2.5, 1.0, 0.0]\n")
    bench.tick_until(lambda: bench.arm.running_service)
    bench.tick()
    assert not client.lines()[4:], "the service is not over yet"
    bench.arm.completed(status.SUCCESS, "Arrived")
    bench.tick_until(lambda: client.lines()[4:] == [b'6 SUCCESS "Arrived"'])
    client.send(b"8 robot1.motion goto [2.5, 1.0, 0.0]\n")
    bench.tick_until(lambda: bench.arm.running_service)
    assert bench.call(client, b"8 cancel\n") == b"8 PREEMPTED\n"
    assert bench.arm.interrupted == 1
    wrong = bench.call(client, b"9 robot1.motion goto [1]\n")
    assert wrong.startswith(b'9 FAILED "Socket service manager: wrong # of parameters for service.')
    assert bench.call(client, b"9 robot1.motion goto\n").startswith(
        b'9 FAILED "Socket service manager: some parameters'
    )
    unknown = b'10 FAILED "The request nope has not been registered in Socket service manager'
    assert bench.call(client, b"10 robot1.motion nope []\n").startswith(unknown)
    unavailable = b'11 FAILED "Stream unavailable for component robot1.x'
    assert bench.call(client, b'11 simulation get_stream_port ["robot1.x"]\n').startswith(unavailable)


def test_nothing_happens_between_ticks(bench: Bench, client: Peer) -> None:
    client.send(b"1 robot1.motion add [1]\n")
    wait_until(lambda: bench.woken)
    assert client.lines() == []
    bench.tick()
    wait_until(lambda: client.lines() == [b"1 SUCCESS 3"])


def test_answers_come_in_the_order_of_the_requests(bench: Bench, client: Peer) -> None:
    client.send(b"".join(b"%d robot1.motion echo [%d]\n" % (n, n + 1) for n in range(2000)))
    bench.tick_until(lambda: len(client.lines()) == 2000)
    assert client.lines() == [b"%d SUCCESS %d" % (n, n + 1) for n in range(2000)]


def test_a_flood_of_requests_is_spread_over_ticks(bench: Bench, client: Peer) -> None:
    client.send(b"1 robot1.motion nothing []\n" * 700)
    wait_until(lambda: len(bench.requests._inbox) == 700)
    bench.tick()
    assert 0 < len(bench.requests._inbox) < 700
    bench.tick_until(lambda: len(client.lines()) == 700)


def test_a_client_that_floods_is_not_read_from_until_it_is_its_turn(bench: Bench, client: Peer) -> None:
    request = b"1 robot1.motion nothing []\n"
    flood = request * 10_000
    client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 16)
    client.socket.settimeout(0.1)
    server = bench.requests._server
    assert server is not None
    (served,) = server.clients
    assert isinstance(served, service_client.ServiceClient)
    sent = 0

    def is_not_read_from() -> bool:
        # how many bytes the system takes for a peer that does not read is not known in advance: they are counted
        nonlocal sent
        try:
            sent += client.socket.send(flood[sent % len(request) :])
        except TimeoutError:
            return served._held_back
        return False

    wait_until(is_not_read_from)
    waiting = len(bench.requests._inbox)
    complete = sent // len(request)
    assert waiting < complete
    assert waiting < 100_000
    bench.tick_until(lambda: len(client.lines()) >= complete)
    assert len(client.lines()) == complete
    wait_until(lambda: not served._held_back)


def test_replies_go_to_who_asked(bench: Bench, client: Peer) -> None:
    other = bench.connect()
    client.send(b'7 robot1.motion echo ["mine"]\n')
    other.send(b'7 robot1.motion echo ["other"]\n')
    bench.tick_until(lambda: client.lines() and other.lines())
    assert client.lines() == [b'7 SUCCESS "mine"']
    assert other.lines() == [b'7 SUCCESS "other"']
    other.close()


def test_a_newer_call_interrupts_the_running_one(bench: Bench, client: Peer) -> None:
    other = bench.connect()
    client.send(b"1 robot1.motion goto [1, 2, 3]\n")
    bench.tick_until(lambda: bench.arm.running_service)
    other.send(b"1 robot1.motion goto [4, 5, 6]\n")
    bench.tick_until(lambda: client.lines() == [b"1 PREEMPTED"])
    bench.arm.completed(status.SUCCESS, True)
    bench.tick_until(lambda: other.lines() == [b"1 SUCCESS true"])
    assert client.lines() == [b"1 PREEMPTED"]
    other.close()


def test_a_service_that_may_not_be_interrupted_is_refused(bench: Bench, client: Peer) -> None:
    client.send(b"1 robot1.motion press\n")
    bench.tick_until(lambda: bench.arm.running_service)
    assert b'2 FAILED "robot1.motion is already running ' in bench.call(client, b"2 robot1.motion press\n")
    bench.arm.completed(status.FAILED, "stuck")
    bench.tick_until(lambda: client.lines()[-1] == b'1 FAILED "stuck"')


def test_cancelling_by_another_connection(bench: Bench, client: Peer) -> None:
    client.send(b"id1 robot1.motion goto [1, 2, 3]\n")
    bench.tick_until(lambda: bench.arm.running_service)
    other = bench.connect()
    other.send(b"id1 cancel\n")
    bench.tick_until(lambda: client.lines() == [b"id1 PREEMPTED"])
    assert other.lines() == []
    other.close()


def test_cancelling_what_is_over_leaves_others_with_the_same_id_alone(bench: Bench, client: Peer) -> None:
    client.send(b"3 robot1.motion goto [1, 2, 3]\n")
    bench.tick_until(lambda: bench.arm.running_service)
    other = bench.connect()
    assert bench.call(other, b"3 robot1.motion nothing\n") == b"3 SUCCESS\n"
    assert bench.call(other, b"3 cancel\n4 robot1.motion nothing\n") == b"4 SUCCESS\n"
    assert bench.arm.running_service == "goto"
    other.close()


def test_cancelling_what_was_never_started_has_no_answer(bench: Bench, client: Peer) -> None:
    assert bench.call(client, b"99 cancel\n1 robot1.motion nothing\n") == b"1 SUCCESS\n"


def test_a_client_may_leave_before_its_service_ends(bench: Bench, client: Peer) -> None:
    gone = bench.connect()
    gone.send(b"1 robot1.motion goto [1, 2, 3]\n")
    bench.tick_until(lambda: bench.arm.running_service)
    gone.close()
    bench.arm.completed(status.SUCCESS, "Arrived")
    bench.tick()
    assert bench.call(client, b"1 robot1.motion nothing\n") == b"1 SUCCESS\n"


def test_a_request_of_a_client_that_has_already_left_is_served(bench: Bench) -> None:
    gone = bench.connect()
    gone.send(b"id1 robot1.motion goto [1, 2, 3]\n")
    gone.close()
    bench.tick_until(lambda: bench.arm.running_service == "goto")


@pytest.mark.parametrize(
    ("request_line", "reply"),
    [
        (b"1\n", b'1 FAILED "Malformed request! expected: id component service'),
        (b"1 robot1.motion\n", b'1 FAILED "Malformed request! expected: id component service'),
        (b"1 robot1.motion echo {\n", b'1 FAILED "Malformed request! the arguments are no JSON'),
        (b"1 robot1.motion echo 3\n", b'1 FAILED "Malformed request! the arguments have to be a JSON list'),
        (b"1 robot1.motion refuse\n", b'1 FAILED "not today"'),
        (b"1 robot1.motion break_down\n", b"1 FAILED \"KeyError: 'a mistake of the user'\""),
        (b"1 robot1.motion unsendable\n", b'1 FAILED "the result cannot be sent: object'),
        (b'1 robot1.motion add ["a", 1]\n', b'1 FAILED "'),
        (b"1 nobody echo [1]\n", b'1 FAILED "The request echo has not been registered in Socket service manager'),
        (b"1 robot1.motion ech [1]\n", b"did you mean 'echo'?"),
        (b"\xff\xfe\x00\n", b"FAILED"),
    ],
)
def test_a_bad_request_is_answered_and_the_connection_stays(
    bench: Bench, client: Peer, request_line: bytes, reply: bytes
) -> None:
    assert reply in bench.call(client, request_line)
    assert bench.call(client, b'2 robot1.motion echo ["next"]\n') == b'2 SUCCESS "next"\n'


def test_a_service_that_breaks_down_is_reported_with_its_line(
    bench: Bench, client: Peer, caplog: pytest.LogCaptureFixture
) -> None:
    bench.call(client, b"1 robot1.motion break_down\n")
    assert "the service break_down of robot1.motion failed: KeyError" in caplog.text
    assert "socket_bench.py" in caplog.text


def test_blank_lines_are_skipped(bench: Bench, client: Peer) -> None:
    assert bench.call(client, b"\n \r\n\t\n1 robot1.motion nothing\r\n") == b"1 SUCCESS\n"


@settings(max_examples=examples(25))
@given(data=st.data())
def test_requests_may_arrive_in_any_pieces(data: st.DataObject) -> None:
    bench = Bench()
    try:
        client = bench.connect()
        arguments = data.draw(st.lists(st.lists(st.text() | st.integers(), min_size=1, max_size=1), max_size=5))
        wire = b"".join(
            b"%d robot1.motion echo %b\n" % (n, json.dumps(value).encode()) for n, value in enumerate(arguments)
        )
        while wire:
            cut = data.draw(st.integers(1, len(wire)))
            client.send(wire[:cut])
            bench.tick()
            wire = wire[cut:]
        bench.tick_until(lambda: len(client.lines()) == len(arguments))
        for n, (line, (value,)) in enumerate(zip(client.lines(), arguments, strict=True)):
            number, outcome, *rest = line.decode().split(maxsplit=2)
            assert (number, outcome) == (str(n), "SUCCESS")
            assert (json.loads(rest[0]) if rest else None) == (value or None)
        client.close()
    finally:
        bench.close()


def test_a_long_request_is_taken(bench: Bench, client: Peer) -> None:
    text = "x" * 1_000_000
    reply = bench.call(client, b'1 robot1.motion echo ["%b"]\n' % text.encode())
    assert reply == b'1 SUCCESS "%b"\n' % text.encode()


def test_a_line_without_an_end_is_cut_off(
    bench: Bench, client: Peer, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr("morse.wire.lines.MAX_LINE", 100_000)
    with contextlib.suppress(ConnectionError):  # it may be disconnected before all of it is sent
        client.send(b"1 robot1.motion echo [" + b"1," * 60_000)
    wait_until(client.has_ended)
    assert client.lines()[0].startswith(b'? FAILED "Malformed request! A line has at most')
    assert "without a line end" in caplog.text
    other = bench.connect()
    assert bench.call(other, b"1 robot1.motion nothing\n") == b"1 SUCCESS\n"
    other.close()


def test_a_request_without_an_end_is_reported(bench: Bench, client: Peer, caplog: pytest.LogCaptureFixture) -> None:
    client.send(b"1 robot1.motion noth")
    client.close()
    wait_until(lambda: "in the middle of a request" in caplog.text)
    assert "1 robot1.motion noth" in caplog.text


def test_a_client_that_does_not_read_its_replies_is_disconnected(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(service_client, "MAX_UNREAD", 1 << 20)
    answered: list[str] = []
    bench.requests.register_service("robot1.motion", lambda text: answered.append(text) or text, "repeat")
    deaf = bench.connect()
    request = b'1 robot1.motion repeat ["%b"]\n' % (b"x" * 100_000)
    # the system itself takes an amount that is not known in advance
    for sent in range(1, 10_000):
        try:
            deaf.send(request)
        except OSError:
            break
        # a request that has not been taken may fill the buffers: the next `send` would wait for a tick
        bench.tick_until(lambda sent=sent: len(answered) == sent or "does not read" in caplog.text)
        if "does not read" in caplog.text:
            break
    wait_until(lambda: "does not read" in caplog.text)
    deaf.close()


def test_the_client_that_has_been_silent_for_longest_makes_room(bench: Bench, caplog: pytest.LogCaptureFixture) -> None:
    server = bench.requests._server
    assert server is not None
    speaking, waiting = bench.connect(), bench.connect()
    assert bench.call(speaking, b"1 robot1.motion nothing\n") == b"1 SUCCESS\n"
    waiting.send(b"2 robot1.motion goto [1, 2, 3]\n")
    bench.tick_until(lambda: bench.arm.running_service)
    idle = [bench.connect() for _ in range(MAX_CLIENTS - 2)]
    for n in range(300):
        newcomer = bench.connect()
        if n % 50 == 0:
            assert bench.call(newcomer, b"3 robot1.motion echo [true]\n") == b"3 SUCCESS true\n"
        idle.append(newcomer)
    assert server.connected == MAX_CLIENTS
    wait_until(idle[0].has_ended)
    assert caplog.text.count("to make room") == 1
    assert bench.call(speaking, b"4 robot1.motion nothing\n") == b"4 SUCCESS\n"
    bench.arm.completed(status.SUCCESS, True)
    bench.tick_until(lambda: waiting.lines() == [b"2 SUCCESS true"])
    for peer in (*idle, speaking, waiting):
        peer.close()
    wait_until(lambda: server.connected == 0)


def test_the_last_reply_arrives_before_the_end() -> None:
    bench = Bench()
    client = bench.connect()
    client.send(b"1 robot1.motion nothing\n")
    wait_until(lambda: bench.woken)
    bench.tick()
    bench.close()
    wait_until(client.has_ended)
    assert client.lines() == [b"1 SUCCESS"]
    client.close()


def test_the_port_can_be_used_again_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = Bench()
    port = bench.requests.port
    client = bench.connect()
    bench.close()
    monkeypatch.setenv("MORSE_SOCKET_PORT", str(port))
    again = Bench()
    assert again.requests.port == port
    again.close()
    client.close()


def test_a_port_in_use_is_skipped_and_the_log_says_so(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", str(bench.requests.port))
    second = SocketRequestManager(bench.context)
    with caplog.at_level(logging.INFO):
        assert second.initialization()
    assert bench.requests.port < second.port <= bench.requests.port + 9
    assert f"port {bench.requests.port} is in use" in caplog.text
    assert f"Morse(port={second.port})" in caplog.text
    second.finalization()


def test_no_free_port_is_an_error_with_the_mend(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", str(bench.requests.port))
    monkeypatch.setattr("morse.middleware.socket.request_manager._TRIES", 1)
    with pytest.raises(MorseMiddlewareError, match=rf"port {bench.requests.port} is in use.*MORSE_SOCKET_PORT"):
        SocketRequestManager(bench.context).initialization()


@pytest.mark.parametrize("value", ["x", "-1", "70000", ""])
def test_a_port_that_is_none_is_refused(bench: Bench, monkeypatch: pytest.MonkeyPatch, value: str) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", value)
    with pytest.raises(MorseMiddlewareError, match="MORSE_SOCKET_PORT is a port number"):
        SocketRequestManager(bench.context).initialization()


def test_the_names_of_1_4() -> None:
    assert SocketRequestManager.classpath == "morse.middleware.socket_request_manager.SocketRequestManager"
