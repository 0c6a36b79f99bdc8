"""Hostile nodes and servers: nothing but the connection ends, and the robots stay where they are."""

import contextlib
import socket
import threading
from collections.abc import Iterator

import pytest

from morse.core.clients.network import Network
from morse.plugins.multinode.messages import MAX_LINE, read_answer, read_pose, read_state
from morse.plugins.multinode.node import ServerConnection
from morse.plugins.multinode.server import MultinodeServer, main
from morse.wire.listener import listen, port_of

WRONG = [
    b"", b"\x00\xff", b"[]", b"{}", b"[1, {}]", b'["", {}]', b'["n", []]', b'["n", {"r": 1}]',
    b'["n", {"r": [[1, 2], [0, 0, 0]]}]', b'["n", {"r": [[1, 2, NaN], [0, 0, 0]]}]',
    b'["n", {"r": [[1, 2, 1e999], [0, 0, 0]]}]', b'["n", {"r": [[1, 2, null], [0, 0, 0]]}]',
    b'["n", {"r": ["123", "456"]}]', b'["n", {"r": [[1, 2, 3]]}]',
    b'["n", {"' + b"r" * 300 + b'": [[1, 2, 3], [0, 0, 0]]}]',
    b'["n", {"r": ' + b"[" * 100_000 + b"]" * 100_000 + b"}]", b'["' + b"n" * 300 + b'", {}]', b"GET / HTTP/1.1",
]  # fmt: skip


@pytest.mark.parametrize("line", WRONG)
def test_wrong_states_are_refused(line: bytes) -> None:
    with pytest.raises(ValueError):  # noqa: PT011 (msgspec's errors and ours)
        read_state(line)


def test_wrong_poses_are_refused() -> None:
    answer = read_answer(b'{"a": [[1, 2, 1e999], [0, 0, 0]], "b": [[1, 2, 3], [0, 0, 0]], "__time": 3}')
    assert answer.keys() == {"a", "b"}
    assert read_pose("b", answer["b"]) == ((1.0, 2.0, 3.0), (0.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="'a'"):
        read_pose("a", answer["a"])


@pytest.fixture
def server() -> Iterator[tuple[MultinodeServer, int]]:
    network = Network()
    listener = listen("127.0.0.1", [0])
    port = port_of(listener)
    made = MultinodeServer(listener, network)
    yield made, port
    made.close()
    network.stop()


def test_strangers_are_disconnected_and_the_nodes_go_on(server: tuple[MultinodeServer, int]) -> None:
    _, port = server
    with socket.create_connection(("127.0.0.1", port), timeout=60.0) as good, good.makefile("rb") as lines:
        for line in (*WRONG, b"x" * (MAX_LINE + 2)):
            with socket.create_connection(("127.0.0.1", port), timeout=60.0) as bad:
                try:
                    bad.sendall(line + b"\n")
                    while bad.recv(4096):
                        raise AssertionError(f"{line[:40]!r} was answered")
                except ConnectionError:
                    pass
        good.sendall(b'["good", {"r": [[1, 2, 3], [0, 0, 0]]}]\n')
        assert lines.readline() == b"{}\n"


def test_robots_are_limited_and_leave_with_their_node(server: tuple[MultinodeServer, int]) -> None:
    made, port = server
    many = ",".join(f'"r{n}":[[0,0,0],[0,0,0]]' for n in range(10_001)).encode()
    for count, line in ((0, b'["n", {' + many + b"}]\n"), (1, b'["n", {"r": [[1, 2, 3], [0, 0, 0]]}]\n')):
        with socket.create_connection(("127.0.0.1", port), timeout=60.0) as one:
            one.sendall(line)
            try:
                answered = bool(one.recv(10))
            except ConnectionError:
                answered = False
            assert (answered, len(made.poses)) == (bool(count), count)
    with socket.create_connection(("127.0.0.1", port), timeout=60.0) as two, two.makefile("rb") as lines:
        answer = b""
        while answer != b"{}\n":
            two.sendall(b'["m", {}]\n')
            answer = lines.readline()


@pytest.mark.parametrize(("options", "status"), [(["-P", "99999999"], 2), (["-P", "-1"], 2), (["-H", "no host"], 1)])
def test_a_server_that_cannot_listen_says_why(
    options: list[str], status: int, capsys: pytest.CaptureFixture[str]
) -> None:
    try:
        found = main(options)
    except SystemExit as end:
        found = int(end.code or 0)
    assert found == status
    error = capsys.readouterr().err
    assert "Traceback" not in error
    assert ("is not a TCP port" in error) == (status == 2)


class Clock:
    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.mark.parametrize("sent", [b"x" * (MAX_LINE + 2), b""])
def test_a_hostile_server_is_left(sent: bytes) -> None:
    """An endless line, and silence."""
    clock = Clock()
    with socket.create_server(("127.0.0.1", 0)) as hostile:
        connection = ServerConnection("127.0.0.1", hostile.getsockname()[1], clock)
        connection.exchange(lambda: b"state\n")
        peer, _ = hostile.accept()
        pouring = threading.Thread(target=_pour, args=[peer, sent])
        pouring.start()
        made = 0

        def make() -> bytes:
            nonlocal made
            made += 1
            return b"state\n"

        while not connection.problem:
            assert connection.exchange(make) is None
            clock.now += 0.0001
        assert made <= 1  # one state for one answer
        assert not connection.is_up
        connection.close()
        peer.close()
        pouring.join(60.0)


def _pour(peer: socket.socket, data: bytes) -> None:
    with contextlib.suppress(OSError):
        peer.sendall(data)
