"""A client controls the clock: pause, step, resume, reset."""

import json
import math
import socket
import threading
import time

import pytest

import morse
from morse.builder import ATRV, Environment, MotionVW, Pose
from morse.testing.process import SimulationProcess
from pymorse import Morse, MorseServiceFailed, MorseServicePreempted

HZ = 60


def scene():
    robot = ATRV("robot")
    pose = Pose("pose")
    robot.append(pose)
    motion = MotionVW("motion")
    robot.append(motion)
    slow = Pose("slow")
    slow.frequency(10)
    robot.append(slow)
    robot.add_default_interface("socket")
    env = Environment("empty", fastmode=True)
    env.set_seed(42)


class Wire:
    """A raw connection for lines."""

    def __init__(self, port: int) -> None:
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=60)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._lines = self.socket.makefile("rb")

    def send(self, line: bytes) -> None:
        self.socket.sendall(line)

    def line(self) -> bytes:
        return self._lines.readline()

    def waiting(self) -> bytes:
        """All received data; non-blocking."""
        self.socket.setblocking(False)
        received = b""
        try:
            while data := self.socket.recv(1 << 20):
                received += data
        except BlockingIOError:
            pass
        self.socket.settimeout(60)
        return received


def connected(host: str, port: int, source: int) -> socket.socket:
    """A connection from a given port, which several connections to different ports may share."""
    connection = socket.socket()
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    connection.bind((host, source))
    connection.connect((host, port))
    return connection


@pytest.fixture
def services(process: SimulationProcess, simu: Morse) -> Wire:
    return Wire(process.port)


def test_no_time_passes_while_paused(simu: Morse) -> None:
    simu.step(3)
    before, state = simu.time(), simu.rpc("simulation", "state_hash")
    deadline = time.monotonic() + 0.3
    while time.monotonic() < deadline:
        assert simu.time() == before
    assert simu.rpc("simulation", "state_hash") == state


@pytest.mark.parametrize("ticks", [1, 2, 59, 600])
def test_steps_are_so_many_ticks(simu: Morse, ticks: int) -> None:
    simu.step(ticks)
    assert simu.time() == pytest.approx(ticks / HZ)
    simu.step()
    assert simu.time() == pytest.approx((ticks + 1) / HZ)


def test_the_answer_to_a_step_comes_after_its_data(simu: Morse, services: Wire) -> None:
    """The messages of every stream about the steps are sent before the reply of step, which tells how many they are."""
    ports = simu.rpc("simulation", "get_all_stream_ports")
    pose, slow = Wire(ports["robot.pose"]), Wire(ports["robot.slow"])
    names = [f"127.0.0.1:{wire.socket.getsockname()[1]} {wire.socket.getpeername()[1]}" for wire in (pose, slow)]
    for round_ in range(50):
        services.send(b"7 simulation step [6, true]\n")
        number, outcome, told = services.line().split(maxsplit=2)
        assert (number, outcome) == (b"7", b"SUCCESS")
        assert [json.loads(told)[name] for name in names] == [6 * (round_ + 1), round_ + 1]
        # on other connections, they may arrive later than the reply
        lines = [pose.line() for _ in range(6)]
        assert f'"timestamp": {(round_ + 1) * 6 / HZ}'[:20].encode() in lines[-1]
        assert f'"timestamp": {(round_ * 6 + 1) / HZ}'[:20].encode() in lines[0]
        assert slow.line()
    assert pose.waiting() == slow.waiting() == b""


def test_a_step_obeys_the_command_that_was_sent_before_it(simu: Morse, services: Wire) -> None:
    motion = Wire(simu.rpc("simulation", "get_stream_port", "robot.motion"))
    x = 0.0
    for n in range(40):
        speed = 1.0 + n % 2
        motion.send(b'{"v": %f, "w": 0.0}\n' % speed)
        services.send(b"7 simulation step\n")
        services.line()
        before, x = x, simu.robot.pose.get_local_data().result()["x"]
        if n > 1:  # the robot starts from rest on its springs
            assert x - before == pytest.approx(speed / HZ, rel=0.05)


def test_a_step_obeys_a_command_on_a_connection_that_is_just_made(simu: Morse, services: Wire) -> None:
    port = simu.rpc("simulation", "get_stream_port", "robot.motion")

    def asked(request: bytes) -> bytes:
        services.send(request)
        return services.line()

    hashes = set()
    for speed in (None, *[1.0] * 40):
        asked(b"1 simulation reset\n")
        if speed is not None:
            motion = Wire(port)
            motion.send(b'{"v": %f, "w": 0.0}\n' % speed)
        asked(b"2 simulation step\n")
        # asked for when the step has ended: a request beside a step is served while the step is waiting
        hashes.add((speed, asked(b"3 simulation state_hash\n")))
    (_, without), (_, with_it) = sorted(hashes, key=lambda one: one[0] is not None)
    assert without != with_it
    assert simu.robot.pose.get_local_data().result()["x"] > 0.0


def test_steps_that_are_asked_for_at_once_are_done_one_after_the_other(simu: Morse, services: Wire) -> None:
    services.send(b"1 simulation step [10]\n2 simulation step [20]\n3 simulation step\n")
    assert [services.line()[:9] for _ in range(3)] == [b"1 SUCCESS", b"2 SUCCESS", b"3 SUCCESS"]
    assert simu.time() == pytest.approx(31 / HZ)


def test_a_step_pauses_a_simulation_that_runs(simu: Morse) -> None:
    simu.resume()
    simu.sleep(0.1)
    simu.step()
    now = simu.time()
    assert now > 0.1
    assert simu.time() == now


def test_a_simulation_that_is_resumed_goes_on(simu: Morse) -> None:
    simu.resume()
    simu.sleep(0.2)
    assert simu.time() >= 0.2


def test_a_pause_ends_the_steps(simu: Morse) -> None:
    steps = simu.call("simulation", "step", 10_000_000)
    simu.pause()
    with pytest.raises(MorseServicePreempted):
        steps.result(60)
    now = simu.time()
    assert simu.time() == now < 1e5


def test_steps_can_be_cancelled(simu: Morse) -> None:
    steps = simu.call("simulation", "step", 10_000_000)
    assert simu.time() >= 0.0  # it runs
    steps.cancel()
    with pytest.raises(MorseServicePreempted):
        steps.result(60)
    now = simu.time()
    assert simu.time() == now


def test_a_new_beginning_ends_the_steps(simu: Morse) -> None:
    steps = simu.call("simulation", "step", 10_000_000)
    while simu.time() == 0.0:
        assert not steps.done()
    simu.reset(seed=1)
    with pytest.raises(MorseServicePreempted):
        steps.result(60)
    assert simu.time() == 0.0


def test_connections_from_the_same_port_are_told_apart(
    simu: Morse, process: SimulationProcess, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As the system does with many connections: one stream does not wait for the messages of the other."""
    listener = connected("127.0.0.1", simu.get_stream_port("robot.pose"), 0)
    shared = listener.getsockname()[1]
    monkeypatch.setattr("pymorse.stream.connect", lambda host, port: connected(host, port, shared))
    ours = f"127.0.0.1:{shared} {simu.get_stream_port('robot.motion')}"
    theirs = f"127.0.0.1:{shared} {simu.get_stream_port('robot.pose')}"
    # a client without the streams of the tests before
    with Morse("127.0.0.1", process.port) as client:
        client.robot.motion.publish({"v": 1.0, "w": 0.0})
        assert [stream.connection for stream in client._streams] == [ours]
        client.step(5)
        monkeypatch.setattr("pymorse.pymorse.TIMEOUT", 100.0)
        begin = time.monotonic()
        sent = client.rpc("simulation", "step", 1, True)
        assert sent[theirs] == 6
        assert ours not in sent
        client.step()
        assert time.monotonic() - begin < 50.0
    listener.close()


@pytest.mark.parametrize("n", [0, -1, 1.5, 1e9, math.nan, math.inf, "3", None, True, [1], 10**30])
def test_numbers_of_steps_that_are_none_are_refused(simu: Morse, n: object) -> None:
    with pytest.raises(MorseServiceFailed):
        simu.rpc("simulation", "step", n)
    assert simu.time() == 0.0


@pytest.mark.parametrize("seed", [-1, 1.5, math.nan, "3", True, [1], 2**63, 10**30])
def test_seeds_that_are_none_are_refused(simu: Morse, seed: object) -> None:
    simu.step(7)
    with pytest.raises(MorseServiceFailed):
        simu.rpc("simulation", "reset", seed)
    assert simu.time() == pytest.approx(7 / HZ)


def test_the_seed(simu: Morse) -> None:
    simu.reset(seed=42)
    assert simu.rpc("simulation", "get_seed") == 42
    simu.reset(seed=2**63 - 1)
    assert simu.rpc("simulation", "get_seed") == 2**63 - 1
    simu.rpc("simulation", "reset")
    assert simu.rpc("simulation", "get_seed") == 2**63 - 1
    simu.reset(seed=42)


def test_a_new_beginning_is_a_beginning(simu: Morse) -> None:
    """Time, poses, commands and data are as at the start; connected clients stay connected."""
    simu.reset(seed=42)
    start = simu.rpc("simulation", "state_hash")
    motion, pose = simu.robot.motion, simu.robot.pose
    motion.publish({"v": 1.0, "w": 0.5})
    pose.last()
    simu.step(60)
    moved = simu.rpc("simulation", "state_hash")
    assert moved != start
    simu.reset(seed=42)
    assert simu.time() == 0.0
    assert simu.rpc("simulation", "state_hash") == start
    simu.step(60)
    assert pose.last()["x"] == pytest.approx(0.0, abs=1e-3)
    motion.publish({"v": 1.0, "w": 0.5})
    simu.reset(seed=42)
    motion.publish({"v": 1.0, "w": 0.5})
    simu.step(60)
    assert simu.rpc("simulation", "state_hash") == moved
    assert pose.last()["timestamp"] == pytest.approx(1.0)


def test_a_command_from_before_the_new_beginning_is_forgotten(simu: Morse, services: Wire) -> None:
    motion = Wire(simu.rpc("simulation", "get_stream_port", "robot.motion"))
    motion.send(b'{"v": 1.0, "w": 0.0}\n')
    services.send(b"1 simulation reset\n2 simulation step [30]\n")
    assert [services.line()[:9], services.line()[:9]] == [b"1 SUCCESS", b"2 SUCCESS"]
    assert simu.robot.pose.get_local_data().result()["x"] == pytest.approx(0.0, abs=1e-3)


def test_the_state_is_told_by_a_hash(simu: Morse) -> None:
    state = simu.rpc("simulation", "state_hash")
    assert len(state) == 64
    assert set(state) <= set("0123456789abcdef")
    simu.step()
    assert simu.rpc("simulation", "state_hash") != state


def slow_scene():
    ATRV("robot")
    env = Environment("empty", fastmode=True)
    env.simulator_frequency(0.1)


def test_a_paused_simulation_answers_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not only when the next tick would be due, as each call would that follows an answer."""
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    with morse.load(slow_scene, sockets=True) as simulation:
        simulation.pause()
        running = threading.Thread(target=simulation.run)
        running.start()
        (manager,) = simulation.context.services.request_managers().values()
        services = Wire(manager.port)
        begin = time.monotonic()
        for _ in range(20):
            services.send(b"1 time now\n")
            assert services.line().startswith(b"1 SUCCESS")
        # ticks would be due after 200 s
        assert time.monotonic() - begin < 100.0
        simulation.stop()
        simulation.context.wake()
        running.join(60.0)
        assert not running.is_alive()
