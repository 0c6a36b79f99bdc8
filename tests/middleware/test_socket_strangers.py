"""Clients with another protocol, above all browsers, are disconnected before any of their data are processed."""

import contextlib
import itertools
import logging
import socket
from collections.abc import Iterator

import pytest
from hypothesis import given
from hypothesis import strategies as st
from socket_bench import Bench, Peer

from morse.wire.lines import FirstLine
from morse.wire.listener import listen, port_of
from tests.kit.waiting import wait_until

REQUEST = b'1 robot1.motion echo ["driven by a page"]\n'
COMMAND = b'{"v": 1.0}\n'
BODY = b"\r\nHost: 127.0.0.1:4000\r\nContent-Type: text/plain\r\n\r\n" + REQUEST + COMMAND
STRANGERS = {
    "a form": b"POST / HTTP/1.1" + BODY,
    "lower case": b"post /morse http/1.1" + BODY,
    "a page": b"GET /1%20simulation%20quit HTTP/1.1" + BODY,
    "HTTP 0.9": b"GET /\r\n" + REQUEST + COMMAND,
    "a proxy": b"GET http://127.0.0.1:4000/ HTTP/1.1" + BODY,
    "a tunnel": b"CONNECT 127.0.0.1:4000 HTTP/1.1" + BODY,
    "leave to ask": b"OPTIONS * HTTP/1.1" + BODY,
    "an unknown method": b"BREW coffee HTTP/1.0" + BODY,
    "a long address": b"BREW /" + b"x" * 3000 + b" HTTP/1.0" + BODY,
    "after blank lines": b"\r\n\r\n \r\nPOST / HTTP/1.1" + BODY,
    "HTTP 2": b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + REQUEST + COMMAND,
    "WebSocket": b"GET /ws HTTP/1.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\r\n" + REQUEST + COMMAND,
    "an answer": b"HTTP/1.1 200 OK" + BODY,
    "a discovery": b"M-SEARCH * HTTP/1.1" + BODY,
    "RTSP": b"DESCRIBE rtsp://127.0.0.1/a RTSP/1.0" + BODY,
    "SIP": b"INVITE sip:a@127.0.0.1 SIP/2.0" + BODY,
    "TLS": b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\n" + REQUEST + COMMAND,
    "old TLS": b"\x80\x2e\x01\x03\x01\x00\n" + REQUEST + COMMAND,
    "STUN": b"\x00\x03\x00\x08\x21\x12\xa4\x42\n" + REQUEST + COMMAND,
    "mail": b"EHLO example.org\r\n" + REQUEST + COMMAND,
    "mail in the middle": b"MAIL FROM:<a@example.org>\r\n" + REQUEST + COMMAND,
    "SSH": b"SSH-2.0-OpenSSH_9.2\r\n" + REQUEST + COMMAND,
}
WELCOME = [
    b"1 simulation details []\n",
    b"id1 simulation quit",
    b"POST simulation quit\n",
    b"get robot1.motion get_status\n",
    b"\r\n1 robot1.motion nothing\r\n",
    b"\xff\xfb\x1f1 robot1.motion nothing\r\n",
    b"\xc3\xa4 robot1.motion nothing\n",
    b'{"v": 1.0, "path": "GET / HTTP/1.1"}\n',
    b"[1, 2, 3]\n",
    b"GOTO kitchen/2\n",
    b"LOAD /home/a/b\n",
    b"v=0.5\n",
    b"sync",
    b"x" * 5000,
    b'1 robot1.motion echo ["http://a/b HTTP/1.1"]\n',
]


@pytest.fixture
def paced() -> Iterator[Bench]:
    probe = listen("127.0.0.1", [0])
    port = port_of(probe)
    probe.close()
    bench = Bench({"time_sync": True, "sync_port": port})
    bench.sensor(port=0)
    bench.actuator(port=0)
    yield bench
    bench.close()


def ports(bench: Bench) -> dict[str, int]:
    assert bench.streams._sync is not None
    return {
        "services": bench.requests.port,
        "IN": bench.port_of("robot1.motion"),
        "OUT": bench.port_of("robot1.pose"),
        "sync": port_of(bench.streams._sync._server._listener),
    }


@pytest.mark.parametrize("sent", STRANGERS.values(), ids=STRANGERS.keys())
def test_a_stranger_is_turned_away_on_every_port(paced: Bench, sent: bytes, caplog: pytest.LogCaptureFixture) -> None:
    motion = paced.components[1]
    for name, port in ports(paced).items():
        caplog.clear()
        peer = Peer(port)
        with contextlib.suppress(ConnectionError):
            peer.send(sent)
        wait_until(peer.has_ended)
        assert [record.getMessage() for record in caplog.records if "turned away" in record.getMessage()], name
        assert len([record for record in caplog.records if record.levelno >= logging.WARNING]) == 1, name
        assert peer.received == b"", name
        peer.close()
    client = Peer(ports(paced)["services"])
    assert paced.call(client, b"2 robot1.motion echo [2]\n") == b"2 SUCCESS 2\n"
    assert motion.local_data["v"] == 0.0
    client.close()


@pytest.mark.parametrize("sent", STRANGERS.values(), ids=STRANGERS.keys())
def test_a_stranger_may_come_in_pieces(bench: Bench, sent: bytes) -> None:
    motion = bench.actuator(port=0)
    for size in (1, 2, 7):
        peers = [Peer(bench.requests.port), Peer(bench.port_of("robot1.motion"))]
        for n in range(0, min(len(sent), 400), size):
            for peer in peers:
                peer.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                with contextlib.suppress(OSError):
                    peer.send(sent[n : n + size])
            bench.tick()
        for peer in peers:
            if len(sent) > 400:
                with contextlib.suppress(OSError):
                    peer.send(sent[400:])
            wait_until(peer.has_ended)
            assert peer.received == b""
            peer.close()
    assert motion.local_data["v"] == 0.0


@pytest.mark.parametrize("sent", WELCOME)
def test_clients_are_let_in(sent: bytes) -> None:
    whole = FirstLine()
    assert whole.stranger(sent) is None
    assert whole.over == (b"\n" in sent.lstrip())
    pieces = FirstLine()
    for n in range(len(sent)):
        if pieces.over:
            break
        assert pieces.stranger(sent[n : n + 1]) is None


@given(st.sampled_from(sorted(STRANGERS)), st.lists(st.integers(0, 300)))
def test_a_stranger_is_known_however_the_line_is_cut(name: str, cuts: list[int]) -> None:
    sent = STRANGERS[name]
    line = FirstLine()
    places = [0, *sorted(cut for cut in cuts if cut < len(sent)), len(sent)]
    for begin, end in itertools.pairwise(places):
        if line.stranger(sent[begin:end]):
            return
        assert not line.over
    pytest.fail(f"{name} is let in")


def test_strangers_are_counted_not_repeated(bench: Bench, caplog: pytest.LogCaptureFixture) -> None:
    for _ in range(50):
        peer = Peer(bench.requests.port)
        with contextlib.suppress(ConnectionError):
            peer.send(b"GET / HTTP/1.1\r\n\r\n")
        wait_until(peer.has_ended)
        peer.close()
    assert len(caplog.records) == 1
