"""The long run: malformed input on all ports at once, and many clients of many streams.

The long form prints its results (``pytest -s -m soak``), which are recorded in docs/measured.
"""

import contextlib
import json
import re
import selectors
import socket
import time
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import pytest
from test_abuse_lines import garbage
from test_abuse_other_ports import harass
from victims import SCENE, Victim
from wire import HZ, Footprint, Witness, drained

from morse.testing.process import SimulationProcess
from tests.kit.programs import Line, free_port
from tests.kit.waiting import wait_until

Start = Callable[..., SimulationProcess]

CROWDED = """
from morse.builder import *

for number in range({robots}):
    robot = FakeRobot()
    robot.name = f"r{{number}}"
    robot.translate(2.0 * (number % 10), 2.0 * (number // 10), 0.0)
    for sensor, name in ((Pose, "pose"), (Odometry, "odometry")):
        component = sensor(name)
        component.frequency({frequency})
        robot.append(component)
    robot.add_default_interface("socket")
env = Environment("empty", fastmode=True)
"""

needs_footprint = pytest.mark.skipif(not Footprint.possible(), reason="the system does not tell")


def pour(port: int, lines: int, seed: int) -> None:
    """Malformed lines over short connections; a client that is disconnected reconnects."""
    source = garbage(seed)
    left = lines
    while left > 0:
        line = Line(port, timeout=120.0)
        with contextlib.suppress(ConnectionError, BrokenPipeError), ThreadPoolExecutor(1) as reader:
            reader.submit(drained, line, 120.0)
            for _ in range(min(left, 20_000) // 100 + 1):
                left -= 100
                line.send(b"\n".join(next(source) for _ in range(100)) + b"\n")
            line.socket.shutdown(socket.SHUT_WR)
        line.close()


def malformed_everywhere(start: Start, lines: int) -> dict[str, float]:
    sync = free_port()
    scene = SCENE + f"env.configure_stream_manager('socket', time_sync=True, sync_port={sync})\n"
    process = start(scene, "--view-port", "0", "--no-browser", "--speed", "5")
    victim = Victim(process)
    page = re.search(r"http://127\.0\.0\.1:(\d+)/", victim.log())
    assert page is not None
    footprint = Footprint(process.pid)
    ports = [victim.port, *victim.streams.values(), sync]
    begin = time.monotonic()
    with Witness(victim.port, victim.streams["anna.pose"]) as witness:
        with ThreadPoolExecutor(len(ports)) as pourers:  # memory grows to its maximum
            list(pourers.map(pour, ports, [2000] * len(ports), range(len(ports))))
        memory = footprint.memory
        with ThreadPoolExecutor(len(ports) + 1) as pourers:
            share = lines // len(ports)
            frames = pourers.submit(harass, int(page[1]), max(20, lines // 1000))
            list(pourers.map(pour, ports, [share] * len(ports), range(10, 10 + len(ports))))
            frames.result()
        witness.wait_for(30)
    assert process.watch.error is None
    figures = {
        "lines": share * len(ports),
        "seconds": round(time.monotonic() - begin, 1),
        "messages of the witness": witness.messages,
        "slowest answer to the witness, ms": round(1e3 * witness.slowest, 1),
        "growth of memory, MB": round((footprint.memory - memory) / 1e6, 1),
        "lines of the log": victim.log().count("\n"),
    }
    process.stop()
    assert figures["growth of memory, MB"] < 40.0
    assert figures["lines of the log"] < 100 + 40 * figures["seconds"]
    return figures


@needs_footprint
def test_malformed_input_on_all_ports_at_once(start: Start) -> None:
    malformed_everywhere(start, 20_000)


@pytest.mark.soak
@pytest.mark.timeout(3600)
@needs_footprint
def test_a_million_malformed_lines_and_frames_on_all_ports(start: Start) -> None:
    print(json.dumps(malformed_everywhere(start, 1_000_000)))


def listen_to_all(ports: list[int], clients: int, seconds: float, frequency: int) -> Counter[str]:
    """Read ``clients`` connections to each port for a while; every message of each must arrive, in order."""
    figures: Counter[str] = Counter()
    selector = selectors.DefaultSelector()
    rest: dict[socket.socket, bytes] = {}
    last: dict[socket.socket, int] = {}
    for port in ports:
        for _ in range(clients):
            sock = socket.create_connection(("127.0.0.1", port), timeout=60.0)
            sock.setblocking(False)
            selector.register(sock, selectors.EVENT_READ)
            rest[sock] = b""
    figures["connections"] = len(rest)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        for key, _ in selector.select(1.0):
            sock = key.fileobj
            assert isinstance(sock, socket.socket)
            data = sock.recv(1 << 16)
            assert data, "the simulation has closed a connection"
            *whole, rest[sock] = (rest[sock] + data).split(b"\n")
            for line in whole:
                count = round(json.loads(line)["timestamp"] * frequency)
                figures["messages"] += 1
                figures["missed"] += count - last.get(sock, count - 1) - 1
                last[sock] = count
    for sock in rest:
        sock.close()
    figures["silent"] = len(rest) - len(last)
    return figures


def many_clients(start: Start, clients: int, streams: int, seconds: float) -> dict[str, float]:
    frequency = 1 if clients > 10 else 10
    process = start(CROWDED.format(robots=streams // 2, frequency=frequency))
    services = Line(process.port)
    ports = services.call("simulation", "get_all_stream_ports")
    footprint = Footprint(process.pid)
    begin, memory = services.call("time", "now"), footprint.memory
    wall = time.monotonic()
    figures = dict(listen_to_all(list(ports.values()), clients, seconds, frequency))
    passed, wall = services.call("time", "now") - begin, time.monotonic() - wall
    figures |= {
        "seconds": round(wall, 1),
        "simulated seconds a second": round(passed / wall, 3),
        "growth of memory, MB": round((footprint.memory - memory) / 1e6, 1),
    }
    assert process.watch.error is None
    assert figures["connections"] == clients * streams
    assert figures["silent"] == 0
    assert figures["missed"] == 0
    process.stop()
    return figures


@needs_footprint
def test_many_clients_of_many_streams(start: Start) -> None:
    many_clients(start, 10, 20, 3.0)


@pytest.mark.soak
@pytest.mark.timeout(3600)
@needs_footprint
def test_a_hundred_clients_of_a_hundred_streams_for_ten_minutes(start: Start) -> None:
    from morse.wire.listener import allow_many_sockets

    allow_many_sockets()
    assert HZ == 60
    print(json.dumps(many_clients(start, 100, 100, 600.0)))


def read_all(ports: list[int], clients: int, seconds: float) -> int:
    """Read ``clients`` connections to each port for a while, as fast as the data come; returns the bytes."""
    selector, size = selectors.DefaultSelector(), 0
    for port in ports * clients:
        sock = socket.create_connection(("127.0.0.1", port), timeout=60.0)
        sock.setblocking(False)
        selector.register(sock, selectors.EVENT_READ, sock)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        for key, _ in selector.select(1.0):
            data = key.data.recv(1 << 16)
            assert data, "the simulation has closed a connection"
            size += len(data)
    for key in list(selector.get_map().values()):
        key.data.close()
    return size


def at_full_speed(start: Start, clients: int, streams: int, seconds: float) -> dict[str, float]:
    """Memory, descriptors and threads before and after many clients of a simulation without pause between its ticks."""
    process = start(CROWDED.format(robots=streams // 2, frequency=60), "--headless", "--speed", "max")
    services = Line(process.port)
    ports = list(services.call("simulation", "get_all_stream_ports").values())
    footprint = Footprint(process.pid)
    quiet = footprint.descriptors
    read_all(ports, clients, min(seconds, 10.0))  # memory grows to its maximum
    wait_until(lambda: footprint.descriptors == quiet)
    before, threads = footprint.memory, footprint.threads
    begin = services.call("time", "now")
    size = read_all(ports, clients, seconds)
    figures = {
        "connections": len(ports) * clients,
        "simulated seconds": round(services.call("time", "now") - begin, 1),
        "MB read": round(size / 1e6, 1),
        "growth of memory, MB": round((footprint.memory - before) / 1e6, 1),
    }
    assert figures["growth of memory, MB"] <= 20.0
    wait_until(lambda: footprint.descriptors == quiet)
    assert footprint.threads <= threads
    assert process.watch.error is None
    process.stop()
    return figures


@needs_footprint
def test_clients_at_full_speed_leave_nothing_behind(start: Start) -> None:
    at_full_speed(start, 10, 6, 1.0)


@pytest.mark.soak
@pytest.mark.timeout(3600)
@needs_footprint
def test_a_hundred_clients_of_thirty_streams_at_full_speed_for_ten_minutes(start: Start) -> None:
    print(json.dumps(at_full_speed(start, 100, 30, 600.0)))
