"""A client that calls a service and disconnects stops nothing."""

import contextlib
import json
import socket
import time

import pytest

import morse

SCENE = """
from morse.builder import *
robot = {robot}()
robot.translate(0, 0, {height})
motion = {actuator}()
robot.append(motion)
motion.add_service('socket')
env = Environment('empty')
"""


def port(sim):
    managers = sim.context.services.request_managers().values()
    return next(manager.port for manager in managers if hasattr(manager, "port"))


def tick_until(sim, done):
    end = time.monotonic() + 60.0
    while time.monotonic() < end:
        if done():
            return
        sim.step()
        time.sleep(0.0005)
    pytest.fail("it did not happen")


@pytest.mark.parametrize(
    ("robot", "height", "actuator", "service", "arguments", "arrived"),
    [
        ("Morsy", 0, "Waypoint", "goto", [3.0, 0.0, 0.0], lambda c: c.robot_parent.move_status == "Arrived"),
        (
            "Quadrotor",
            10,
            "RotorcraftWaypoint",
            "goto",
            [1.0, 0.0, 10.0, 0.0],
            lambda c: c.robot_parent.move_status == "Arrived",
        ),
        ("ATRV", 0, "KukaLWR", "rotate", ["kuka_2", 0.5], lambda c: abs(c.joint_values[1] - 0.5) < 0.011),
        (
            "ATRV",
            0,
            "PTU",
            "set_pan_tilt",
            [1.0, 0.2],
            lambda c: abs(c.pan - 1.0) < 0.011 and abs(c.tilt - 0.2) < 0.011,
        ),
    ],
)
def test_what_was_begun_goes_on(tmp_path, monkeypatch, robot, height, actuator, service, arguments, arrived):
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    path = tmp_path / "scene.py"
    path.write_text(SCENE.format(robot=robot, height=height, actuator=actuator))
    with morse.load(path, sockets=True) as sim:
        component = sim.context.component("robot.motion")
        with socket.create_connection(("127.0.0.1", port(sim)), timeout=60) as client:
            client.sendall(f"1 robot.motion {service} {json.dumps(arguments)}\n".encode())
            tick_until(sim, lambda: component.running_service == service)
        tick_until(sim, lambda: component.running_service is None and arrived(component))
        # the next client gets an answer
        with socket.create_connection(("127.0.0.1", port(sim)), timeout=60) as client:
            client.sendall(b"2 robot.motion get_properties []\n")
            client.setblocking(False)
            heard = bytearray()

            def answered():
                with contextlib.suppress(BlockingIOError):
                    heard.extend(client.recv(65536))
                return b"\n" in heard

            tick_until(sim, answered)
            assert heard.startswith(b"2 SUCCESS")
