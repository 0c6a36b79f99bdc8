"""Many clients, clients that connect and disconnect, and clients that are killed."""

import json
import random
import signal
import subprocess
import sys
import threading
import time

import pytest
from victims import Victim
from wire import HZ, Footprint, Witness

from tests.kit.programs import Line

CLIENT = """
import sys
sys.path.insert(0, {source!r})
from pymorse import Morse
simu = Morse("127.0.0.1", {port})
while True:
    for robot in (simu.anna, simu.bert):
        robot.motion.publish({{"v": 0.1, "w": 0.2}})
        robot.pose.get(timeout=60)
        simu.time()
"""


def test_fifty_clients_of_all_streams(victim: Victim) -> None:
    """Each client gets every message of every sensor."""
    sensors = [port for name, port in victim.streams.items() if "motion" not in name]
    lines = [Line(port) for _ in range(50) for port in sensors]
    errors: list[str] = []

    def read(share: list[Line]) -> None:
        last: list[int] = [0] * len(share)
        for round_ in range(60):
            for n, line in enumerate(share):
                tick = round(json.loads(line.read())["timestamp"] * HZ)
                if round_ and tick != last[n] + 1:
                    errors.append(f"tick {tick} after {last[n]}")
                last[n] = tick

    with Witness(victim.port, victim.streams["anna.pose"]):
        threads = [threading.Thread(target=read, args=[lines[n::4]]) for n in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert errors == []
    for line in lines:
        line.close()


def come_and_go(victim: Victim, times: int) -> None:
    numbers = random.Random(times)
    ports = [victim.port, *victim.streams.values()]
    for _ in range(times):
        line = Line(numbers.choice(ports))
        if numbers.random() < 0.5:
            line.send(numbers.choice((b"1 time now\n", b'{"v": 0.0}\n', b"half a li")))
        line.vanish() if numbers.random() < 0.5 else line.close()


def settled(footprint: Footprint, descriptors: int) -> int:
    """The number of descriptors, as soon as it is back at the former number, or after a timeout."""
    deadline = time.monotonic() + 60.0
    while footprint.descriptors > descriptors and time.monotonic() < deadline:
        time.sleep(0.01)
    return footprint.descriptors


def leaves_nothing_behind(victim: Victim, times: int) -> None:
    footprint = Footprint(victim.process.pid)
    quiet = footprint.descriptors

    def crowds(count: int) -> None:
        for _ in range(0, count, 50):
            come_and_go(victim, 50)
            settled(footprint, quiet)

    crowds(500)  # memory grows to the maximum of a crowd
    descriptors, memory = settled(footprint, quiet), footprint.memory
    crowds(times)
    assert settled(footprint, descriptors) <= descriptors
    assert footprint.memory < 1.02 * memory


@pytest.mark.skipif(not Footprint.possible(), reason="the system does not tell")
def test_clients_that_come_and_go_leave_nothing_behind(victim: Victim) -> None:
    leaves_nothing_behind(victim, 500)


@pytest.mark.soak
@pytest.mark.skipif(not Footprint.possible(), reason="the system does not tell")
def test_two_thousand_clients_leave_nothing_behind(victim: Victim) -> None:
    leaves_nothing_behind(victim, 2000)


def kill_clients(victim: Victim, count: int) -> None:
    import pymorse

    source = str(next(iter(pymorse.__path__))).rpartition("pymorse")[0]
    script = CLIENT.format(source=source, port=victim.port)
    numbers = random.Random(count)
    with Witness(victim.port, victim.streams["bert.pose"]) as witness:
        for _ in range(count):
            clients = [subprocess.Popen([sys.executable, "-c", script]) for _ in range(3)]
            witness.wait_for(numbers.randrange(40, 120))
            for client in clients:
                client.send_signal(signal.SIGKILL if hasattr(signal, "SIGKILL") else signal.SIGTERM)
                client.wait()


def test_clients_that_are_killed(victim: Victim) -> None:
    kill_clients(victim, 2)


@pytest.mark.soak
def test_clients_that_are_killed_again_and_again(victim: Victim) -> None:
    kill_clients(victim, 100)


def test_clients_that_vanish_in_the_middle_of_services(victim: Victim) -> None:
    with Witness(victim.port, victim.streams["anna.pose"]) as witness:
        for n in range(50):
            line = Line(victim.port)
            line.send(b"1 time sleep [0.05]\n2 simulation details\n3 time sleep [%d]\n" % n)
            line.vanish()
        witness.wait_for(30)
