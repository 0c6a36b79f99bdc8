"""A client paces the simulation."""

import threading
from collections.abc import Callable, Iterator

import pytest
from socket_bench import Bench, Peer

from morse.core.exceptions import MorseMiddlewareError
from morse.middleware.socket import datastream
from morse.wire.listener import listen, port_of
from tests.kit.waiting import wait_until


@pytest.fixture
def sync_port() -> int:
    probe = listen("127.0.0.1", [0])
    port = port_of(probe)
    probe.close()
    return port


@pytest.fixture
def paced(sync_port: int) -> Iterator[Bench]:
    bench = Bench({"time_sync": True, "sync_port": sync_port})
    yield bench
    bench.close()


@pytest.fixture
def running(paced: Bench) -> Iterator[Callable[[], int]]:
    """Ticks in a separate thread; call it for the number of ticks so far."""
    ended = False

    def run() -> None:
        while not ended and not paced.stopping:
            paced.tick()
        paced.context.network.give_back()

    thread = threading.Thread(target=run)

    def ticks() -> int:
        if not thread.ident:
            thread.start()
        return paced.context.clock.tick

    yield ticks
    ended = True
    paced.stopping = True
    thread.join(60)
    assert not thread.is_alive()


def pacer(bench: Bench, port: int) -> Peer:
    assert bench.streams._sync is not None
    server = bench.streams._sync._server
    before = server.connected
    peer = Peer(port)
    wait_until(lambda: server.connected > before)
    return peer


def test_without_a_client_ticks_go_on(running: Callable[[], int]) -> None:
    wait_until(lambda: running() > 100)


def test_each_tick_waits_for_bytes(paced: Bench, sync_port: int, running: Callable[[], int]) -> None:
    client = pacer(paced, sync_port)
    for expected in range(1, 6):
        assert running() == expected - 1
        client.send(b"sync")
        wait_until(lambda expected=expected: running() == expected)
    client.close()
    wait_until(lambda: running() > 100)


def test_how_many_bytes_does_not_matter(paced: Bench, sync_port: int, running: Callable[[], int]) -> None:
    client = pacer(paced, sync_port)
    client.send(b"x" * 2000)
    wait_until(lambda: running() >= 1)
    assert running() <= 2
    client.close()


def test_services_are_answered_while_the_simulation_waits(
    paced: Bench, sync_port: int, running: Callable[[], int]
) -> None:
    client = pacer(paced, sync_port)
    caller = paced.connect()
    assert running() == 0
    caller.send(b"1 robot1.motion add [1]\n")
    wait_until(lambda: caller.lines() == [b"1 SUCCESS 3"])
    assert running() == 0
    for peer in (client, caller):
        peer.close()


def test_the_simulation_can_end_while_it_waits(paced: Bench, sync_port: int) -> None:
    client = pacer(paced, sync_port)

    def tick() -> None:
        paced.tick()
        paced.context.network.give_back()

    thread = threading.Thread(target=tick)
    thread.start()
    paced.stopping = True
    thread.join(60)
    assert not thread.is_alive()
    client.close()


def test_a_port_in_use_is_an_error(paced: Bench, sync_port: int) -> None:
    with pytest.raises(MorseMiddlewareError, match=f"port {sync_port} is in use"):
        type(paced.streams)({"time_sync": True, "sync_port": sync_port}, paced.context)


def test_no_sync_port_unless_asked_for() -> None:
    bench = Bench({"time_sync": False, "sync_port": 1})
    assert bench.streams._sync is None
    bench.close()


def test_the_data_of_a_tick_do_not_wait_for_the_next_one(
    paced: Bench, sync_port: int, running: Callable[[], int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Messages of ticks that follow each other quickly are sent together, but not while a client waits for them."""
    monkeypatch.setattr(datastream, "_QUICK", 1e9)
    monkeypatch.setattr(datastream, "_TOGETHER", 1e9)
    paced.sensor(port=0)
    client, reader = pacer(paced, sync_port), paced.connect("robot1.pose")
    assert running() == 0
    for expected in range(1, 6):
        client.send(b"sync")
        wait_until(lambda expected=expected: len(reader.lines()) == expected)
    for peer in (client, reader):
        peer.close()
