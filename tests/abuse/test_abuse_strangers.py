"""Web pages, clients that crash, and time that hardly advances: a whole simulation."""

import contextlib
import http.client
import json
import re
import urllib.request
from collections.abc import Callable

import pytest
from victims import SCENE, Victim
from wire import HZ, Footprint, Witness, drained

from morse.testing.process import SimulationProcess
from tests.kit.programs import Line

Start = Callable[..., SimulationProcess]

pytestmark = pytest.mark.long


def test_a_page_of_another_origin_drives_nobody_and_ends_nothing(victim: Victim) -> None:
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    body = b'1 simulation quit\n1 anna.motion set_speed [1.0, 0.0]\n{"v": 1.0, "w": 0.0}\n'
    before = json.loads(Line(victim.streams["anna.pose"]).read())
    for port in (victim.port, *victim.streams.values()):
        request = urllib.request.Request(
            f"http://127.0.0.1:{port}/",
            data=body,
            headers={"Origin": "http://example.org", "Content-Type": "text/plain"},
        )
        with pytest.raises((OSError, http.client.HTTPException)):
            opener.open(request, timeout=60.0)
    services = Line(victim.port)
    services.call("time", "sleep", 1.0)
    after = services.call("anna.pose", "get_local_data")
    assert after["x"] == pytest.approx(before["x"], abs=1e-3)
    assert victim.log().count("speaks HTTP") >= 1
    services.close()


def test_many_strangers_do_not_fill_the_log(victim: Victim) -> None:
    before = victim.log().count("turned away")
    with Witness(victim.port, victim.streams["anna.pose"]):
        for _ in range(300):
            line = Line(victim.port)
            with contextlib.suppress(ConnectionError):
                line.send(b"GET / HTTP/1.1\r\n\r\n")
            drained(line)
            line.close()
    assert victim.log().count("turned away") - before < 10


def test_idle_connections_shut_nobody_out(victim: Victim, descriptors: int) -> None:
    idle: list[Line] = []
    each = min(400, (descriptors - 200) // 4)
    with Witness(victim.port, victim.streams["anna.pose"]):
        for port in (victim.port, victim.streams["anna.pose"], victim.streams["anna.motion"]):
            idle += [Line(port) for _ in range(each)]
        for port in (victim.port, victim.streams["bert.motion"]):
            line = Line(port)
            line.send(b"\n")
            line.close()
        assert Line(victim.port).call("simulation", "list_robots") == ["anna", "bert"]
        assert json.loads(Line(victim.streams["anna.pose"]).read())["timestamp"] > 0.0
    assert victim.log().count("turned away") < 40
    for line in idle:
        line.close()


@pytest.mark.skipif(not Footprint.possible(), reason="the system does not tell")
def test_what_a_dead_client_asked_for_ends_with_it(victim: Victim) -> None:
    footprint = Footprint(victim.process.pid)
    with Witness(victim.port, victim.streams["anna.pose"]) as witness:
        for round_ in range(6):
            if round_ == 2:
                memory = footprint.memory
            clients = [Line(victim.port) for _ in range(5)]
            for client in clients:
                client.send(b"".join(b"%d time sleep [1e9]\n" % n for n in range(1000)))
                client.send(b"x simulation list_robots\n")
                while not client.read().startswith(b"x "):
                    pass
            clients[0].send(b"".join(b"%d cancel\n" % n for n in range(1000)) + b"y simulation list_robots\n")
            answers = [clients[0].read() for _ in range(1001)]
            assert sum(b"PREEMPTED" in answer for answer in answers) == 1000
            for client in clients:
                client.vanish()
        witness.wait_for(60)
    assert footprint.memory < 1.05 * memory


def test_steps_end_with_who_asked_for_them(start: Start) -> None:
    process = start(SCENE, "--headless", "--speed", "max")
    victim = Victim(process)
    services, gone = Line(process.port), Line(process.port)
    gone.send(b"1 simulation step [36000000]\n")
    pose = Line(victim.streams["anna.pose"])
    pose.read()
    services.send(b"2 simulation step [3]\n")
    gone.vanish()
    assert services.read() == b"2 SUCCESS\n"
    tick = round(services.call("time", "now") * HZ)
    assert round(services.call("time", "now") * HZ) == tick, "it is paused"
    process.stop()


@pytest.mark.parametrize("scale", [0.001, 0.01])
def test_services_are_answered_however_slowly_time_goes(start: Start, scale: float) -> None:
    process = start(SCENE, "--headless", "--speed", str(scale))
    services = Line(process.port, timeout=60.0)
    for _ in range(5):
        assert services.call("simulation", "list_robots") == ["anna", "bert"]
    services.send(b"1 time set_time_scale [1e-9]\n")
    assert services.read().startswith(b"1 FAILED")
    services.call("time", "set_time_scale", 10.0)
    services.call("time", "sleep", 0.5)
    services.call("time", "set_time_scale", scale)
    services.call("simulation", "pause")
    services.call("simulation", "step", 2)
    process.stop()


def test_a_command_sent_before_a_step_is_seen_by_it(victim: Victim) -> None:
    """Over a new connection each time: the robot turns according to the command for this tick."""
    services = Line(victim.port)
    services.call("simulation", "pause")
    yaw = services.call("anna.pose", "get_local_data")["yaw"]
    for n in range(200):
        turn = 0.6 if n % 3 else -1.2
        command = Line(victim.streams["anna.motion"])
        command.send(b'{"v": 0.0, "w": %f}\n' % turn)
        services.call("simulation", "step", 1)
        before, yaw = yaw, services.call("anna.pose", "get_local_data")["yaw"]
        assert (yaw - before) * HZ == pytest.approx(turn, abs=0.05), n
        command.close()
    Line(victim.streams["anna.motion"]).send(b'{"v": 0.0, "w": 0.0}\n')
    services.call("simulation", "resume")
    services.close()


def test_half_characters_everywhere(start: Start) -> None:
    """In fields of an actuator that a page shows, names, properties and ids."""
    process = start(SCENE, "--view-port", "0", "--no-browser", "--speed", "5")
    victim = Victim(process)
    assert re.search(r"http://127\.0\.0\.1:(\d+)/", victim.log())
    with Witness(victim.port, victim.streams["anna.pose"]):
        motion, services = Line(victim.streams["anna.motion"]), Line(victim.port)
        for text in (b"\\ud800", b"\\udfff\\ud800", b"\xed\xa0\x80"):
            motion.send(b'{"%b": 1}\n{"v": "%b"}\n{"%b": {"%b": ["%b"]}}\n' % ((text,) * 5))
            for request in (
                b'1 anna.motion set_property ["%b", "%b"]' % (text, text),
                b'1 simulation activate ["%b"]' % text,
                b"%b simulation list_robots" % text,
                b"1 %b %b" % (text, text),
                b"1 anna.motion get_local_data",
                b'1 simulation set_log_level ["%b", "debug"]' % text,
                b'1 communication distance_and_view ["%b", "%b"]' % (text, text),
            ):
                services.send(request + b"\n")
                words = services.read().split()
                assert words[1] in (b"FAILED", b"SUCCESS")
    process.stop()
