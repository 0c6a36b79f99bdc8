"""What clients send gets one share of the time: bytes that become no message, large messages, many clients.

Time is that of clocks that only the tests advance.
"""

import asyncio
import contextlib
import logging
import socket
import struct
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import pytest
from websockets.server import ServerProtocol

from morse.core.clients.budgets import Arrivals, Sender, TimeShare, TimeShares
from morse.core.clients.network import Network
from morse.core.clients.web_connection import PacedConnection
from morse.core.validation import ClientCommands
from morse.plugins.yarp.bottle import decode
from morse.plugins.yarp.bottle import encode as bottle
from morse.plugins.yarp.port import Port
from morse.rosmsgs.cdr import CdrError, encode
from morse.rosmsgs.topics.stream import check_size, largest
from morse.wire.connection import Connection
from morse.wire.listener import listen, port_of
from tests.kit.waiting import run_apart, wait_until

MINUTE = 60.0
HANDSHAKE = (
    b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n"
)
PING = b"\x89\x80\0\0\0\0"


class Clock:
    """Processor time and wall-clock time; both pass only while work is done, or while somebody waits."""

    def __init__(self) -> None:
        self.processor = self.wall = 0.0

    def work(self, seconds: float) -> None:
        self.processor += seconds
        self.wall += seconds

    def arrivals(self) -> Arrivals:
        return Arrivals(lambda: self.processor, lambda: self.wall)


# the share ------------------------------------------------------------------------------------


@pytest.mark.parametrize("clients", [1, 2, 4, 16])
@pytest.mark.parametrize("cost", [0.0001, 0.003, 0.08])
def test_all_clients_together_get_a_quarter_of_the_time(clients: int, cost: float) -> None:
    clock = Clock()
    arrivals = clock.arrivals()
    senders = [arrivals.sender() for _ in range(clients)]
    while clock.wall < 60.0:
        ready = [sender for sender in senders if not sender.rests]
        for sender in ready:
            with sender.measured():
                clock.work(cost)
            sender.rest_if_due()
        if not ready:
            clock.wall += 0.001
    assert 0.08 < clock.processor / clock.wall < 0.3


def test_a_client_with_few_messages_never_rests_beside_a_flood() -> None:
    clock = Clock()
    arrivals = clock.arrivals()
    flood, modest = arrivals.sender(), arrivals.sender()
    for _ in range(600):
        clock.wall += 1 / 60
        if not flood.rests:
            with flood.measured():
                clock.work(0.005)
            flood.rest_if_due()
        assert not modest.rests
        with modest.measured():
            clock.work(0.0005)
        modest.rest_if_due()


def test_a_busy_client_never_rests_while_all_together_use_less_than_the_share() -> None:
    """Among many clients with few messages."""
    clock = Clock()
    arrivals = clock.arrivals()
    busy, others = arrivals.sender(), [arrivals.sender() for _ in range(50)]
    for _ in range(600):
        clock.wall += 1 / 60
        for sender, cost in ((busy, 0.002), *((one, 2e-6) for one in others)):
            with sender.measured():
                clock.work(cost)
            assert not sender.must_rest


def test_messages_that_have_arrived_let_others_run_although_their_client_need_not_rest() -> None:
    """The processor time may be that of a machine that gives the thread little of it."""

    async def run() -> list[str]:
        sender, order = Arrivals(lambda: 0.0).sender(), []

        async def client() -> None:
            for _ in range(3):
                with sender.measured():
                    order.append("message")
                await sender.rest()

        async def other() -> None:
            order.append("other")

        await asyncio.gather(client(), other())
        return order

    assert run_apart(run())[1] == "other"


# WebSockets -----------------------------------------------------------------------------------


class Transport:
    """Collects what is written; the client reads it if it is polite."""

    def __init__(self, *, polite: bool) -> None:
        self.polite, self.written, self.reads = polite, 0, True
        self.is_open = False

    def write(self, data: bytes) -> None:
        self.written += len(data)

    def get_write_buffer_size(self) -> int:
        return 0 if self.polite else self.written

    def pause_reading(self) -> None:
        self.reads = False

    def resume_reading(self) -> None:
        self.reads = True

    def __getattr__(self, name: str) -> Any:
        return lambda *_, **__: None


class Rests:
    """A loop whose timers end when the test says so."""

    def __init__(self) -> None:
        self.durations: list[float] = []
        self._waiting: list[Callable[[], object]] = []

    def call_later(self, duration: float, function: Callable[[], object]) -> Any:
        self.durations.append(duration)
        self._waiting.append(function)
        return SimpleNamespace(cancel=lambda: None)

    def end(self) -> bool:
        """End the rest; whether there was one."""
        waiting, self._waiting = self._waiting, []
        for function in waiting:
            function()
        return bool(waiting)


def open_websocket(cost: float, *, polite: bool = True) -> tuple[PacedConnection, Transport, Rests]:
    """An open connection whose bytes cost processor time whenever they are processed."""
    reading = [0.0]

    def processor() -> float:
        reading[0] += cost if transport.is_open else 0.0
        return reading[0]

    async def make() -> PacedConnection:
        async def handler(_: Any) -> None:
            """Read nothing."""

        server: Any = SimpleNamespace(handler=handler, handler_tasks=set())
        made = PacedConnection(
            Arrivals(processor, lambda: 10.0 if transport.is_open else 0.0), ServerProtocol(), server, max_queue=4
        )
        made.place = SimpleNamespace(begin=lambda _: None, stage=0, keeps_place=False)  # type: ignore[assignment]
        made.connection_made(transport)  # type: ignore[arg-type] # a stand-in
        made.data_received(HANDSHAKE)
        assert made.request is not None
        made.protocol.send_response(made.protocol.accept(made.request))
        made.protocol.data_to_send()
        transport.is_open = True
        return made

    transport, rests = Transport(polite=polite), Rests()
    connection = run_apart(make())
    connection.loop = rests  # type: ignore[assignment] # a stand-in
    return connection, transport, rests


def test_pings_rest_like_messages_and_all_are_answered() -> None:
    connection, transport, rests = open_websocket(0.005)
    count = 40_000
    connection.data_received(PING * count)  # one read of a flood
    assert transport.written < 2 * 1000, "the bytes of a read are not processed at once"
    assert not transport.reads
    assert rests.durations == [pytest.approx(0.015)]
    while rests.end():
        pass
    assert transport.written == 2 * count
    assert transport.reads
    long = [duration for duration in rests.durations if duration]
    assert len(long) > 20
    assert long == pytest.approx([0.015] * len(long))


def test_a_client_with_few_bytes_is_answered_at_once() -> None:
    connection, transport, rests = open_websocket(1e-4)
    connection.data_received(PING)
    assert (transport.written, transport.reads, rests.durations) == (2, True, [])


def test_pings_of_a_client_that_reads_no_answers_take_no_memory() -> None:
    connection, transport, rests = open_websocket(0.0, polite=False)
    for _ in range(50):
        if transport.reads:
            connection.data_received(b"\x89\xfd\0\0\0\0" + bytes(125) + PING * 1000)
        rests.end()
    assert transport.written < 100_000
    assert not transport.reads


def test_a_full_queue_of_messages_stops_the_processing_of_bytes_that_have_arrived() -> None:
    connection, transport, rests = open_websocket(0.0)
    connection.data_received(b"\x81\x80\0\0\0\0" * 40_000)  # empty messages
    while rests.end():  # it lets others run
        pass
    assert not transport.reads
    assert len(connection.recv_messages.frames) < 1000


def test_connections_that_are_opened_again_and_again_get_the_part_of_one_client() -> None:
    """Each of them sends one request."""
    clock = Clock()
    arrivals = clock.arrivals()

    async def run() -> tuple[int, int]:
        async def handler(_: Any) -> None:
            """Answer nothing."""

        server: Any = SimpleNamespace(handler=handler, handler_tasks=set())
        connections, rests = [], Rests()
        for _ in range(200):
            made = PacedConnection(arrivals, ServerProtocol(), server)
            made.loop = rests  # type: ignore[assignment] # a stand-in
            rests.create_task = asyncio.ensure_future  # type: ignore[attr-defined]
            made.place = SimpleNamespace(begin=lambda _: None, stage=0, keeps_place=False)  # type: ignore[assignment]
            made.connection_made(Transport(polite=True))  # type: ignore[arg-type] # a stand-in
            made.data_received(HANDSHAKE)
            connections.append(made)
        at_once = sum(one.request is not None for one in connections)
        while any(one.request is None for one in connections):
            clock.wall += 0.001
            assert clock.wall < 10.0
            rests.end()
        return at_once, round(clock.wall / 0.001)

    at_once, milliseconds = run_apart(run())
    assert at_once < 20
    assert 200 / 0.4 < milliseconds < 200 / 0.1


# sockets --------------------------------------------------------------------------------------


@pytest.fixture
def network() -> Iterator[Network]:
    made = Network()
    yield made
    made.stop()


def test_lines_that_take_long_have_to_rest(network: Network) -> None:
    """The next bytes of that connection are read later; those of another one at once."""
    readings = iter(range(10**9))
    network.arrivals.processor = lambda: float(next(readings)) * 100.0
    heard: dict[str, int] = {"flood": 0, "modest": 0}
    server = listen("127.0.0.1", (0,))

    def connection_of(name: str) -> tuple[Connection, socket.socket]:
        peer = socket.create_connection(("127.0.0.1", port_of(server)))
        server.setblocking(True)
        made = Connection(network, server.accept()[0], comes_first=False)

        def received(data: bytes) -> None:
            heard[name] += len(data)

        listener: Any = SimpleNamespace(
            data_received=received, eof_received=lambda: False, connection_lost=lambda _: None
        )

        async def start() -> None:
            made.start(listener)

        network.call(start())
        return made, peer

    flood, sender = connection_of("flood")
    modest, other = connection_of("modest")
    sender.sendall(bytes(1 << 16))
    wait_until(lambda: heard["flood"] > 0)
    other.sendall(b"line\n")
    wait_until(lambda: heard["modest"] == 5)
    assert heard["flood"] < 1 << 16, "it rests for some minutes"

    async def end() -> None:
        flood.abort()
        modest.abort()

    network.call(end())
    for one in (sender, other, server):
        one.close()


# YARP -----------------------------------------------------------------------------------------


def message(command: bytes, data: bytes) -> bytes:
    lead = b"\0\0\0\0~" + command + b"\0\1"
    index = bytes((2, 1)) + b"\xff" * 8 + struct.pack("<iii", len(lead), len(data), 0)
    return b"YA" + struct.pack("<i", 10) + b"RP" + index + lead + data


HELLO = b"YA" + struct.pack("<i", 7777 + 3) + b"RP" + struct.pack("<i", 3) + b"/x\0"


def to_port(data: bytes, arrivals: Arrivals, *, takes: bool) -> list[Any]:
    """What a port takes of some bytes until it closes the connection, or until they are over."""
    taken: list[Any] = []

    async def run() -> None:
        take = (lambda values, _: taken.append(values)) if takes else None
        port = Port("/p", SimpleNamespace(), take, arrivals)  # type: ignore[arg-type] # it asks for no names
        listener = listen("127.0.0.1", (0,))
        number = port_of(listener)
        await port.open(listener)
        async with asyncio.timeout(MINUTE):
            reader, writer = await asyncio.open_connection("127.0.0.1", number)
            writer.write(data)
            with contextlib.suppress(OSError):
                await writer.drain()
                writer.write_eof()
                await reader.read()
            writer.close()
            await port.close()

    run_apart(run())
    return taken


@pytest.mark.parametrize(
    "data",
    [
        HELLO + message(b"D", bottle([[1, 2.0]] * 60_000)),
        b"CONNECT x\r\nd\n" + b"(1) " * 240_000 + b"\n",
        HELLO + message(b"a", bottle(["list", *range(5000)])),
        b"CONNECT x\r\na\nlist " + b"1 " * 5000 + b"\n",
        b"CONNECT " + b"x" * 500_000 + b"\r\n",
    ],
    ids=["bottle", "text", "command", "text of a command", "name"],
)
def test_what_is_far_too_large_for_a_port_is_refused_before_it_is_decoded(
    data: bytes, caplog: pytest.LogCaptureFixture
) -> None:
    assert to_port(data, Arrivals(), takes=True) == []
    assert caplog.text.count("is closed") == 1


def test_bottles_of_usual_size_arrive_and_rest() -> None:
    arrivals = Arrivals()
    rests: list[float] = []
    begin = Sender.begin_rest

    def counted(self: Sender) -> float:
        rests.append(begin(self))
        return 0.0

    data = bottle([[1, 2.0]] * 4000)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Sender, "begin_rest", counted)
        assert len(to_port(HELLO + message(b"D", data) * 20, arrivals, takes=True)) == 20
    assert rests


@pytest.mark.parametrize(("tag", "form"), [(32, "b"), (64, "h"), (1, "i"), (17, "q"), (128, "f"), (10, "d")])
def test_lists_of_numbers_are_read_at_once_and_as_before(tag: int, form: str) -> None:
    values = [1, -2, 3]
    data = struct.pack(f"<ii3{form}", 256 | tag, 3, *values)
    assert decode(data) == values
    assert {type(value) for value in decode(data)} == {float if form in "fd" else int}
    with pytest.raises(ValueError, match=r"announced|values"):
        decode(data[:-1])


# ROS 2 ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["Twist", "PoseStamped", "TwistStamped", "Wrench"])
def test_a_message_far_larger_than_its_type_is_refused_before_it_is_decoded(kind: str) -> None:
    name = f"geometry_msgs/msg/{kind}"
    usual = encode(name, {})
    check_size(name, usual)
    assert len(usual) < largest(name) <= max(1 << 13, 100 * len(usual))
    with pytest.raises(CdrError, match="at most"):
        check_size(name, usual + bytes(100 * max(100, len(usual))))


def test_names_of_joints_are_limited_and_those_of_any_robot_fit() -> None:
    joints = [f"left_arm_joint_{number}" for number in range(1000)]
    kind = "sensor_msgs/msg/JointState"
    check_size(kind, encode(kind, {"name": joints, "position": [0.0] * 1000}))
    with pytest.raises(CdrError, match="at most"):
        check_size(kind, encode(kind, {"name": ["joint"] * 300_000}))


# services in a tick ---------------------------------------------------------------------------


@pytest.mark.parametrize("floods", [1, 2, 5])
def test_floods_of_several_middlewares_get_the_share_of_one(floods: int, monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr("morse.core.clients.budgets.perf_counter", lambda: now[0])
    together = TimeShares()
    shares, spent = [TimeShare(together) for _ in range(floods)], [0.0] * floods
    while now[0] < 130.0:
        now[0] += 1 / 60
        for number, share in enumerate(shares):
            if not share.begin():
                continue
            while True:
                now[0] += 0.003
                spent[number] += 0.003
                if share.end_request():
                    break
    assert 0.2 < sum(spent) / 30.0 < 0.4
    assert min(spent) > 0.5 * max(spent)


# commands in a tick ---------------------------------------------------------------------------


class Field:
    """A component that clients command."""

    def __init__(self, clock: Clock, *, paced: bool) -> None:
        self.local_data: dict[str, Any] = {"v": 0.0}
        self.context: Any = SimpleNamespace(arrivals=clock.arrivals(), paced=lambda: paced, strict=False)

    def name(self) -> str:
        return "robot.motion"


@pytest.mark.parametrize("paced", [True, False])
def test_commands_that_take_long_wait_for_later_ticks_only_in_real_time(paced: bool) -> None:
    """A client that steps the simulation gets all of its commands."""
    clock = Clock()
    component = Field(clock, paced=paced)
    commands = ClientCommands(component, logging.getLogger("morse.test"))

    def read(message: Any) -> Any:
        clock.work(0.05)
        return {"v": message}

    assert commands.take(read, 1.0)
    assert component.local_data["v"] == 1.0
    assert commands.rest is paced
    clock.wall += 0.2
    assert not commands.rest
