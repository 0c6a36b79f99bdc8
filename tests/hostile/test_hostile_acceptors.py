"""Connections that say nothing, or that are reset as soon as they are open."""

import asyncio
import errno
import logging
import socket
from collections.abc import Iterator
from typing import Any

import pytest
from limited import connect, is_closed, reset, told_once

from morse.core.clients.acceptors import AcceptedProtocol, Acceptor, StreamAcceptor
from morse.core.clients.complaints import Complaints
from morse.core.clients.network import Network
from morse.middleware.socket import datastream
from morse.plugins.mavlink.links import open_link
from morse.plugins.multinode.server import MultinodeServer
from morse.wire.listener import listen, port_of
from tests.kit.waiting import run_apart, wait_until

logger = logging.getLogger("morse.test")


class Caller:
    """A connection of an acceptor that calls `Acceptor.accept` itself."""

    def __init__(self, sock: socket.socket) -> None:
        self.socket = sock
        self.keeps_place = False

    def importance(self) -> tuple[float, ...]:
        return (float(self.socket.fileno()),)

    def dismiss(self) -> None:
        self.socket.close()


def four_places() -> tuple[Acceptor, list[Caller]]:
    """An acceptor with four places, and its connections in their order."""
    callers: list[Caller] = []

    def enter(sock: socket.socket, _: Any) -> None:
        callers.append(Caller(sock))
        acceptor.join(callers[-1])

    acceptor = Acceptor("a port", enter, most=4, complaints=Complaints(logger))
    return acceptor, callers


@pytest.fixture
def network() -> Iterator[Network]:
    network = Network()
    yield network
    network.stop()


def test_a_flood_of_resets_keeps_nobody_waiting(caplog: pytest.LogCaptureFixture) -> None:
    acceptor, callers = four_places()
    listener = listen("127.0.0.1", (0,))
    acceptor.open(listener)
    # nothing is accepted meanwhile, as while a tick holds the processor
    for _ in range(400):
        sock = socket.create_connection(("127.0.0.1", port_of(listener)), timeout=5.0)
        reset(sock)
    with socket.create_connection(("127.0.0.1", port_of(listener)), timeout=5.0) as serious:
        address = serious.getsockname()
        wait_until(lambda: acceptor.accept() or callers)
        assert [caller.socket.getpeername() for caller in callers] == [address]
    assert not caplog.text
    acceptor.close()
    for caller in callers:
        caller.dismiss()
        acceptor.leave(caller)


class _Exhausted(socket.socket):
    """A listener in a process that has no descriptor left until a connection is closed."""

    callers: list[Caller]

    def accept(self) -> tuple[socket.socket, Any]:
        if all(caller.socket.fileno() != -1 for caller in self.callers):
            raise OSError(errno.EMFILE, "Too many open files")
        return super().accept()


def test_a_silent_connection_leaves_for_a_new_one_that_finds_no_descriptor() -> None:
    acceptor, callers = four_places()
    listener = listen("127.0.0.1", (0,))
    number = port_of(listener)
    acceptor.open(listener)
    with connect(number) as silent, connect(number) as late:
        wait_until(lambda: acceptor.accept() or len(callers) == 2)
        acceptor.close()
        exhausted = _Exhausted(fileno=listen("127.0.0.1", (0,)).detach())
        exhausted.callers = list(callers)
        acceptor.open(exhausted)
        with connect(port_of(exhausted)) as new:
            wait_until(lambda: acceptor.accept() or len(callers) == 3)
            assert callers[-1].socket.getpeername() == new.getsockname()
        assert sum(map(is_closed, (silent, late))) == 1
    acceptor.close()
    for caller in callers:
        caller.dismiss()
        acceptor.leave(caller)


class _Echo(AcceptedProtocol):
    """Keeps the place of who has sent something, and echoes it."""

    def data_received(self, data: bytes) -> None:
        self.place.keeps_place = True
        transport: Any = self.place._transport
        transport.write(data)


def test_the_oldest_silent_connection_leaves_and_who_has_spoken_stays(caplog: pytest.LogCaptureFixture) -> None:
    async def run() -> None:
        acceptor = StreamAcceptor("a port", most=3, complaints=Complaints(logger), refusal=b"full")
        listener = listen("127.0.0.1", (0,))
        number = port_of(listener)
        server = acceptor.serve([listener], _Echo)
        async with asyncio.timeout(60.0):
            streams = [await asyncio.open_connection("127.0.0.1", number) for _ in range(3)]
            streams[1][1].write(b"hello")
            assert await streams[1][0].readexactly(5) == b"hello"
            streams += [await asyncio.open_connection("127.0.0.1", number) for _ in range(2)]
            # the two silent ones of the first three have left, the oldest first
            assert await streams[0][0].read() == b""
            assert await streams[2][0].read() == b""
            for reader, writer in (streams[1], *streams[3:]):
                writer.write(b"x")
                assert await reader.readexactly(1) == b"x"
            # now all have spoken: the newcomer is told
            late, _ = await asyncio.open_connection("127.0.0.1", number)
            assert await late.read() == b"full"
            streams[1][1].close()
            while True:
                reader, writer = await asyncio.open_connection("127.0.0.1", number)
                writer.write(b"in")
                if await reader.read(4) == b"in":
                    break
        server.close()
        for _, writer in streams:
            writer.close()

    with caplog.at_level(logging.INFO, "asyncio"):
        run_apart(run())
    assert told_once(caplog.text, "to make room")
    assert "a client is refused" in caplog.text
    assert "Traceback" not in caplog.text


def test_silent_connections_do_not_keep_a_node_out(network: Network) -> None:
    listener = listen("127.0.0.1", (0,))
    number = port_of(listener)
    server = MultinodeServer(listener, network)
    silent = [connect(number) for _ in range(300)]
    garbage = [connect(number) for _ in range(20)]
    for sock in garbage:
        sock.sendall(b"?")
    with connect(number) as node, node.makefile("rb") as lines:
        node.sendall(b'["node", {}]\n')
        assert lines.readline()
    assert any(is_closed(sock) for sock in silent)
    for sock in silent + garbage:
        sock.close()
    server.close()


def test_one_who_connects_to_the_sync_port_and_says_nothing_does_not_stop_time(
    network: Network, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    class Services:
        def process(self) -> None: ...

    class Context:
        """The part of a simulation that the pacing uses."""

        services = Services()

        def __init__(self) -> None:
            self.network = network

        def stopping(self) -> bool:
            return False

        def wake(self) -> None: ...

        def wait(self, seconds: float) -> None: ...

    monkeypatch.setattr(datastream, "_PATIENCE", 0.0)
    listener = listen("127.0.0.1", (0,))
    number = port_of(listener)
    sync = datastream.TimeSync(Context(), listener)  # type: ignore[arg-type] # it uses no more
    network.call(sync.start())
    with connect(number):
        wait_until(lambda: sync._server.connected)
        sync.wait()  # returns
    assert "no longer holds up the simulation" in caplog.text
    network.call(sync.close())


def test_silent_connections_do_not_keep_an_autopilot_out(caplog: pytest.LogCaptureFixture) -> None:
    probe = listen("127.0.0.1", (0,))
    number = port_of(probe)
    probe.close()
    link = open_link(f"tcpin:127.0.0.1:{number}")
    silent = [connect(number) for _ in range(16)]
    wait_until(lambda: list(link.receive()) or len(link._connections) == 16)  # type: ignore[attr-defined]
    with connect(number) as autopilot:
        autopilot.sendall(b"\xfd and so on")
        (sender, data), *_ = wait_until(lambda: list(link.receive()))
        assert data == b"\xfd and so on"
        link.understood(sender)
        more = [connect(number) for _ in range(40)]
        wait_until(lambda: list(link.receive()) or is_closed(more[20]))
        link.send(b"\xfd a message")
        assert autopilot.recv(100) == b"\xfd a message"
    assert all(is_closed(sock) for sock in silent)
    assert told_once(caplog.text, "to make room")
    link.close()
    for sock in silent + more:
        sock.close()
