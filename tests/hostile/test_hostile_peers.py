"""Peers of YARP, MOOS, MAVLink and nodes that send valid frames with absurd sizes, or take the places of others."""

from __future__ import annotations

import asyncio
import contextlib
import json
import socket
import socketserver
import struct
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from limited import connect, is_closed

import morse
from morse.builder import ATRV, Environment, MotionVW, Pose
from morse.core.clients.network import Network
from morse.plugins.mavlink import framing, links
from morse.plugins.mavlink.datastream import Intake
from morse.plugins.mavlink.framing import Framer
from morse.plugins.mavlink.links import UdpLink, open_link
from morse.plugins.moos.database import check_packet
from morse.plugins.multinode.server import MultinodeServer
from morse.plugins.yarp.port import Port
from morse.plugins.yarp.wire import Address, NameServer, is_alive
from morse.wire.listener import listen, port_of
from tests.kit.effort import examples
from tests.kit.programs import free_port
from tests.kit.waiting import run_apart, wait_until

MINUTE = 60.0


@pytest.fixture
def network() -> Iterator[Network]:
    network = Network()
    yield network
    network.stop()


# -- YARP ------------------------------------------------------------------------------------


@pytest.mark.parametrize("word", ["'1' * 131_000 + 'x'", "'1.' + '1' * 131_000 + 'x'", "'1e' + '1' * 131_000 + 'x'"])
def test_a_long_word_that_is_not_quite_a_number_is_read_in_linear_time(word: str) -> None:
    """It took minutes, in which no other thread ran."""
    code = f"from morse.plugins.yarp.bottle import from_text; assert from_text({word}) == [{word}]"
    subprocess.run([sys.executable, "-c", code], timeout=MINUTE, check=True)


class Names:
    """A name server that says what it likes.

    Attributes:
        answer: called with the words of a request.
    """

    def __init__(self, answer: Callable[[list[str]], bytes]) -> None:
        self.answer = answer
        names = self

        class Handler(socketserver.StreamRequestHandler):
            def handle(self) -> None:
                words = self.rfile.readline().decode().split()
                with contextlib.suppress(ConnectionError):
                    self.wfile.write(names.answer(words))

        class Server(socketserver.ThreadingTCPServer):
            daemon_threads = True

        self._server = Server(("127.0.0.1", 0), Handler)
        self.port = self._server.server_address[1]
        threading.Thread(target=self._server.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True).start()

    def __enter__(self) -> Names:
        return self

    def __exit__(self, *_: object) -> None:
        self._server.shutdown()
        self._server.server_close()


#: what follows ``ip`` in the answer
PLACES = [
    "127.0.0.1 port 99999",
    "127.0.0.1 port " + "9" * 5000,
    "\0 port 5",
    "x" * 300 + " port 5",
    "." * 70 + " port 5",
]


@pytest.mark.parametrize("place", PLACES)
def test_addresses_of_a_name_server_that_are_none_do_not_end_the_registration(place: str) -> None:
    known: dict[str, str] = {}

    def answer(words: list[str]) -> bytes:
        command, name = words[1:3]
        if command == "register":
            known[name] = f"{words[4]} port {words[5]}"
        # only the first answer is absurd
        where = known.get(name) if nonsense.is_set() else place
        nonsense.set()
        return (f"registration name {name} ip {where} type tcp\n" if where else "").encode() + b"*** end of message\n"

    nonsense = threading.Event()
    with Names(answer) as names:

        def scene() -> None:
            robot, pose = ATRV("robot"), Pose("pose")
            pose.add_stream("yarp")
            robot.append(pose)
            Environment("empty", fastmode=True).configure_stream_manager("yarp", port=names.port)

        with morse.load(scene, sockets=True) as simulation:
            wait_until(lambda: simulation.step() or "/morse/robot/pose/out" in known)


def test_no_machine_has_a_name_with_a_nul() -> None:
    assert run_apart(is_alive(Address("\0", 5))) is False


def test_an_answer_of_a_name_server_without_end_is_not_kept() -> None:
    with Names(lambda _: (b"x" * 60_000 + b"\n") * 100 + b"*** end\n") as names, pytest.raises(OSError, match="65536"):
        run_apart(NameServer("127.0.0.1", names.port).query("/reader"))


def test_a_connection_to_a_reader_ends_with_the_next_one_though_somebody_claims_its_name(network: Network) -> None:
    reader, own = listen("127.0.0.1", (0,)), listen("127.0.0.1", (0,))
    reader.settimeout(MINUTE)
    number = port_of(own)

    async def query(_: str) -> Address:
        return Address("127.0.0.1", port_of(reader))

    port = Port("/out", SimpleNamespace(query=query), None, network.arrivals)  # type: ignore[arg-type]
    network.call(port.open(own))
    ends = []
    with connect(number) as claimant:
        claimant.sendall(b"CONNECT /reader\n")
        assert claimant.recv(7) == b"Welcome"
        for _ in range(2):
            adding = asyncio.run_coroutine_threadsafe(port._add("/reader", "fast_tcp"), network.loop)
            end, _ = reader.accept()
            end.sendall(b"YA\0\0\0\0RP")
            assert adding.result(MINUTE)[0] == 0
            ends.append(end)
        wait_until(lambda: is_closed(ends[0]))
    network.call(port.close())
    for one in (*ends, reader):
        one.close()


# -- MOOS ------------------------------------------------------------------------------------


def note(strings: list[bytes], size: int | None = None) -> bytes:
    """A message of MOOS with five strings; ``size`` replaces its true size."""
    parts = [struct.pack("<i", len(text)) + text for text in strings]
    inner = struct.pack("<iBB", 1, 78, 68) + b"".join(parts[:4]) + struct.pack("<3d", 1.0, 2.0, 0.0) + parts[4]
    return struct.pack("<i", len(inner) + 4 if size is None else size) + inner


def packet(*notes: bytes, count: int | None = None) -> bytes:
    body = b"".join(notes)
    return struct.pack("<iiB", len(body) + 9, len(notes) if count is None else count, 0) + body


@given(notes=st.lists(st.lists(st.binary(max_size=20), min_size=5, max_size=5), max_size=5))
@settings(max_examples=examples(50))
def test_packets_of_a_database_are_accepted(notes: list[list[bytes]]) -> None:
    check_packet(packet(*map(note, notes)), 10)


NO_TEXT = [b""] * 5
#: a head whose first string reaches over all that follows
_REACHING = struct.pack("<iiBBi", 14, 1, 78, 68, 14 * 99)


@pytest.mark.parametrize(
    "data",
    [
        packet(note(NO_TEXT, size=0), count=2**31 - 1),
        packet(note(NO_TEXT, size=0), note(NO_TEXT)),
        packet(note(NO_TEXT, size=-50), note(NO_TEXT)),
        packet(note(NO_TEXT, size=2**31 - 1), note(NO_TEXT)),
        packet(_REACHING * 100, note(NO_TEXT), count=101),
        packet(note(NO_TEXT).replace(b"D" + bytes(4), b"D" + struct.pack("<i", -20), 1)),
        packet(note(NO_TEXT), count=-1),
        packet(note(NO_TEXT), count=11),
        packet(note(NO_TEXT)[:-5]),
    ],
)
def test_the_sizes_in_a_packet_of_a_database_are_checked_before_it_is_read(data: bytes) -> None:
    """A packet of 70 bytes filled the memory: its only message was read two billion times."""
    with pytest.raises((ValueError, struct.error)):
        check_packet(data, 10)


# -- MAVLink ---------------------------------------------------------------------------------

#: an empty COMMAND_LONG of version 1 with a wrong checksum
_EMPTY = bytes([0xFE, 0, 0, 1, 1, 76, 0, 0])


def test_strangers_do_not_displace_a_silent_peer_that_speaks_mavlink() -> None:
    address = "127.0.0.1", free_port(socket.SOCK_DGRAM)
    link = UdpLink("udpin", address, socket.AF_INET, listens=True)
    strangers = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(30)]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as pilot:
        pilot.settimeout(MINUTE)
        pilot.sendto(b"\xfd", address)
        ((sender, _),) = wait_until(lambda: list(link.receive()))
        link.understood(sender)
        for stranger in strangers:
            stranger.sendto(b"x", address)
            wait_until(lambda: list(link.receive()))
        link.send(b"telemetry")
        assert pilot.recv(100) == b"telemetry"
    link.close()
    for stranger in strangers:
        stranger.close()


def test_one_message_does_not_keep_a_place_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    monkeypatch.setattr(links, "time", SimpleNamespace(monotonic=lambda: now[0]))
    number = free_port(socket.SOCK_STREAM)
    link: Any = open_link(f"tcpin:127.0.0.1:{number}")
    former = [connect(number) for _ in range(16)]
    wait_until(lambda: list(link.receive()) or len(link._connections) == 16)
    for one in list(link._connections):
        link.understood(one)
    with connect(number) as late:
        wait_until(lambda: list(link.receive()) or is_closed(late))
    now[0] = MINUTE
    with connect(number) as autopilot:
        autopilot.sendall(b"\xfd and so on")
        ((_, data),) = wait_until(lambda: list(link.receive()))
        assert data == b"\xfd and so on"
    link.close()
    for sock in former:
        sock.close()


def test_floods_leave_each_sender_a_part() -> None:
    intake = Intake()
    for number in range(15):
        list(intake.frames(number, Framer({76}), _EMPTY * 7_500))
    assert [one.data for one in intake.frames("pilot", Framer({76}), _EMPTY * 5)] == [_EMPTY] * 5


def test_noise_that_could_begin_messages_is_skipped(monkeypatch: pytest.MonkeyPatch) -> None:
    """To look at each byte took 37 ms of every tick."""
    candidates = []
    monkeypatch.setattr(framing, "_frame", lambda data, at: candidates.append(at))
    for noise in (b"\xfe", b"\xfd", b"\xfe\0", b"\xfd\0\0", b"\xfe\xfd"):
        list(Framer({76}).feed(noise * 8_000))
    assert len(candidates) <= 5


@settings(max_examples=examples(200))
@given(st.lists(st.sampled_from([b"\xfe", b"\xfd", b"\0", b"\x01", b"L", b"\0\0\0", b"\0L\0\0"]), max_size=80))
def test_messages_are_the_same_in_pieces_and_at_once(parts: list[bytes]) -> None:
    data = b"".join(parts)
    at_once = [frame.data for frame in Framer({76, 1}).feed(data)]
    framer = Framer({76, 1})
    assert [frame.data for part in parts for frame in framer.feed(part)] == at_once
    for frame in at_once:
        assert frame in data
        number = frame[5] if frame[0] == 0xFE else int.from_bytes(frame[7:10], "little")
        assert number in (76, 1)


def test_senders_of_messages_take_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each of them has a message in a tick, even if the time for all of them is used."""
    common = pytest.importorskip("pymavlink.dialects.v20.common")
    number = free_port(socket.SOCK_DGRAM)

    def scene() -> None:
        robot, motion = ATRV("robot"), MotionVW("motion")
        motion.add_stream("mavlink", device=f"udpin:127.0.0.1:{number}")
        robot.append(motion)
        Environment("empty")

    mav = common.MAVLink(None)
    command = mav.command_long_encode(1, 1, 400, 0, *[0.0] * 7).pack(mav)
    with morse.load(scene, sockets=True) as sim, ExitStack() as stack:
        manager = next(one for path, one in sim.context.stream_managers.items() if "mavlink" in path)
        monkeypatch.setattr(manager, "_share", SimpleNamespace(begin=lambda: False, end_request=lambda: True))
        sim.context.paced = lambda: True
        flood, pilot = (stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) for _ in range(2))
        flood.sendto(command * 20, ("127.0.0.1", number))
        pilot.sendto(command, ("127.0.0.1", number))
        for sock in (flood, pilot):
            sock.settimeout(0.0)
        answers: dict[socket.socket, list[int]] = {flood: [], pilot: []}

        def both_are_answered() -> bool:
            sim.step()
            for sock, kinds in answers.items():
                with contextlib.suppress(BlockingIOError):
                    while data := sock.recv(1 << 12):
                        kinds.append(int.from_bytes(data[7:10], "little"))
            return all(common.MAVLINK_MSG_ID_COMMAND_ACK in kinds for kinds in answers.values())

        wait_until(both_are_answered)
        # an answer goes to all peers: not more than one to each of the two
        assert max(kinds.count(common.MAVLINK_MSG_ID_COMMAND_ACK) for kinds in answers.values()) <= 2


# -- nodes -----------------------------------------------------------------------------------


def test_the_node_with_most_robots_leaves_if_there_are_too_many(network: Network) -> None:
    listener = listen("127.0.0.1", (0,))
    server = MultinodeServer(listener, network)
    pose = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
    with connect(port_of(listener)) as greedy, connect(port_of(listener)) as node, node.makefile("rb") as lines:
        greedy.settimeout(MINUTE)
        greedy.sendall(json.dumps(["greedy", {str(number): pose for number in range(9_990)}]).encode() + b"\n")
        assert greedy.recv(100) == b"{}\n"
        node.sendall(json.dumps(["node", {f"robot{number}": pose for number in range(20)}]).encode() + b"\n")
        assert json.loads(lines.readline()) == {}
        wait_until(lambda: is_closed(greedy))
    server.close()
