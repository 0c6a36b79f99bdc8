"""Clients that use up the file descriptors: the simulation goes on, and takes clients again when others leave."""

import contextlib
import json
import socket
from pathlib import Path

import pytest
from limited import call, connect, is_closed, limited_run, reset, told_once
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect as websocket

from tests.kit.waiting import wait_until

pytest.importorskip("resource")

_SERVICES, _VIEW = r"services are on port (\d+)", r"http://127.0.0.1:(\d+)"
_BRIDGE, _FOXGLOVE = r"rosbridge: ws://127.0.0.1:(\d+)", r"foxglove: ws://127.0.0.1:(\d+)"
_SCENE = """
from morse.builder import *

robot = ATRV("robot")
for component in (Pose("pose"), Odometry("odometry"), MotionVW("motion"), Infrared("infrared")):
    robot.append(component)
robot.add_default_interface("socket")
robot.add_default_interface("rosbridge")
robot.add_default_interface("foxglove")
robot.add_default_interface("yarp")
env = Environment("empty", fastmode=True)
env.configure_stream_manager("rosbridge", port=0)
env.configure_stream_manager("foxglove", port=0)
"""
_VIEWED = ("--view", "web", "--view-port", "0", "--no-browser")


@pytest.mark.parametrize(
    "limit", [64, 128, pytest.param(256, marks=pytest.mark.slow), pytest.param(1024, marks=pytest.mark.slow)]
)
def test_silent_connections_to_all_ports_do_not_end_the_run_and_lock_nobody_out(tmp_path: Path, limit: int) -> None:
    with limited_run(_SCENE, tmp_path, limit, *_VIEWED) as run:
        services = run.port(_SERVICES)
        first = connect(services)
        first.sendall(b"1 simulation get_all_stream_ports []\n")
        lines = first.makefile("rb")
        ports = [*json.loads(lines.readline().split(maxsplit=2)[2]).values()]
        ports += [services, *(run.port(pattern) for pattern in (_VIEW, _BRIDGE, _FOXGLOVE))]
        crowd = []
        for number in range(2 * limit):
            with contextlib.suppress(OSError):
                crowd.append(connect(ports[number % len(ports)]))
        # nobody who speaks is locked out by those who do not
        assert call(services).startswith(b"1 SUCCESS")
        with connect(run.port(_VIEW)) as browser:
            browser.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
            assert browser.recv(15) == b"HTTP/1.1 200 OK"
        # and who has spoken keeps the connection
        first.sendall(b"2 simulation details []\n")
        assert lines.readline().startswith(b"2 SUCCESS")
        for sock in crowd:
            reset(sock)
        assert call(services, b"3 simulation get_all_stream_ports []\n").startswith(b"3 SUCCESS")
        lines.close()
        first.close()
    assert len(run.log.splitlines()) < 150, run.log


def test_who_finds_no_descriptor_is_told_and_gets_in_when_others_leave(tmp_path: Path) -> None:
    with limited_run(_SCENE, tmp_path, 64, *_VIEWED) as run:
        services = run.port(_SERVICES)
        crowd = []
        refusals = []
        for number in range(64):
            sock = connect(services)
            sock.sendall(b"%d simulation get_all_stream_ports []\n" % number)
            with sock.makefile("rb") as lines:
                answer = lines.readline()
            (crowd if b"SUCCESS" in answer else refusals).append(sock)
            assert b"SUCCESS" in answer or b"no place for one more connection" in answer
        assert len(crowd) >= 8
        assert refusals
        with connect(run.port(_VIEW)) as browser:
            browser.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
            with browser.makefile("rb") as answer_of_view:
                assert b" 503 " in answer_of_view.readline()
        assert told_once(run.log, "services: a client is refused"), run.log
        assert told_once(run.log, "live view: a client is refused"), run.log
        for sock in crowd:
            sock.close()
        wait_until(lambda: call(services).startswith(b"1 SUCCESS"))
        for sock in refusals:
            sock.close()


def test_ticks_go_on_when_the_process_has_no_descriptors_left(tmp_path: Path) -> None:
    hog = """
import os
from morse.core.actuator import Actuator

class Hog(Actuator):
    "Opens all files that it can."
    _name = "Hog"
    files = []

    def default_action(self):
        try:
            while True:
                self.files.append(os.open(os.devnull, os.O_RDONLY))
        except OSError:
            pass
        if self.clock.tick == 150:
            while self.files:
                os.close(self.files.pop())
            self.active = False
"""
    folder = tmp_path / "src" / "hogs"
    (folder / "actuators").mkdir(parents=True)
    (folder / "actuators" / "hog.py").write_text(hog, encoding="utf-8")
    for package in (folder, folder / "actuators"):
        (package / "__init__.py").touch()
    derived = "from morse.builder.creator import ActuatorCreator\n\nclass Hog(ActuatorCreator):\n"
    derived += "    _classpath = 'hogs.actuators.hog.Hog'\n"
    scene = derived + _SCENE.replace(
        "for component in (", "for component in (Hog('hog'), VideoCamera('camera'), IMU('imu'), "
    ).replace("fastmode=True", "fastmode=False")
    with limited_run(scene, tmp_path, 128, *_VIEWED, PYTHONPATH=str(tmp_path / "src")) as run:
        services = run.port(_SERVICES)
        wait_until(lambda: call(services).startswith(b"1 SUCCESS"))
    assert len(run.log.splitlines()) < 100, run.log


@pytest.mark.parametrize("port", [_SERVICES, _VIEW, _BRIDGE, _FOXGLOVE])
def test_silent_connections_give_way_one_by_one(tmp_path: Path, port: str) -> None:
    with limited_run(_SCENE, tmp_path, 128, *_VIEWED) as run:
        number = run.port(port)
        crowd: list[socket.socket] = [connect(number) for _ in range(150)]
        ended = wait_until(lambda: [sock for sock in crowd if is_closed(sock)])
        assert is_closed(crowd[0])  # the oldest has left
        assert not is_closed(crowd[-1])
        assert len(ended) < len(crowd)
        assert told_once(run.log, "to make room")
        for sock in crowd:
            sock.close()


def test_a_websocket_without_a_message_gives_way_and_one_with_a_message_stays(tmp_path: Path) -> None:
    scene = _SCENE.replace('"rosbridge", port=0', '"rosbridge", port=0, most_clients=2')
    advertisement = '{"op": "advertise", "topic": "/robot/motion", "type": "geometry_msgs/msg/Twist"}'
    with limited_run(scene, tmp_path, 256, "--headless") as run, contextlib.ExitStack() as stack:
        address = f"ws://127.0.0.1:{run.port(_BRIDGE)}"
        silent = [stack.enter_context(websocket(address)) for _ in range(2)]
        speaking = []
        for _ in range(2):
            speaking.append(stack.enter_context(websocket(address)))
            speaking[-1].send(advertisement)
            # answered after the message before it
            speaking[-1].ping().wait(60.0)
        for one in silent:
            with pytest.raises(ConnectionClosed):
                one.recv(timeout=60.0)
        with pytest.raises(InvalidStatus, match="503"), websocket(address):
            pass
        for one in speaking:
            one.ping().wait(60.0)
