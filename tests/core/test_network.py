"""The network loop: in its own thread, or in the waiting thread."""

import asyncio
import contextlib
import socket
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor

import pytest

from morse.core.clients.network import Network
from morse.wire.listener import listen, port_of
from tests.kit.waiting import wait_until


def in_a_thread(function: Callable[[], object]) -> None:
    """Call a function in a thread without a running loop; that of the tests may have the one of a browser."""
    with ThreadPoolExecutor(1) as pool:
        pool.submit(function).result(timeout=120)


@pytest.fixture
def network() -> Iterator[Network]:
    made = Network()
    yield made
    made.stop()


def test_what_is_posted_runs_in_the_network_thread(network: Network) -> None:
    threads: list[int] = []
    network.post(lambda: threads.append(threading.get_ident()))
    wait_until(lambda: threads)
    assert threads[0] != threading.get_ident()


def test_a_call_brings_its_result_or_its_error(network: Network) -> None:
    async def add(a: int, b: int) -> int:
        return a + b

    async def fail() -> None:
        raise LookupError("nothing there")

    assert network.call(add(1, 2)) == 3
    with pytest.raises(LookupError, match="nothing there"):
        network.call(fail())
    with pytest.raises(TimeoutError):
        network.call(asyncio.sleep(10), timeout=0.01)


def test_who_waits_serves_the_network(network: Network) -> None:
    threads: list[int] = []

    def note() -> None:
        threads.append(threading.get_ident())
        network.wake()

    def serve() -> None:
        network.post(note)
        network.wait(10.0)
        network.post(note)
        assert len(threads) < 2  # the next wait starts it
        network.wait(10.0)
        assert threads[-1] == threading.get_ident()
        network.give_back()
        network.post(note)
        wait_until(lambda: len(threads) == 3)
        assert threads[-1] != threading.get_ident()

    in_a_thread(serve)


def test_who_waits_may_be_in_a_loop_of_its_own_as_notebooks_are(network: Network) -> None:
    async def cell() -> tuple[list[int], bool]:
        threads: list[int] = []

        def note() -> None:
            threads.append(threading.get_ident())
            network.wake()

        own = asyncio.get_running_loop()
        for _ in range(100):
            network.post(note)
            network.wait(600.0)  # until it is woken up
        return threads, asyncio.get_running_loop() is own

    ended: list[tuple[list[int], bool]] = []
    in_a_thread(lambda: ended.append(asyncio.run(cell())))
    threads, restored = ended[0]
    # no loop runs within another one: the network thread serves
    assert len(threads) == 100
    assert set(threads) == {network_thread(network)}
    assert restored


def network_thread(network: Network) -> int:
    """The thread that serves the network while nobody waits."""

    async def ident() -> int:
        return threading.get_ident()

    return network.call(ident())


def test_who_has_borrowed_the_loop_may_then_wait_in_a_loop_of_its_own(network: Network) -> None:
    async def cell() -> None:
        network.post(network.wake)
        network.wait(600.0)

    def serve() -> None:
        network.post(network.wake)
        network.wait(600.0)
        asyncio.run(cell())

    in_a_thread(serve)
    assert network.is_awaited
    wait_until(lambda: network.tend() or not network.is_awaited)


def test_waiting_ends_after_its_time(network: Network) -> None:
    begin = time.monotonic()
    for _ in range(5):
        network.wait(0.02)
    assert time.monotonic() - begin < 60.0


def test_any_thread_can_end_a_wait(network: Network) -> None:
    threading.Timer(0.05, network.wake).start()
    begin = time.monotonic()
    network.wait(100.0)
    assert time.monotonic() - begin < 60.0


def test_a_wake_before_the_wait_is_not_lost(network: Network) -> None:
    network.wake()
    begin = time.monotonic()
    network.wait(100.0)
    network.wake()
    network.wait(100.0)
    assert time.monotonic() - begin < 60.0


def test_calls_go_on_when_the_loop_is_awaited(network: Network) -> None:
    network.wait(0.001)
    assert network.call(asyncio.sleep(0, "done")) == "done"
    network.wait(0.001)


def test_the_loop_changes_hands_a_thousand_times_and_keeps_the_order(network: Network) -> None:
    seen: list[int] = []
    for n in range(1000):
        network.post(seen.append, 2 * n)
        network.wait(0.0)
        network.post(seen.append, 2 * n + 1)
        network.give_back()
    wait_until(lambda: len(seen) == 2000)
    assert seen == list(range(2000))


def test_a_loop_that_nobody_serves_goes_back_to_its_thread(network: Network) -> None:
    seen: list[int] = []
    network.wait(0.0)
    network.post(seen.append, 1)
    network.tend()
    wait_until(lambda: not network.tend() and seen)


def test_it_ends_while_its_loop_is_awaited() -> None:
    network = Network()
    network.wait(0.0)
    network.stop()
    assert network.loop.is_closed()
    network.post(print)  # too late, but no error


@pytest.fixture
def pair() -> Iterator[tuple[socket.socket, socket.socket]]:
    listener = listen("127.0.0.1", [0])
    client = socket.create_connection(("127.0.0.1", port_of(listener)))
    listener.setblocking(True)
    server, _ = listener.accept()
    server.setblocking(False)
    yield client, server
    for sock in (client, server, listener):
        sock.close()


@pytest.mark.parametrize("waiting", [True, False])
def test_what_was_sent_before_on_a_new_connection_is_read_before(
    network: Network, waiting: bool, pair: tuple[socket.socket, socket.socket]
) -> None:
    """Data of a new connection are processed before a later request on an old connection."""
    seen: list[bytes] = []
    done = threading.Event()
    caller, requests = pair
    commands = listen("127.0.0.1", [0])
    accepted: list[socket.socket] = []

    def asked() -> None:
        data = requests.recv(100)
        network.when_read(lambda: (seen.append(data), done.set(), network.wake()))

    def accept() -> None:
        try:
            connection, _ = commands.accept()
        except BlockingIOError:
            return
        accepted.append(connection)
        seen.append(connection.recv(100))

    network.post(network.on_readable, requests, asked)
    network.post(lambda: network.on_readable(commands, accept, comes_first=True))
    for _ in range(100):
        seen.clear()
        done.clear()
        with socket.create_connection(("127.0.0.1", port_of(commands))) as commander:
            commander.sendall(b"command")
            caller.sendall(b"request")
            while waiting and not done.is_set():
                network.wait(1.0)
            assert done.wait(60.0)
            assert seen == [b"command", b"request"]
    network.give_back()
    network.stop()
    for connection in (*accepted, commands):
        connection.close()


@pytest.mark.parametrize("waiting", [True, False])
def test_a_command_that_arrives_while_the_loop_is_busy_comes_before_the_request_that_follows_it(
    network: Network, waiting: bool, pair: tuple[socket.socket, socket.socket]
) -> None:
    """After the loop has polled, both arrive, and the request is read in the same round."""
    seen: list[bytes] = []
    done = threading.Event()
    caller, requests = pair
    commander, commands = socket.socketpair()
    commands.setblocking(False)

    def asked() -> None:
        commander.sendall(b"command")
        caller.sendall(b" and more")
        data = requests.recv(100)
        while b"more" not in data:
            with contextlib.suppress(BlockingIOError):
                data += requests.recv(100)
        network.when_read(lambda: (seen.append(data), done.set(), network.wake()))

    def command() -> None:
        with contextlib.suppress(BlockingIOError):
            seen.append(commands.recv(100))

    network.post(network.on_readable, requests, asked)
    network.post(lambda: network.on_readable(commands, command, comes_first=True))
    for _ in range(20):
        seen.clear()
        done.clear()
        caller.sendall(b"request")
        while waiting and not done.is_set():
            network.wait(1.0)
        assert done.wait(60.0)
        assert seen == [b"command", b"request and more"]
    network.give_back()
    network.stop()
    commander.close()
    commands.close()


def test_who_is_served_quickly_watches_and_sleeps_all_the_same(network: Network) -> None:
    for _ in range(20):
        network.post(network.wake)
        network.wait(10.0)  # ends immediately, so that the next wait polls for a while before it sleeps
    begin, used = time.monotonic(), time.thread_time()
    network.wait(0.2)
    assert time.monotonic() - begin > 0.1
    assert time.thread_time() - used < 0.1
    served: list[int] = []
    network.post(network.wake)
    network.wait(10.0)
    network.give_back()
    network.post(lambda: served.append(1))
    wait_until(lambda: served)


def test_an_error_in_what_was_posted_is_reported_and_nothing_else_is_lost(
    network: Network, caplog: pytest.LogCaptureFixture
) -> None:
    served: list[int] = []
    network.wait(0.01)
    network.post(lambda: 1 / 0)
    network.post(lambda: served.append(1))
    network.wait(0.01)
    assert served == [1]
    assert "ZeroDivisionError" in caplog.text
