"""Simulations that are killed, components that fail, states that diverge."""

import json
import math
import os
import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from wire import HZ

from morse.testing.process import SimulationProcess
from tests.kit.programs import Line

Start = Callable[..., SimulationProcess]

pytestmark = pytest.mark.long

PARTS = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
from morse.builder import *
from morse.builder.creator import ActuatorCreator, SensorCreator

class Raises(SensorCreator):
    _classpath = "abuse_parts.Raises"

class Explodes(ActuatorCreator):
    _classpath = "abuse_parts.Explodes"

class Brittle(ActuatorCreator):
    _classpath = "abuse_parts.Brittle"

robot = ATRV()
pose = Pose()
robot.append(pose)
"""
END = """
robot.add_default_interface("socket")
env = Environment("empty", fastmode=True)
"""


def test_a_simulation_that_is_killed_frees_its_ports_at_once(start: Start) -> None:
    # a port that no other test uses
    port = int(os.environ["MORSE_SOCKET_PORT"]) + 150
    scene = PARTS + f'pose.add_stream("socket", port={port})\nenv = Environment("empty", fastmode=True)\n'
    first = start(scene)
    services = Line(first.port)
    ports = services.call("simulation", "get_all_stream_ports")
    assert ports == {"robot.pose": port}
    listeners = [Line(port) for port in ports.values() for _ in range(5)]
    for listener in listeners:
        assert json.loads(listener.read())["timestamp"] > 0.0
    first._process.kill()
    first._process.wait()
    # the connections are still open on this side
    second = start(scene, port=first.port)
    assert second.port == first.port
    assert Line(second.port).call("simulation", "get_all_stream_ports") == ports
    for listener in listeners:
        listener.close()


def test_a_component_that_fails_stops_alone(start: Start) -> None:
    process = start(PARTS + "broken = Raises()\nrobot.append(broken)\n" + END)
    services = Line(process.port)
    services.call("simulation", "pause")
    services.call("simulation", "reset")
    services.call("simulation", "step", 30)
    assert services.call("robot.broken", "get_local_data")["count"] == 10
    assert services.call("robot.pose", "get_local_data")["timestamp"] == pytest.approx(30 / HZ)
    log = process.log.read_text()
    assert "robot.broken failed and is deactivated" in log
    assert "a mistake of the user" in log
    assert "abuse_parts.py" in log
    # it may be activated again
    services.call("simulation", "activate", "robot.broken")
    services.call("simulation", "step", 2)
    assert services.call("robot.broken", "get_local_data")["count"] == 12


def test_a_stream_that_fails_stops_alone(start: Start) -> None:
    scene = PARTS + 'raw = Pose()\nraw.alter("", classpath="abuse_parts.Garbles")\nrobot.append(raw)\n' + END
    process = start(scene)
    services = Line(process.port)
    ports = services.call("simulation", "get_all_stream_ports")
    garbled, pose = Line(ports["robot.raw"]), Line(ports["robot.pose"])
    before = json.loads(pose.read())["timestamp"]
    for n in range(1, 30):
        assert json.loads(pose.read())["timestamp"] == pytest.approx(before + n / HZ)
    assert services.call("time", "now") > before
    assert "robot.raw" in process.log.read_text()
    garbled.close()


def test_services_that_fail_are_answered(start: Start) -> None:
    process = start(PARTS + "arm = Brittle()\nrobot.append(arm)\n" + END)
    services = Line(process.port)
    for service in ("fail", "fail_later", "endless"):
        services.send(f"1 robot.arm {service}\n".encode())
        assert services.read().startswith(b"1 FAILED "), service
    assert services.call("simulation", "list_robots") == ["robot"]


@pytest.mark.parametrize(("push", "refused"), [("1e300", True), ("-1e200", True), ("9e8", False)])
def test_absurd_pushes_end_nothing(start: Start, push: str, refused: bool) -> None:
    scene = PARTS + f"bomb = Explodes()\nbomb.properties(Push={push})\nrobot.append(bomb)\n" + END
    process = start(scene, "--headless", "--speed", "0.01")  # leaves time to pause it before
    services = Line(process.port)
    services.call("simulation", "pause")
    services.call("simulation", "reset")
    pose = Line(services.call("simulation", "get_all_stream_ports")["robot.pose"])
    services.call("simulation", "step", 10)
    lines = [pose.read() for _ in range(10)]
    assert all(map(math.isfinite, [json.loads(line)[axis] for line in lines for axis in "xyz"]))
    text = process.log.read_text()
    assert ("robot.bomb failed and is deactivated" in text) == refused
    assert ("a force is three finite numbers" in text) == refused
    assert services.call("simulation", "list_robots") == ["robot"]
    assert process._process.poll() is None


def test_a_push_that_is_no_number_never_reaches_the_physics(start: Start) -> None:
    scene = PARTS + "import math\nbomb = Explodes()\nbomb.properties(Push=math.inf)\nrobot.append(bomb)\n" + END
    process = start(scene)
    services = Line(process.port)
    while (services.call("time", "now") or 0.0) < 0.2:
        pass
    assert math.isfinite(services.call("robot.pose", "get_local_data")["x"])
    log = process.log.read_text()
    assert "robot.bomb failed and is deactivated" in log
    assert "finite" in log


@pytest.mark.skipif(os.name != "posix", reason="signals")
@pytest.mark.parametrize(("paused", "name"), [(True, "SIGTERM"), (False, "SIGHUP")])
def test_a_simulation_ends_when_it_is_told_to_or_its_terminal_is_closed(start: Start, paused: bool, name: str) -> None:
    number = getattr(signal, name)
    # a program started by ``nohup`` ignores the loss of its terminal, and so do the programs that it starts
    before = signal.signal(number, signal.SIG_DFL)
    try:
        process = start(PARTS + END)
    finally:
        signal.signal(number, before)
    if paused:
        Line(process.port).call("simulation", "pause")
    process._process.send_signal(number)
    assert process._process.wait(60.0) == 0
    assert "EXITING SIMULATION" in process.log.read_text()
