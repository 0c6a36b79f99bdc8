"""What is lost is said."""

import logging

import pytest

import morse
from morse.builder import ATRV, Environment, MotionVW
from morse.core.clients.complaints import Complaints, Waiting
from morse.core.datastream import DatastreamManager
from morse.core.streams.kind_stream import KindStream
from morse.scene import StreamDeclaration


def test_the_oldest_entries_are_lost_and_counted(caplog: pytest.LogCaptureFixture) -> None:
    now = [0.0]
    complaints = Complaints(logging.getLogger("morse.test"), lambda: now[0])
    waiting: Waiting[int] = Waiting(3, complaints, "motion", "commands")
    for number in range(3):
        waiting.append(number)
    assert caplog.messages == []
    for number in range(3, 8):
        waiting.append(number)
    assert list(waiting) == [5, 6, 7]
    assert caplog.messages == ["motion: commands arrive faster than they are read: the oldest of more than 3 are lost"]
    now[0] = 11.0
    waiting.append(8)
    assert caplog.messages[1].endswith("(4 more of this kind)")


def test_commands_that_are_lost_are_said(caplog: pytest.LogCaptureFixture) -> None:
    def scene() -> None:
        robot = ATRV("robot")
        robot.append(MotionVW("motion"))
        Environment("empty", fastmode=True)

    with morse.load(scene) as simulation:
        manager = DatastreamManager({}, simulation.context)
        component = simulation.context.components["robot.motion"]
        kind = f"{KindStream.__module__}.{KindStream.__name__}"
        manager.connect(component, StreamDeclaration("link", kind, "IN", {}))
        (stream,) = manager.streams["robot.motion"]
        for number in range(100):
            stream.receive(stream.kinds[0], {"linear": [0.01 * number, 0.0, 0.0]})
        simulation.step()
        assert component.local_data["v"] == 0.99
    (line,) = [one for one in caplog.messages if "are lost" in one]
    assert line.startswith("robot.motion: commands arrive faster")
