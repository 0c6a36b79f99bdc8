"""Messages of sensors are made beside the ticks in a paced run, and are the same as those made in the ticks."""

import threading
from collections.abc import Iterator
from typing import Any

import pytest
from desk import Desk, DeskPublisher

import morse
from morse.builder import ATRV, IMU, Environment, MotionVW, Odometry, Pose

ROBOTS, TICKS = 5, 12


def scene() -> None:
    for number in range(ROBOTS):
        robot = ATRV(f"r{number}")
        robot.translate(5.0 * number, 0.0, 0.1)
        robot.append(MotionVW("motion"))
        for sensor in (Pose("pose"), Odometry("odometry"), IMU("imu")):
            sensor.translate(0.3, -0.2, 0.4)
            sensor.rotate(z=0.5)
            robot.append(sensor)
            sensor.add_stream("ros2")
    Environment("empty", fastmode=True)


class Watched(DeskPublisher):
    """Remembers the thread of each message."""

    threads: set[int]

    def __init__(self) -> None:
        super().__init__()
        self.threads = set()

    def publish(self, data: bytes) -> bool:
        self.threads.add(threading.get_ident())
        return super().publish(data)


@pytest.fixture(scope="module")
def runs() -> Iterator[dict[str, dict[str, Watched]]]:
    """The topics of a run, and of one that the wall clock paces."""
    found = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MORSE_SOCKET_PORT", "0")
        patch.setattr("desk.DeskPublisher", Watched)
        patch.setattr(Desk, "takes_threads", True)
        for name in ("unpaced", "paced"):
            desk = Desk(None)
            patch.setattr("morse.middleware.ros2.domain.make_backend", lambda options, desk=desk: desk)
            with morse.load(scene, sockets=True) as simulation:
                _run(simulation, paced=name == "paced")
            found[name] = {topic: made for topic, (_, _, made) in desk.publishers.items()}
        yield found  # type: ignore[misc]


def _run(simulation: Any, *, paced: bool) -> None:
    simulation.context.paced = lambda: paced
    for number in range(ROBOTS):
        getattr(simulation, f"r{number}").motion.publish({"v": 0.5 + number, "w": 0.3 * number})
    simulation.step(TICKS)


def _sensors(topics: dict[str, Watched]) -> list[str]:
    return [topic for topic in topics if topic.endswith(("/pose", "/odometry", "/imu/data")) or topic == "/tf"]


def test_each_tick_sends_a_message(runs: dict[str, dict[str, Watched]]) -> None:
    topics = _sensors(runs["unpaced"])
    assert len(topics) == 3 * ROBOTS + 1
    for topic in topics:
        single = runs["unpaced"][topic].sent
        assert len(set(single)) == len(single) == TICKS


def test_messages_beside_the_ticks_are_the_same_and_in_order(runs: dict[str, dict[str, Watched]]) -> None:
    for topic in _sensors(runs["unpaced"]):
        assert runs["paced"][topic].sent == runs["unpaced"][topic].sent, topic


def test_a_paced_tick_does_not_encode_them(runs: dict[str, dict[str, Watched]]) -> None:
    here = threading.get_ident()
    poses = [topic for topic in _sensors(runs["paced"]) if topic.endswith("/pose")]
    assert all(here not in runs["paced"][topic].threads for topic in poses)
    assert all(runs["unpaced"][topic].threads == {here} for topic in poses)


def test_a_sensor_that_is_deleted_sends_what_it_has_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    desk = Desk(None)
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    monkeypatch.setattr(Desk, "takes_threads", True)
    monkeypatch.setattr("morse.middleware.ros2.domain.make_backend", lambda options: desk)
    with morse.load(scene, sockets=True) as simulation:
        simulation.context.paced = lambda: True
        simulation.step(3)
        simulation.delete("r1")
        assert len(desk.publishers["/r1/pose"][2].sent) == 3
        simulation.step(2)
        assert len(desk.publishers["/r1/pose"][2].sent) == 3
        (manager,) = [one for one in simulation.context.stream_managers.values() if hasattr(one, "sender")]
        manager.sender.finish()
        assert len(desk.publishers["/r2/pose"][2].sent) == 5
