"""Streams over TCP."""

import contextlib
import json
import logging
import socket
import threading
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from morse.middleware.socket_datastream import SocketDatastreamManager, SocketPublisher, SocketReader
from socket_bench import Bench, Body, Motion, Peer, Thermometer

from morse.core.clients.complaints import Complaints
from morse.core.exceptions import MorseMiddlewareError
from morse.core.sensor import Sensor
from morse.core.validation import OptionError
from morse.middleware.socket import stream_client
from morse.scene import StreamDeclaration
from morse.wire import server as line_server
from morse.wire.lines import Inbox
from morse.wire.listener import listen, port_of
from tests.kit.effort import examples
from tests.kit.waiting import wait_until


def test_a_sensor_sends_a_line_at_each_action(bench: Bench) -> None:
    bench.sensor(port=0)
    client = bench.connect("robot1.pose")
    for _ in range(3):
        bench.tick()
    wait_until(lambda: len(client.lines()) == 3)
    assert client.lines()[0] == b'{"timestamp": 0.0, "temperature": 20.5}'
    assert [json.loads(line)["timestamp"] for line in client.lines()] == [0.0, 1 / 60, 2 / 60]
    client.close()


def test_the_messages_of_a_tick_are_marked_for_programs_that_ask(bench: Bench) -> None:
    names = ["robot1.pose", "robot1.gps", "robot1.imu"]
    for name in names:
        bench.sensor(name, port=0)
    marked, plain = ([bench.connect(name) for name in names[:2]] for _ in range(2))
    for client in marked:
        client.send(b"together 0a\n")
    wait_until(lambda: all(any(c.program for c in bench.streams._servers[name].clients) for name in names[:2]))
    for number in (1, 2):
        bench.tick()
        wait_until(lambda number=number: all(len(client.lines()) == number for client in (*marked, *plain)))
    assert plain[0].lines() == plain[1].lines()
    # the third sensor has no client of that program
    lines = [client.lines() for client in marked]
    assert lines == [[plain[0].lines()[n] + b"\x1e%d 2" % (n + 1) for n in range(2)]] * 2
    for client in (*marked, *plain):
        client.close()


@pytest.mark.parametrize(
    "request_", [b"together\n", b"together \n", b"together zz\n", b"\0" * 5000, b"together " + b"a" * 5000, b"\n{}\n"]
)
def test_a_strange_request_for_marks_is_ignored(bench: Bench, request_: bytes) -> None:
    for name in ("robot1.pose", "robot1.gps"):
        bench.sensor(name, port=0)
    clients = [bench.connect(name) for name in ("robot1.pose", "robot1.gps")]
    for client in clients:
        client.send(request_)
    servers = [bench.streams._servers[name] for name in ("robot1.pose", "robot1.gps")]
    wait_until(lambda: all(one._request is None for server in servers for one in server.clients))
    bench.tick()
    for client in clients:
        wait_until(client.lines)
        assert client.lines() == [b'{"timestamp": 0.0, "temperature": 20.5}']
        client.close()


def test_an_inactive_sensor_sends_nothing(bench: Bench) -> None:
    pose = bench.sensor(port=0)
    client = bench.connect("robot1.pose")
    pose.active = False
    bench.tick()
    pose.active = True
    bench.tick()
    wait_until(client.lines)
    assert len(client.lines()) == 1
    client.close()


def test_a_client_that_vanishes_without_a_word_is_noticed(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is ever sent to the clients of an actuator, so that sending cannot fail."""
    monkeypatch.setattr(line_server, "_SILENCE", 1)
    bench.actuator("robot1.motion", port=0)
    server = bench.streams._servers["robot1.motion"]
    client = socket.create_connection(("127.0.0.1", port_of(server._listener)))
    wait_until(lambda: server.connected == 1)
    try:
        client.setsockopt(socket.IPPROTO_TCP, 19, 1)  # TCP_REPAIR: closed without a packet
    except OSError:
        client.close()
        pytest.skip("the system lets nobody close a connection in silence")
    client.close()
    wait_until(lambda: server.connected == 0)


def test_nothing_is_encoded_or_posted_while_nobody_listens(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    bench.sensor(port=0)
    monkeypatch.setattr(SocketPublisher, "encode", lambda self: pytest.fail("nobody is there to read it"))
    monkeypatch.setattr(bench.context.network, "post", lambda *_: pytest.fail("there is nothing to send"))
    bench.tick()


def test_what_many_sensors_publish_is_handed_over_once_a_tick(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    for n in range(5):
        bench.sensor(f"robot1.pose{n}", port=0)
    clients = [bench.connect(f"robot1.pose{n}") for n in range(5)]
    posts = []
    post = bench.context.network.post

    def counted(*args: Any) -> None:
        posts.append(args)
        post(*args)

    monkeypatch.setattr(bench.context.network, "post", counted)
    bench.tick()
    wait_until(lambda: all(client.lines() for client in clients))
    assert len(posts) == 1
    for client in clients:
        client.close()


def test_everybody_who_is_connected_gets_the_data(bench: Bench) -> None:
    bench.sensor(port=0)
    clients = [bench.connect("robot1.pose") for _ in range(10)]
    bench.tick()
    wait_until(lambda: all(len(client.lines()) == 1 for client in clients))
    clients[0].close()
    wait_until(lambda: bench.streams._servers["robot1.pose"].connected == 9)
    bench.tick()
    wait_until(lambda: all(len(client.lines()) == 2 for client in clients[1:]))
    for client in clients:
        client.close()


def test_what_a_client_says_to_a_sensor_is_ignored(bench: Bench) -> None:
    bench.sensor(port=0)
    client = bench.connect("robot1.pose")
    client.send(b"x" * 1_000_000 + b"\n")
    bench.tick()
    wait_until(client.lines)
    assert client.lines() == [b'{"timestamp": 0.0, "temperature": 20.5}']
    client.close()


def test_a_client_that_never_reads_slows_nobody_and_costs_little(
    bench: Bench, caplog: pytest.LogCaptureFixture
) -> None:
    pose = bench.sensor(port=0)
    pose.local_data["image"] = "x" * 200_000
    deaf, client = bench.connect("robot1.pose"), bench.connect("robot1.pose")
    sent = 0

    def reads_too_slowly() -> bool:
        # how many messages the system takes for a client that does not read is not known in advance
        nonlocal sent
        bench.tick()
        sent += 1
        wait_until(lambda: len(client.lines()) == sent)
        return sent >= 100 and "reads too slowly" in caplog.text

    wait_until(reads_too_slowly)
    assert caplog.text.count("reads too slowly") == 1
    buffered = [c.transport.get_write_buffer_size() for c in bench.streams._servers["robot1.pose"].clients]
    assert max(buffered) < 1_000_000
    pose.local_data["image"] = "the latest"
    bench.tick()

    def latest() -> bool:
        lines = deaf.lines()
        return bool(lines) and b"the latest" in lines[-1]

    wait_until(latest)
    assert len(deaf.lines()) < sent
    assert all(json.loads(line) for line in deaf.lines())
    for peer in (deaf, client):
        peer.close()


def test_the_tick_does_not_wait_for_a_client_that_never_reads(bench: Bench) -> None:
    pose = bench.sensor(port=0)
    pose.local_data["image"] = "x" * 100_000
    deaf = bench.connect("robot1.pose")
    ticks = threading.Thread(target=lambda: [bench.tick() for _ in range(300)], daemon=True)
    ticks.start()
    ticks.join(60)
    assert not ticks.is_alive()
    deaf.close()


def test_an_actuator_takes_the_latest_and_keeps_the_rest(bench: Bench) -> None:
    motion = bench.actuator(port=0)
    client = bench.connect("robot1.motion")
    client.send(b'{"v": 1.0, "w": 0.5}\n')
    bench.tick_until(lambda: motion.local_data["v"] == 1.0)
    client.send(b'{"v": 2}\n{"v": 3.0}\n')
    bench.tick_until(lambda: motion.local_data["v"] == 3.0)
    assert motion.local_data["w"] == 0.5
    bench.tick()
    assert motion.local_data["v"] == 3.0
    client.close()


@settings(max_examples=examples(25))
@given(data=st.data())
def test_messages_may_arrive_in_any_pieces(data: st.DataObject) -> None:
    bench = Bench()
    try:
        motion = bench.actuator(port=0)
        client = bench.connect("robot1.motion")
        finite = st.floats(allow_nan=False, allow_infinity=False)
        fields = st.fixed_dictionaries({}, optional={"v": finite, "mode": st.text()})
        messages = data.draw(st.lists(fields, max_size=8))
        expected = dict(motion.local_data)
        for message in messages:
            expected.update(message)
        wire = b"".join(json.dumps(message).encode() + b"\n" for message in messages) + b'{"gear": 7}\n'
        while wire:
            cut = data.draw(st.integers(1, len(wire)))
            client.send(wire[:cut])
            bench.tick()
            wire = wire[cut:]
        bench.tick_until(lambda: motion.local_data["gear"] == 7)
        assert motion.local_data == {**expected, "gear": 7}
        client.close()
    finally:
        bench.close()


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (b"{nope", "cannot be read"),
        (b"\xff\xfe", "cannot be read"),
        (b"[" * 50_000, "cannot be read"),
        (b"[1, 2]", "expected a JSON object"),
        (b'{"v": "fast"}', "robot1.motion: a message is refused: 'v' is 'fast', expected a number"),
        (b'{"v": NaN}', "'v' is nan, expected a number"),
        (b'{"w": 9.0, "v": null}', "'v' is None, expected a number"),
    ],
)
def test_a_bad_message_is_reported_and_the_connection_stays(
    bench: Bench, caplog: pytest.LogCaptureFixture, line: bytes, said: str
) -> None:
    motion = bench.actuator(port=0)
    client = bench.connect("robot1.motion")
    client.send(line + b"\n")
    bench.tick_until(lambda: caplog.text)
    assert said in caplog.text
    assert motion.local_data["w"] == 0.0
    client.send(b'{"v": 1.0}\n')
    bench.tick_until(lambda: motion.local_data["v"] == 1.0)
    client.close()


def test_a_flood_of_bad_messages_does_not_flood_the_log(bench: Bench, caplog: pytest.LogCaptureFixture) -> None:
    motion = bench.actuator(port=0)
    client = bench.connect("robot1.motion")
    for _ in range(50):
        client.send(b"{nope\n" * 40)
        bench.tick()
    client.send(b'{"v": 1.0}\n')
    bench.tick_until(lambda: motion.local_data["v"] == 1.0)
    assert caplog.text.count("cannot be read") == 1
    client.close()


def test_what_is_refused_again_is_logged_again(
    bench: Bench, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At once for each field and client, although the last line of its kind is less than ten seconds old."""
    monkeypatch.setattr("morse.core.clients.complaints._PERIOD", 1e9)
    motion = bench.actuator(port=0)
    one, other = bench.connect("robot1.motion"), bench.connect("robot1.motion")

    def refusals(client: Peer, message: bytes, number: int) -> int:
        """The lines of the log after three equal messages; a good one of another field tells that they were read."""
        client.send(message * 3 + b'{"w": %d}\n' % number)
        bench.tick_until(lambda: motion.local_data["w"] == number)
        return caplog.text.count("'v' is nan")

    bad, good = b'{"v": NaN}\n', b'{"v": 1.0}\n'
    assert refusals(one, bad, 1) == 1
    assert refusals(one, bad, 2) == 1, "it is still refused"
    assert refusals(other, bad, 3) == 2, "another client"
    assert refusals(one, good, 4) == 2
    assert refusals(one, bad, 5) == 3, "it begins again"
    assert refusals(other, bad, 6) == 3, "the good message was not of this client"
    one.send(b'{"w": "x"}\n')
    bench.tick_until(lambda: "'w' is 'x'" in caplog.text)
    one.close()
    other.close()


def test_a_client_that_is_right_and_wrong_in_turn_does_not_flood_the_log(
    bench: Bench, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("morse.core.clients.complaints._PERIOD", 1e9)
    motion = bench.actuator(port=0)
    client = bench.connect("robot1.motion")
    for number in range(1, 51):
        client.send(b'{"v": NaN}\n{"v": %d}\n' % number)
        bench.tick_until(lambda number=number: motion.local_data["v"] == number)
    assert 2 <= caplog.text.count("'v' is nan") <= 12
    client.close()


def test_modifiers_run_only_when_something_arrived(bench: Bench) -> None:
    motion = bench.actuator(port=0)
    calls = []

    class Counting:
        def modify(self) -> None:
            calls.append(dict(motion.local_data))

    motion.input_modifiers.append(Counting())
    client = bench.connect("robot1.motion")
    bench.tick()
    assert calls == []
    client.send(b'{"v": 1.0}\n')
    bench.tick_until(lambda: calls)
    assert [call["v"] for call in calls] == [1.0]
    client.send(b'{"v": "refused"}\n{nope\n')
    bench.tick_until(lambda: not bench.streams._servers["robot1.motion"].inbox)
    bench.tick()
    assert len(calls) == 1
    client.close()


def test_the_first_command_acts_one_tick_after_its_connection(bench: Bench) -> None:
    motion = bench.actuator(port=0)
    inbox = bench.streams._servers["robot1.motion"].inbox
    client = bench.connect("robot1.motion")
    client.send(b'{"v": 1.0}\n')
    wait_until(lambda: inbox)
    bench.tick()
    assert motion.local_data["v"] == 0.0
    bench.tick()
    assert motion.local_data["v"] == 1.0
    client.send(b'{"v": 2.0}\n')
    wait_until(lambda: inbox)
    bench.tick()
    assert motion.local_data["v"] == 2.0
    client.close()


def test_a_client_that_steps_the_simulation_need_not_wait_for_its_first_command(bench: Bench) -> None:
    bench.context.paused = lambda: True
    motion = bench.actuator(port=0)
    client = bench.connect("robot1.motion")
    client.send(b'{"v": 1.0}\n')
    wait_until(lambda: bench.streams._servers["robot1.motion"].inbox)
    bench.tick()
    assert motion.local_data["v"] == 1.0
    client.close()


def test_several_clients_write_and_the_last_one_wins(bench: Bench, caplog: pytest.LogCaptureFixture) -> None:
    motion = bench.actuator(port=0)
    first = bench.connect("robot1.motion")
    second = bench.connect("robot1.motion")
    assert "the last one that writes wins" in caplog.text
    first.send(b'{"v": 1.0}\n')
    bench.tick_until(lambda: motion.local_data["v"] == 1.0)
    second.send(b'{"v": 2.0}\n')
    bench.tick_until(lambda: motion.local_data["v"] == 2.0)
    first.close()
    second.close()


def test_a_message_without_an_end_is_reported(bench: Bench, caplog: pytest.LogCaptureFixture) -> None:
    motion = bench.actuator(port=0)
    client = bench.connect("robot1.motion")
    client.send(b'{"v": 1.0}')
    client.close()
    wait_until(lambda: "in the middle of a message" in caplog.text)
    bench.tick()
    assert motion.local_data["v"] == 0.0


def test_a_message_that_never_ends_is_cut_off(
    bench: Bench, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("morse.wire.lines.MAX_LINE", 100_000)
    bench.actuator(port=0)
    client = bench.connect("robot1.motion")
    with contextlib.suppress(ConnectionError):  # it may be disconnected before all of it is sent
        client.send(b"1" * 200_000)
    wait_until(client.has_ended)
    assert "without a line end" in caplog.text
    client.close()


def test_what_was_sent_before_leaving_counts(bench: Bench) -> None:
    motion = bench.actuator(port=0)
    client = bench.connect("robot1.motion")
    client.send(b'{"v": 1.0}\n')
    client.close()
    bench.tick_until(lambda: motion.local_data["v"] == 1.0)


class TestInbox:
    def test_keeps_the_order(self) -> None:
        inbox = Inbox()
        assert not inbox
        inbox.put(b"1")
        inbox.put(b"2")
        assert inbox
        assert inbox.take() == ([b"1", b"2"], 0)
        assert not inbox

    def test_what_follows_an_early_message_waits_with_it(self) -> None:
        inbox = Inbox()
        inbox.put(b"1")
        inbox.put(b"2", early=True)
        inbox.put(b"3")
        assert inbox.take() == ([b"1"], 0)
        assert inbox
        inbox.put(b"4")
        assert inbox.take() == ([b"2", b"3", b"4"], 0)
        assert not inbox

    def test_gives_up_the_oldest_of_too_many(self) -> None:
        inbox = Inbox()
        for n in range(1000):
            inbox.put(b"%d" % n)
        lines, dropped = inbox.take()
        assert lines[-1] == b"999"
        assert len(lines) + dropped == 1000
        assert len(lines) < 100
        assert inbox.take() == ([], 0)

    def test_gives_up_the_oldest_of_too_large_ones_but_never_the_last(self) -> None:
        inbox = Inbox()
        for letter in (b"a", b"b", b"c"):
            inbox.put(letter * (1 << 20))
        lines, dropped = inbox.take()
        assert [line[:1] for line in lines] == [b"c"]
        assert dropped == 2


def test_complaints_are_counted_not_repeated(caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("morse.core.clients.complaints._PERIOD", 10.0)  # as it is without conftest.py
    now = [0.0]
    complaints = Complaints(logging.getLogger("morse.test"), lambda: now[0])
    for _ in range(100):
        complaints.warn("a", "it hurts")
    complaints.warn("b", "it itches")
    assert [record.getMessage() for record in caplog.records] == ["it hurts", "it itches"]
    now[0] = 11.0
    complaints.warn("a", "it hurts")
    assert caplog.records[-1].getMessage() == "it hurts (99 more of this kind)"


class Kelvin(SocketPublisher):
    def encode(self) -> str | None:
        if not self.component_instance.active:
            return None
        return f"{self.component_name} {self.data['temperature'] + 273.15:.2f} {self.kwargs['unit']}"


class Silent(SocketPublisher):
    def encode(self) -> None:
        return None


class Pairs(SocketReader):
    def decode(self, msg: bytes) -> dict[str, float]:
        name, value = msg.decode().split("=")
        return {name: float(value)}


def test_users_may_write_their_own_streams(bench: Bench, caplog: pytest.LogCaptureFixture) -> None:
    bench.add(Thermometer(Body("robot1.pose")), "OUT", f"{__name__}.Kelvin", unit="K", port=0)
    motion = bench.add(Motion(Body("robot1.motion")), "IN", f"{__name__}.Pairs", port=0)
    bench.add(Thermometer(Body("robot1.silent")), "OUT", f"{__name__}.Silent", port=0)
    out, into, silent = (bench.connect(name) for name in ("robot1.pose", "robot1.motion", "robot1.silent"))
    into.send(b"v=0.5\n")
    bench.tick_until(lambda: motion.local_data["v"] == 0.5)
    into.send(b"v=0.5=3\nv=1.5\n")
    bench.tick_until(lambda: motion.local_data["v"] == 1.5)
    assert "cannot be read (ValueError: too many values" in caplog.text
    wait_until(out.lines)
    assert out.lines()[0] == b"robot1.pose 293.65 K"
    assert silent.lines() == []
    for peer in (out, into, silent):
        peer.close()


def test_a_stream_of_another_kind_is_refused(bench: Bench) -> None:
    with pytest.raises(MorseMiddlewareError, match="not a stream of the socket"):
        bench.add(Thermometer(Body("robot1.pose")), "OUT", "morse.core.sensor.Sensor")


def test_ports_count_up_from_60000() -> None:
    bench = Bench()
    ports = [bench.port_of(bench.sensor(f"robot1.pose{n}").name()) for n in range(3)]
    assert ports == sorted(set(ports))
    assert 60000 <= ports[0] < ports[2] < 61000
    bench.close()


def test_a_port_that_is_asked_for_is_taken_unless_it_is_in_use(bench: Bench, caplog: pytest.LogCaptureFixture) -> None:
    probe = listen("127.0.0.1", [0])
    free = port_of(probe)
    probe.close()
    bench.sensor("robot1.a", port=free)
    assert bench.port_of("robot1.a") == free
    assert not caplog.text
    bench.sensor("robot1.b", port=free)
    assert bench.port_of("robot1.b") > free
    assert f"robot1.b: port {free} is in use" in caplog.text


@pytest.mark.parametrize("port", ["60000", -1, 70000, 1.5, True])
def test_a_port_that_is_none_is_refused(bench: Bench, port: object) -> None:
    with pytest.raises(MorseMiddlewareError, match=r"the option 'port' of robot1.pose is a port number"):
        bench.sensor(port=port)


def test_an_unknown_option_of_the_manager_is_refused(bench: Bench) -> None:
    with pytest.raises(OptionError, match="did you mean 'time_sync'"):
        SocketDatastreamManager({"timesync": True}, bench.context)


def test_a_component_that_is_made_again_keeps_its_port_and_its_clients(bench: Bench) -> None:
    """As after a restart of the simulation with another seed."""
    old = bench.actuator(port=0)
    port = bench.port_of("robot1.motion")
    client = bench.connect("robot1.motion")
    client.send(b'{"v": 1.0}\n')
    wait_until(lambda: bench.streams._servers["robot1.motion"].inbox)
    bench.components.clear()
    new = bench.actuator(port=0)
    assert bench.port_of("robot1.motion") == port
    bench.tick()
    assert new.local_data["v"] == 0.0, "what was sent to the old one is void"
    client.send(b'{"v": 2.0}\n')
    bench.tick_until(lambda: new.local_data["v"] == 2.0)
    assert old.local_data["v"] == 0.0
    client.close()


def test_both_directions_share_a_port(bench: Bench) -> None:
    class Both(Sensor):
        pass

    component = Both(Body("robot1.both"))
    component.local_data["x"] = 1.0
    bench.add(component, "OUT", port=0)
    bench.streams.connect(
        component,
        StreamDeclaration(bench.streams.classpath, "morse.middleware.socket_datastream.SocketReader", "IN"),
    )
    client = bench.connect("robot1.both")
    client.send(b'{"x": 2.5}\n')
    (read,) = component.input_functions
    wait_until(lambda: read(component))
    bench.tick()
    wait_until(client.lines)
    assert json.loads(client.lines()[-1])["x"] == 2.5
    client.close()


def test_a_thousand_clients_come_and_go_and_leave_nothing(bench: Bench) -> None:
    bench.sensor(port=0)
    bench.actuator(port=0)
    names: list[str | None] = ["robot1.pose", "robot1.motion", None]
    ports = [bench.port_of("robot1.pose"), bench.port_of("robot1.motion"), bench.requests.port]
    servers = [bench.streams._servers[name] if name else bench.requests._server for name in names]

    def next_descriptor() -> int:
        with socket.socket() as probe:
            return probe.fileno()

    Peer(ports[0]).close()
    wait_until(lambda: not any(server.connected for server in servers if server))
    before = next_descriptor()
    for n in range(1000):
        peer = Peer(ports[n % 3])
        if n % 2:
            peer.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")  # a hard reset
        if n % 5 == 0:
            peer.send(b"{}\n")
        peer.close()
        if n % 50 == 0:
            bench.tick()
    # a client that has sent a request and disconnected is kept until the reply, in a tick
    wait_until(lambda: bench.tick() or not any(server.connected for server in servers if server))
    bench.tick()
    # a connection is removed shortly before its descriptor is closed
    wait_until(lambda: next_descriptor() <= before)
    client = bench.connect()
    assert bench.call(client, b"1 robot1.motion nothing\n") == b"1 SUCCESS\n"
    client.close()


def test_what_gathers_while_the_network_is_busy_arrives_whole_and_in_order(bench: Bench) -> None:
    pose = bench.sensor(port=0)
    clients = [bench.connect("robot1.pose") for _ in range(3)]
    wait_until(lambda: bench.streams._servers["robot1.pose"].connected == 3)
    busy, free = threading.Event(), threading.Event()

    def keep_busy() -> None:
        busy.set()
        free.wait(30.0)

    bench.context.network.post(keep_busy)
    assert busy.wait(30.0)
    for n in range(500):
        pose.local_data["temperature"] = float(n)
        bench.tick()
    free.set()
    wait_until(lambda: all(len(client.lines()) == 500 for client in clients))
    for client in clients:
        assert [json.loads(line)["temperature"] for line in client.lines()] == [float(n) for n in range(500)]
        client.close()


@given(st.lists(st.binary(min_size=1, max_size=40), min_size=1, max_size=60), st.integers(1, 120))
def test_messages_are_put_together_without_loss(messages: list[bytes], limit: int) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(stream_client, "_HIGH_WATER", limit)
        parcels = list(stream_client._parcels(messages))
    assert b"".join(data for data, _ in parcels) == b"".join(messages)
    assert sum(count for _, count in parcels) == len(messages)
    assert all(len(data) <= limit or count == 1 for data, count in parcels)
