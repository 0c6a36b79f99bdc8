"""`Morse(binary=True)`, with the server of this project and with servers that misbehave."""

import logging
import socket
import struct
import threading
from collections.abc import Iterator

import numpy as np
import pytest
from scripted_simulation import ScriptedSimulation

import morse
from morse.builder import ATRV, Environment, MotionVW, Pose, Sick
from morse.simulation.simulation import Simulation
from pymorse import Morse
from pymorse.binary import BinaryConnection
from pymorse.poller import Poller
from tests.kit.waiting import wait_until


def scene() -> None:
    robot = ATRV("robot")
    for part in (Pose("pose"), MotionVW("motion"), Sick("scan")):
        robot.append(part)
    robot.add_default_interface("socket")
    Environment("empty", fastmode=True)


@pytest.fixture(scope="module")
def running() -> Iterator[Simulation]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MORSE_SOCKET_PORT", "0")
        simulation = morse.load(scene, sockets=True)
    simulation.pause()
    thread = threading.Thread(target=simulation.run)
    thread.start()
    yield simulation
    simulation.stop()
    thread.join(60)
    simulation.close()


@pytest.fixture
def simu(running: Simulation) -> Iterator[Morse]:
    (manager, *_) = running.context.services.request_managers().values()
    with Morse("127.0.0.1", manager.port, binary=True) as connected:
        connected.pause()
        yield connected


def test_scans_are_arrays_and_steps_wait_for_them(simu: Morse) -> None:
    simu.robot.scan.last()
    simu.robot.pose.last()
    for _ in range(3):
        simu.robot.motion.publish({"v": 1.0, "w": 0.0})
        before = simu.time()
        simu.step(6)
        assert simu.robot.pose.last()["timestamp"] == pytest.approx(before + 6 / 60)
        scan = simu.robot.scan.last()
        assert scan["range_list"].shape == (181,)
        assert scan["range_list"].dtype == np.float64
        assert scan["point_list"].shape == (181, 3)
    x = simu.robot.pose.last()["x"]
    simu.step()
    assert simu.robot.pose.last()["x"] - x == pytest.approx(1 / 60, rel=1e-6)


def test_the_same_numbers_as_lines(running: Simulation, simu: Morse) -> None:
    with Morse("127.0.0.1", simu.port) as lines:
        for connected in (simu, lines):
            connected.robot.pose.last()
            connected.robot.scan.last()
        simu.step(6)
        lines.step(6)
        simu.rpc("time", "now")
        wait_until(lambda: simu.robot.pose.last() == lines.robot.pose.last())
        wait_until(lambda: simu.robot.scan.last()["timestamp"] == lines.robot.scan.last()["timestamp"])
        frame, line = simu.robot.scan.last(), lines.robot.scan.last()
        assert frame["range_list"].tolist() == line["range_list"]


def test_arrays_cannot_be_changed_by_mistake(simu: Morse) -> None:
    simu.robot.scan.last()
    simu.step(6)
    with pytest.raises(ValueError, match="read-only"):
        simu.robot.scan.last()["range_list"][0] = 1.0


def test_a_slow_callback_gets_the_latest_message_only(simu: Morse) -> None:
    times: list[float] = []
    go_on = threading.Event()

    def slow(message: dict[str, float]) -> None:
        times.append(message["timestamp"])
        go_on.wait(60)

    simu.robot.pose.subscribe(slow, latest=True)
    simu.step()
    wait_until(lambda: times)
    simu.step(50)
    go_on.set()

    def next_one() -> bool:
        simu.step()
        return len(times) > 1

    wait_until(next_one)
    assert times[1] - times[0] > 49 / 60, (times, simu.time())
    simu.robot.pose.unsubscribe(slow)
    with pytest.raises(ValueError, match="not in list"):
        simu.robot.pose.unsubscribe(slow)


def test_a_step_does_not_run_callbacks_that_only_need_the_latest_message(
    simu: Morse, monkeypatch: pytest.MonkeyPatch
) -> None:
    threads: list[threading.Thread] = []
    simu.robot.pose.subscribe(lambda _: threads.append(threading.current_thread()), latest=True)
    poller, connection = simu._latest_poller, simu._latest
    assert poller is not None
    assert connection is not None
    has_received, looks = connection.has_received, iter([False] * 3)

    def late(count: int) -> bool:
        return next(looks, True) and has_received(count)

    monkeypatch.setattr(connection, "has_received", late)
    monkeypatch.setattr(poller, "serve_until", lambda *_: pytest.fail("the step ran the callback"))
    simu.step()
    wait_until(lambda: threads)
    assert threads[0] is not threading.current_thread()


def test_callbacks_of_every_message_get_every_message(simu: Morse) -> None:
    times: list[float] = []
    simu.robot.pose.subscribe(lambda message: times.append(message["timestamp"]))
    simu.step(20)
    wait_until(lambda: len(times) == 20)
    assert np.diff(times) == pytest.approx(1 / 60)


def test_a_callback_may_use_another_sensor_and_services(simu: Morse) -> None:
    seen: list[object] = []

    def callback(_message: object) -> None:
        simu.robot.scan.last()
        seen.append(simu.rpc("simulation", "get_seed"))

    simu.robot.pose.subscribe(callback)
    simu.step()
    wait_until(lambda: seen)


def test_a_closed_stream_opens_again(simu: Morse) -> None:
    pose = simu.robot.pose
    pose.last()
    pose.close()
    assert pose.last() is None
    simu.step()
    assert pose.last() is not None


def test_a_simulation_without_binary_streams_says_so(simulation: ScriptedSimulation) -> None:
    simulation.replies["simulation get_binary_port"] = 'FAILED "The request get_binary_port has not been registered"'
    with pytest.raises(ConnectionError, match="no binary streams"):
        Morse("127.0.0.1", simulation.port, binary=True)


# servers that misbehave -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        (b'{"timestamp": 0.0, "x": 1.0}\n', "expected a frame"),
        (struct.pack("<2sBBIII", b"MF", 1, 1, 5, 1 << 31, 8), "larger than"),
        (struct.pack("<2sBBIII", b"MF", 1, 9, 5, 8, 8), "kind 9"),
        (struct.pack("<2sBBIII", b"MF", 1, 1, 5, 7, 8), "expected a frame"),
        (struct.pack("<2sBBIII", b"MF", 1, 0, 0, 8, 0) + b"no JSON!", "not JSON"),
        (struct.pack("<2sBBIII", b"MF", 1, 0, 0, 8, 0) + b"{}      " + b"timestamp", "expected a frame"),
    ],
)
def test_what_is_not_a_frame_ends_the_connection(answer: bytes, said: str, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.ERROR, "pymorse")
    poller = Poller()
    poller.start()
    try:
        with socket.create_server(("127.0.0.1", 0)) as server:
            connection = BinaryConnection("127.0.0.1", server.getsockname()[1], poller)
            peer, _ = server.accept()
            with peer:
                stream = connection.open("robot.pose")
                peer.sendall(answer)
                wait_until(lambda: not connection.is_up())
                with pytest.raises(ConnectionError, match="closed the stream"):
                    stream.get(60)
        assert said in caplog.text
    finally:
        poller.syncstop(5)


def test_frames_may_arrive_in_any_pieces() -> None:
    from morse.middleware.socket.frames import data_frame, notice_frame

    poller = Poller()
    poller.start()
    try:
        with socket.create_server(("127.0.0.1", 0)) as server:
            connection = BinaryConnection("127.0.0.1", server.getsockname()[1], poller)
            stream = connection.open("robot.pose")
            peer, _ = server.accept()
            wire = notice_frame({"subscribed": "robot.pose", "stream": 4})
            wire += b"".join(data_frame(4, {"n": n, "a": np.arange(n)}) for n in range(20))
            with peer:
                for begin in range(0, len(wire), 7):
                    peer.sendall(wire[begin : begin + 7])
                wait_until(lambda: stream.has_received(20))
            assert [stream.last(20 - n)["n"] for n in range(20)] == list(range(20))
    finally:
        poller.syncstop(5)
