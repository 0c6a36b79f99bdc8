"""Garbage on the ports of the live view and of the time sync, while another client must not be affected."""

import contextlib
import random
import re
import threading
import urllib.request
from collections.abc import Callable

import pytest
from victims import SCENE, Victim
from wire import Witness

from morse.testing.process import SimulationProcess
from tests.kit.programs import Line, free_port

Start = Callable[..., SimulationProcess]

SHORT, LONG = 60, 3000
UPGRADE = (
    b"GET /ws HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n"
)
BEGINNINGS = (b"", b"GET / HTTP/1.1\r\n", b"POST /ws HTTP/1.1\r\n\r\n", b"\x16\x03\x01", UPGRADE, UPGRADE + b"\x81\xfe")


def harass(port: int, connections: int) -> None:
    """Connections with a random beginning, random bytes, and a random end."""
    numbers = random.Random(connections)
    for _ in range(connections):
        line = Line(port)
        with contextlib.suppress(ConnectionError):  # it may disconnect immediately
            line.send(numbers.choice(BEGINNINGS) + numbers.randbytes(numbers.randrange(3000)))
        line.vanish() if numbers.random() < 0.5 else line.close()


def harass_the_view(start: Start, connections: int) -> None:
    process = start(SCENE, "--view-port", "0", "--no-browser", "--speed", "5")
    victim = Victim(process)
    url = re.search(r"http://127\.0\.0\.1:(\d+)/", victim.log())
    assert url is not None
    with Witness(victim.port, victim.streams["anna.pose"]):
        harass(int(url[1]), connections)
        opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
        assert opener.open(url[0], timeout=60.0).status == 200
    process.stop()


def test_garbage_on_the_port_of_the_view(start: Start) -> None:
    harass_the_view(start, SHORT)


@pytest.mark.soak
def test_much_garbage_on_the_port_of_the_view(start: Start) -> None:
    harass_the_view(start, LONG)


def test_a_flood_on_the_port_that_paces_the_simulation(start: Start) -> None:
    """It can only advance the simulation: any byte allows one tick, and many at once allow no more."""
    port = free_port()
    scene = SCENE + f"env.configure_stream_manager('socket', time_sync=True, sync_port={port})\n"
    process = start(scene, "--headless", "--speed", "max")
    victim = Victim(process)
    ended = threading.Event()

    def pour() -> None:
        line = Line(port)
        while not ended.is_set():
            line.send(b"x" * 4096)
        line.vanish()

    pourers = [threading.Thread(target=pour) for _ in range(3)]
    with Witness(victim.port, victim.streams["anna.pose"]) as witness:
        for pourer in pourers:
            pourer.start()
        witness.wait_for(200)
        ended.set()
        for pourer in pourers:
            pourer.join()
    process.stop()
