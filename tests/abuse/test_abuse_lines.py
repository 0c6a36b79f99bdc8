"""Malformed lines, fragments and floods on every port, while another client must not be affected."""

import itertools
import random
import socket
import threading
from concurrent.futures import ThreadPoolExecutor

import pytest
from victims import Victim
from wire import Witness, drained

from tests.kit.programs import Line

SHORT, LONG = 4_000, 1_000_000
MALFORMED = (
    b"",
    b" ",
    b"\0",
    b"\r",
    b"1",
    b"1 simulation",
    b"1 nobody nothing",
    b"1 simulation nothing []",
    b"1 simulation list_robots {}",
    b"1 simulation list_robots [1, 2, 3]",
    b"1 simulation activate [",
    b"1 simulation activate [NaN]",
    b"1 simulation activate [" + b"9" * 400 + b"]",
    b'1 simulation activate ["\\ud800"]',
    b"1 simulation activate " + b"[" * 5000 + b"]" * 5000,
    b"1 simulation deactivate [null]",
    b"1 anna.motion set_speed [1]",
    b'1 anna.motion set_speed ["a", {}]',
    b"1 anna.motion set_property []",
    b'1 anna.motion set_property ["ControlType", 3]',
    b"1 cancel",
    b"\xff\xfe cancel",
    b"id simulation set_object_position [[], [], []]",
    b'{"v": 1.0, "w": NaN}',
    b'{"v": "fast"}',
    b'{"v": ' + b"9" * 400 + b"}",
    b"[1, 2]",
    b"null",
    b'{"v": 1.0',
    b'{"v": {"v": {"v": []}}}',
    b"GET / HTTP/1.1",
    b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
    "1 тест ü 漢字".encode(),
)


def garbage(seed: int) -> itertools.chain[bytes]:
    """An infinite sequence of malformed lines: those above, parts of them, and random bytes."""
    numbers = random.Random(seed)

    def one() -> bytes:
        line = numbers.choice(MALFORMED)
        kind = numbers.random()
        if kind < 0.3:
            return line[: numbers.randrange(len(line) + 1)]
        if kind < 0.5:
            return numbers.randbytes(numbers.randrange(200)).replace(b"\n", b"")
        return line

    return itertools.chain.from_iterable(iter(lambda: [one()], None))


def pour(port: int, lines: int, seed: int) -> bytes:
    """Send malformed lines as fast as possible; returns the received bytes."""
    line, source = Line(port, timeout=120.0), garbage(seed)
    with ThreadPoolExecutor(1) as reader:
        answers = reader.submit(drained, line, 120.0)
        for _ in range(0, lines, 100):
            line.send(b"\n".join(itertools.islice(source, 100)) + b"\n")
        line.socket.shutdown(socket.SHUT_WR)
        return answers.result()


def flood(victim: Victim, lines: int) -> None:
    ports = [victim.port, *victim.streams.values()]
    with Witness(victim.port, victim.streams["anna.pose"]), ThreadPoolExecutor(len(ports)) as pourers:
        services, *streams = pourers.map(pour, ports, [lines] * len(ports), range(len(ports)))
    assert services.count(b"\n") == sum(map(wants_answer, itertools.islice(garbage(0), lines)))
    assert not any(b"FAILED" in stream for stream in streams)


def wants_answer(line: bytes) -> bool:
    """Every line that is neither blank nor a cancellation has one answer."""
    words = line.decode(errors="replace").split()
    return bool(words) and not (len(words) == 2 and words[1] == "cancel")


def test_malformed_lines_on_every_port(victim: Victim) -> None:
    flood(victim, SHORT)


@pytest.mark.soak
def test_a_million_malformed_lines_on_every_port(victim: Victim) -> None:
    flood(victim, LONG)


def test_every_malformed_request_has_an_answer(victim: Victim) -> None:
    line = Line(victim.port)
    for request in MALFORMED:
        if not wants_answer(request):
            continue
        line.send(request + b"\n")
        words = line.read().split(maxsplit=2)
        assert words[1] == b"FAILED", request
        assert len(words) == 3
    assert line.call("simulation", "list_robots") == ["anna", "bert"]


def test_a_request_in_fragments(victim: Victim) -> None:
    with Witness(victim.port, victim.streams["anna.pose"]):
        line = Line(victim.port)
        for n in range(20):
            for byte in b"%d simulation list_robots []\n" % n:
                line.send(bytes([byte]))
            assert line.read() == b'%d SUCCESS ["anna", "bert"]\n' % n
        line.close()


def test_commands_in_fragments(victim: Victim) -> None:
    """A message takes effect when it is complete, however its bytes are split."""
    services, motion = Line(victim.port), Line(victim.streams["bert.motion"])
    for speed in (0.25, 0.5):
        for byte in b'{"v": %f, "w": 0.0}' % speed:
            motion.send(bytes([byte]))
        before = services.call("bert.pose", "get_local_data")
        services.call("time", "sleep", 1.0)
        after = services.call("bert.pose", "get_local_data")
        # time advances between the calls, by much on a loaded machine
        driven, passed = (after[field] - before[field] for field in ("x", "timestamp"))
        assert driven / passed == pytest.approx(speed - 0.25, abs=0.05)
        motion.send(b"\n")
        services.call("time", "sleep", 0.5)
    motion.send(b'{"v": 0.0}\n')


def test_many_requests_at_once_are_all_answered_in_their_order(victim: Victim) -> None:
    with Witness(victim.port, victim.streams["anna.pose"]):
        line = Line(victim.port)
        count = 5000
        requests = b"".join(b"%d time mode\n" % n for n in range(count))
        threading.Thread(target=line.send, args=[requests]).start()
        for n in range(count):
            assert line.read() == b'%d SUCCESS "Best Effort"\n' % n
        line.close()


def test_a_client_that_asks_and_never_reads(victim: Victim) -> None:
    """Its unread answers accumulate: it is disconnected, or no longer read from."""
    with Witness(victim.port, victim.streams["anna.pose"]):
        line = Line(victim.port, timeout=1.0)
        line.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        request = b"1 simulation details\n" * 1000
        with pytest.raises((TimeoutError, ConnectionError)):
            line.send(2000 * request)
        line.vanish()


def test_a_line_without_an_end(victim: Victim) -> None:
    with Witness(victim.port, victim.streams["anna.pose"]):
        for port in (victim.port, victim.streams["anna.motion"]):
            line = Line(port)
            with pytest.raises(ConnectionError):
                line.send(b"x" * (100 << 20))
            line.vanish()


def test_a_client_that_listens_and_never_reads(victim: Victim) -> None:
    idle = [Line(port) for port in victim.streams.values() for _ in range(5)]
    for line in idle:
        line.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    with Witness(victim.port, victim.streams["anna.pose"]) as witness:
        witness.wait_for(200)
    for line in idle:
        line.vanish()
