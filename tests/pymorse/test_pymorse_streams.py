import json
import logging
import socket
import threading
from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scripted_simulation import Endpoint, ScriptedSimulation

from pymorse import Morse, PollThread, Stream, StreamJSON, messages
from pymorse.channel import MAX_UNSENT
from pymorse.stream import StreamB
from tests.kit.waiting import wait_until


class Collecting(StreamB):
    """Splits bytes into lines without a network."""

    def __init__(self) -> None:
        self.seen: list[bytes] = []
        self._partial, self._partial_bytes = [], 0

    def handle_msg(self, msg: bytes) -> None:
        self.seen.append(msg)


@given(st.lists(st.binary().map(lambda b: b.replace(b"\n", b"").rstrip(b"\r"))), st.data())
def test_lines_are_the_same_however_they_are_cut_on_the_way(lines: list[bytes], data: st.DataObject) -> None:
    wire = b"".join(line + b"\n" for line in lines)
    stream = Collecting()
    while wire:
        cut = data.draw(st.integers(1, len(wire)))
        stream.received(wire[:cut])
        wire = wire[cut:]
    assert stream.seen == [line for line in lines if line]


def test_what_has_no_end_yet_is_no_message() -> None:
    stream = Collecting()
    stream.received(b'{"x": 1}\n{"x":')
    assert stream.seen == [b'{"x": 1}']
    stream.received(b" 2}\r\n")
    assert stream.seen == [b'{"x": 1}', b'{"x": 2}']


@pytest.fixture
def endpoint() -> Iterator[Endpoint]:
    server = Endpoint()
    yield server
    server.close()


@pytest.fixture
def stream(endpoint: Endpoint) -> Iterator[StreamJSON]:
    client = StreamJSON("127.0.0.1", endpoint.port)
    wait_until(lambda: endpoint.accepted)
    yield client
    client.close()


def test_get_waits_for_the_next_message_and_gives_up_in_time(stream: StreamJSON, endpoint: Endpoint) -> None:
    endpoint.send(b'{"n": 1}\n')
    wait_until(stream.last)
    assert stream.get(timeout=0.01) is None
    got = threading.Event()

    def send_on() -> None:
        # again and again: whoever calls `get` too late waits for the next message
        while not got.wait(0.01):
            endpoint.send(b'{"n": 2}\n')

    sender = threading.Thread(target=send_on)
    sender.start()
    assert stream.get(timeout=60) == {"n": 2}
    got.set()
    sender.join()
    endpoint.send(b'{"n": 3}\n')
    wait_until(lambda: stream.last() == {"n": 3})
    assert stream.get(timeout=0) is None


def test_last_counts_backwards(stream: StreamJSON, endpoint: Endpoint) -> None:
    assert stream.last() is None
    endpoint.send(b"".join(b'{"n": %d}\n' % n for n in range(150)))
    wait_until(lambda: stream.last() == {"n": 149})
    assert stream.last(2) == {"n": 148}
    assert stream.last(100) == {"n": 50}
    assert stream.last(101) is None
    assert stream.last(0) is None


def test_large_messages_do_not_pile_up(stream: StreamJSON, endpoint: Endpoint) -> None:
    picture = json.dumps({"image": "A" * (3 << 20)}).encode() + b"\n"
    for _ in range(8):
        endpoint.send(picture)
    endpoint.send(b'{"n": 1}\n')
    wait_until(lambda: stream.last() == {"n": 1})
    assert len(stream.last(2)["image"]) == 3 << 20
    assert stream.last(9) is None


def test_subscribers_get_every_message_until_they_leave(stream: StreamJSON, endpoint: Endpoint) -> None:
    seen: list[Any] = []
    stream.subscribe(seen.append)
    endpoint.send(b"1\n2\n3\n")
    wait_until(lambda: seen == [1, 2, 3])
    stream.unsubscribe(seen.append)
    endpoint.send(b"4\n")
    wait_until(lambda: stream.last() == 4)
    assert seen == [1, 2, 3]
    with pytest.raises(ValueError, match=r"not in list"):
        stream.unsubscribe(seen.append)


def test_a_failing_subscriber_is_reported_and_the_others_go_on(
    stream: StreamJSON, endpoint: Endpoint, caplog: pytest.LogCaptureFixture
) -> None:
    seen: list[Any] = []
    stream.subscribe(lambda message: message["nope"])
    stream.subscribe(seen.append)
    endpoint.send(b'{"n": 1}\n{"n": 2}\n')
    wait_until(lambda: len(seen) == 2)
    assert "KeyError: 'nope'" in caplog.text


def test_a_callback_that_always_fails_prints_one_traceback(
    stream: StreamJSON, endpoint: Endpoint, caplog: pytest.LogCaptureFixture
) -> None:
    seen: list[Any] = []
    stream.subscribe(lambda message: message["nope"])
    stream.subscribe(seen.append)
    endpoint.send(b'{"n": 1}\n' * 105)
    wait_until(lambda: len(seen) == 105)
    assert [bool(record.exc_info) for record in caplog.records] == [True, False, False]
    assert [word for word in caplog.text.split() if word.isdigit()][-2:] == ["10", "100"]


class Asleep:
    """A poll thread that has not noticed anything yet."""

    def add(self, channel: object) -> None: ...


def test_to_publish_to_a_simulation_that_was_killed_is_an_error() -> None:
    here, there = socket.socketpair()
    stream = StreamJSON(sock=here, poller=Asleep())  # type: ignore[arg-type]
    stream.publish({"v": 1.0})
    assert there.recv(100) == b'{"v": 1.0}\n'
    there.close()
    with pytest.raises(ConnectionError, match="still running"):
        stream.publish({"v": 2.0})
    here.close()


def test_what_is_no_json_is_reported_and_the_stream_goes_on(
    stream: StreamJSON, endpoint: Endpoint, caplog: pytest.LogCaptureFixture
) -> None:
    seen: list[Any] = []
    stream.subscribe(seen.append)
    endpoint.send(b"{nope}\n\xff\xfe\n" + b"[" * 200_000 + b'\n{"n": 1}\n')
    wait_until(lambda: seen == [{"n": 1}])
    assert "{nope}" in caplog.text


def test_a_callback_that_would_wait_for_itself_is_told_so(
    stream: StreamJSON, endpoint: Endpoint, caplog: pytest.LogCaptureFixture
) -> None:
    stream.subscribe(lambda _: stream.get())
    endpoint.send(b"1\n")
    wait_until(lambda: "use last()" in caplog.text)


def test_who_waits_is_told_that_the_simulation_ended(stream: StreamJSON, endpoint: Endpoint) -> None:
    threading.Timer(0.05, endpoint.drop).start()
    with pytest.raises(ConnectionError, match="closed the stream"):
        stream.get()
    assert not stream.is_up()
    with pytest.raises(ConnectionError, match="still running"):
        stream.publish({})


def test_numpy_values_can_be_published(stream: StreamJSON, endpoint: Endpoint) -> None:
    numpy = pytest.importorskip("numpy")
    stream.publish({"v": numpy.float32(0.5), "points": numpy.eye(2)})
    wait_until(lambda: endpoint.lines)
    assert json.loads(endpoint.lines[0]) == {"v": 0.5, "points": [[1.0, 0.0], [0.0, 1.0]]}


def test_what_json_cannot_carry_is_refused_and_nothing_is_sent(stream: StreamJSON, endpoint: Endpoint) -> None:
    with pytest.raises(TypeError, match="cannot be sent"):
        stream.publish({"v": object()})
    stream.publish({"v": 1})
    wait_until(lambda: endpoint.lines == [b'{"v": 1}\n'])


def test_a_simulation_that_does_not_read_is_not_fed_for_ever() -> None:
    ours, theirs = socket.socketpair()
    stream = Stream(sock=ours)
    for _ in range(MAX_UNSENT // (1 << 20) - 1):
        stream.publish("x" * (1 << 20))
    with pytest.raises(BufferError, match="has not read"):
        stream.publish("x" * (16 << 20))
    stream.close()
    theirs.close()


def test_the_three_kinds_of_streams(endpoint: Endpoint) -> None:
    with PollThread() as thread:
        raw, text = StreamB("127.0.0.1", endpoint.port), Stream("127.0.0.1", endpoint.port)
        assert raw.poller is text.poller is thread
        wait_until(lambda: endpoint.accepted == 2)
        endpoint.send("größer\n".encode())
        assert wait_until(raw.last) == "größer".encode()
        assert wait_until(text.last) == "größer"
        raw.publish(b"\x01")
        text.publish("ä")
        wait_until(lambda: sorted(endpoint.lines) == [b"\x01\n", "ä\n".encode()])
    assert not raw.is_up()
    assert not thread.is_alive()


def test_a_thread_that_was_never_started_can_be_stopped() -> None:
    PollThread().syncstop()


def test_streams_bring_their_own_thread_and_take_it_along(endpoint: Endpoint) -> None:
    stream = StreamJSON("127.0.0.1", endpoint.port)
    assert stream.poller.is_alive()
    stream.close()
    stream.poller.join(60)
    assert not stream.poller.is_alive()
    stream.close()


def test_a_callback_may_call_services_and_publish(simulation: ScriptedSimulation) -> None:
    simulation.replies["robot1.motion goto"] = 'SUCCESS "Arrived"'
    results: list[Any] = []
    with Morse("127.0.0.1", simulation.port) as simu:

        def follow(pose: dict[str, float]) -> None:
            results.append(simu.rpc("robot1.motion", "goto", pose["x"]))
            simu.robot1.motion.publish({"v": 0.0})

        simu.robot1.pose.subscribe(follow)
        wait_until(lambda: simulation.streams["robot1.pose"].accepted)
        simulation.streams["robot1.pose"].send(b'{"x": 1.5}\n')
        wait_until(lambda: results == ["Arrived"])
        wait_until(lambda: simulation.streams["robot1.motion"].lines)
    assert simulation.rpc.lines[-1] == b"3 robot1.motion goto [1.5]\n"


def test_nothing_is_logged_in_an_ordinary_session(
    simulation: ScriptedSimulation, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.DEBUG), Morse("127.0.0.1", simulation.port) as simu:
        simu.robot1.pose.last()
        simu.robot1.motion.publish({"v": 1.0})
    assert not caplog.records


@pytest.fixture
def two_sensors() -> Iterator[tuple[Morse, Endpoint, Endpoint]]:
    parts: dict[str, Any] = {"robot.pose": ([], "OUT"), "robot.gps": ([], "OUT")}
    with ScriptedSimulation({"robot": parts}) as simulation, Morse("127.0.0.1", simulation.port) as simu:
        _ = simu.robot.pose, simu.robot.gps
        ends = [simulation.streams[name] for name in parts]
        wait_until(lambda: all(end.lines for end in ends))
        assert ends[0].lines == ends[1].lines
        assert ends[0].lines[0].startswith(b"together ")
        yield simu, ends[0], ends[1]


def test_a_message_is_shown_with_the_others_of_its_tick(
    two_sensors: tuple[Morse, Endpoint, Endpoint], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(messages, "_PATIENCE", 60.0)
    simu, pose, gps = two_sensors
    arrivals = simu.robot.pose.stream.poller.arrivals
    seen: list[Any] = []
    simu.robot.gps.subscribe(lambda message: seen.append((message, simu.robot.pose.last())))
    pose.send(b'{"n": 1}\x1e1 2\n')
    wait_until(lambda: len(arrivals) == 1)
    assert simu.robot.pose.last() is None
    # those of another tick are complete, but a stream keeps its order
    gps.send(b'{"n": 0}\n')
    wait_until(lambda: simu.robot.gps.last() == {"n": 0})
    pose.send(b'{"n": 2}\x1e2 1\n')
    wait_until(lambda: len(arrivals) == 2)
    assert simu.robot.pose.last() is None
    gps.send(b'{"n": 3}\x1e1 2\n')
    wait_until(lambda: len(seen) == 2)
    assert seen == [({"n": 0}, None), ({"n": 3}, {"n": 2})]
    assert simu.robot.pose.last(2) == {"n": 1}


def test_a_message_does_not_wait_long_for_what_is_lost(
    two_sensors: tuple[Morse, Endpoint, Endpoint],
) -> None:
    simu, pose, gps = two_sensors
    pose.send(b'{"n": 1}\x1e1 2\n')
    wait_until(lambda: simu.robot.pose.last() == {"n": 1})
    # too late
    gps.send(b'{"n": 1}\x1e1 2\n')
    wait_until(lambda: simu.robot.gps.last() == {"n": 1})
    # an end of the connection is no reason to wait
    pose.send(b'{"n": 2}\x1e2 2\n')
    gps.drop()
    wait_until(lambda: simu.robot.pose.last() == {"n": 2})


@pytest.mark.parametrize("mark", [b"", b"x", b"1", b"1 x", b"-1 2", b"1 0", b"0 2", b"1" * 5000 + b" 2", b"1 2 3"])
def test_a_strange_mark_is_none(two_sensors: tuple[Morse, Endpoint, Endpoint], mark: bytes) -> None:
    simu, pose, _ = two_sensors
    pose.send(b'{"n": 1}\x1e' + mark + b"\n")
    wait_until(lambda: simu.robot.pose.last() == {"n": 1})
