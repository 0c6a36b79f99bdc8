"""Many clients that request endless captures at once: each request is answered, and the simulation goes on."""

import collections
import contextlib
import socket
import time
import tracemalloc

import pytest

pytestmark = pytest.mark.long

SCENE = """
from morse.builder import *
robot = FakeRobot()
eye = VideoCamera()
eye.properties(cam_width=16, cam_height=12, capturing=False)
eye.frequency(60)
eye.add_service('socket')
robot.append(eye)
env = Environment('empty')
"""
CLIENTS, REQUESTS = 8, 100
#: numbers of images, as clients write them; the last four are refused
NUMBERS = ["1000000000", "-1", "1000000", "-1000000000", "1e300", '"many"', "null", "[1]"]


class Client:
    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=60)
        self._heard = bytearray()

    def send(self, text):
        self.socket.settimeout(60)
        self.socket.sendall(text.encode())

    def count(self):
        """Number of answers until now."""
        self.socket.setblocking(False)
        with contextlib.suppress(BlockingIOError):
            while data := self.socket.recv(1 << 16):
                self._heard += data
        return self._heard.count(b"\n")

    def answers(self):
        """From request to status."""
        return dict(line.split()[:2] for line in self._heard.decode().splitlines())


@pytest.fixture
def sim(load):
    return load(SCENE, sockets=True)


@pytest.fixture
def clients(sim):
    managers = sim.context.services.request_managers().values()
    port = next(manager.port for manager in managers if hasattr(manager, "port"))
    made = [Client(port) for _ in range(CLIENTS)]
    yield made
    for client in made:
        client.socket.close()


def step_until(sim, clients, count):
    """Step until so many requests were answered."""
    end = time.monotonic() + 60.0
    while time.monotonic() < end:
        if sum(client.count() for client in clients) >= count:
            return
        sim.step()
    pytest.fail("requests were not answered")


def test_every_request_is_answered_and_memory_is_bounded(sim, clients):
    eye, requests = sim.context.component("robot.eye"), range(CLIENTS * REQUESTS)
    # the first image reads the world
    eye.capture(None, 1)
    sim.step(5)
    tracemalloc.start()
    for first, client in enumerate(clients):
        lines = [f"{n} robot.eye capture [{NUMBERS[n % len(NUMBERS)]}]\n" for n in requests[first::CLIENTS]]
        client.send("".join(lines[::-1] if first % 2 else lines))
    # each capture ends the one before; the last one goes on
    step_until(sim, clients, len(requests) - 1)
    sim.step(5)
    assert sum(client.count() for client in clients) == len(requests) - 1
    assert eye.running_service == "capture"
    (going,) = set(map(str, requests)) - {number for client in clients for number in client.answers()}
    clients[0].send(f"{going} cancel\n")
    step_until(sim, clients, len(requests))
    sim.step(2)
    grown, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert grown < 8 << 20
    assert eye.running_service is None
    assert not eye.capturing
    found = {number: status for client in clients for number, status in client.answers().items()}
    for n in requests:
        assert found[str(n)] == ("FAILED" if n % len(NUMBERS) > 3 else "PREEMPTED")
    assert collections.Counter(found.values()) == {"FAILED": len(requests) // 2, "PREEMPTED": len(requests) // 2}
    # the camera serves the next client
    clients[1].send("more robot.eye capture [1]\n")
    step_until(sim, clients, len(requests) + 1)
    assert clients[1].answers()["more"] == "SUCCESS"
    assert eye.local_data["image"].shape == (12, 16, 4)
