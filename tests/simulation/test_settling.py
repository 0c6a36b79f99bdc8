"""A robot that the script placed above the floor is at rest in the first message of a run."""

import json
import socket
import threading
import time
from collections.abc import Callable

import pytest

from morse.simulation.simulation import Simulation
from pymorse import Morse

SCENE = """
robot = SegwayRMP400()
robot.translate(z=0.1)
pose = Pose()
robot.append(pose)
robot.add_default_interface("socket")
env = Environment("empty", fastmode=True)
"""


def test_the_first_message_of_a_client_that_waits_before_the_start(load: Callable[..., Simulation]) -> None:
    simulation = load(SCENE)
    (manager,) = (m for m in simulation.context.stream_managers.values() if hasattr(m, "_ports"))
    with socket.create_connection(("127.0.0.1", manager._ports["robot.pose"]), timeout=60.0) as client:
        limit = time.monotonic() + 60.0
        while not manager._servers["robot.pose"].connected and time.monotonic() < limit:
            time.sleep(0.01)
        simulation.run(1.0)
        first = json.loads(client.makefile().readline())
    assert first["z"] == pytest.approx(0.20, abs=0.02)


def test_steps_send_every_message(load: Callable[..., Simulation]) -> None:
    simulation = load(SCENE)
    simulation.pause()
    thread = threading.Thread(target=simulation.run)
    thread.start()
    try:
        (manager,) = simulation.context.services.request_managers().values()
        with Morse("127.0.0.1", manager.port) as simu:
            pose = simu.robot.pose
            simu.step(1)
            assert pose.last()["timestamp"] == pytest.approx(1 / 60)
    finally:
        simulation.stop()
        simulation.context.wake()
        thread.join(60.0)
