"""Commands that expire: the option ``timeout`` of the streams of actuators."""

from collections.abc import Callable
from typing import Any

import pytest

from morse.core.exceptions import MorseError
from tests.kit.scenes import Load

SCENE = """
from morse.builder import *
robot = ATRV()
{component}
env = Environment("empty")
"""
MOTION = 'motion = MotionVW(); robot.append(motion); motion.add_stream("socket", timeout=0.5)'


@pytest.fixture
def start(load: Load) -> Load:
    return lambda component: load(SCENE.format(component=component), sockets=True)


def send(sim: Any, text: bytes) -> None:
    """A command arrives, and is applied in the next tick."""
    (manager,) = [one for one in sim.observers if "robot.motion" in getattr(one, "streams", ())]
    (stream,) = manager.streams["robot.motion"]
    stream.server.inbox.put(text)
    sim.step()


def test_a_robot_stops_when_its_commands_cease(start: Callable[[str], Any], caplog: pytest.LogCaptureFixture) -> None:
    sim = start(MOTION)
    sim.step(60)
    assert "no command" not in caplog.text
    for _ in range(2):  # a command after the timeout counts as usual
        send(sim, b'{"v": 0.8, "w": 0.2}')
        sim.step(29)
        assert sim.robot.motion.data["v"] == 0.8
        sim.step(1)  # 30 ticks of 1/60 s
        assert (sim.robot.motion.data["v"], sim.robot.motion.data["w"]) == (0.0, 0.0)
    assert "robot.motion: no command for 0.5 s" in caplog.text


@pytest.mark.parametrize(
    ("component", "said"),
    [
        ('pose = Pose(); robot.append(pose); pose.add_stream("socket", timeout=1.0)', "is for actuators"),
        ('motion = MotionVW(); robot.append(motion); motion.add_stream("ros2", timeout=-1.0)', "timeout"),
        ('motion = MotionVW(); robot.append(motion); motion.add_stream("mqtt", timeout="long")', "timeout"),
    ],
)
def test_timeouts_that_make_no_sense_are_refused(start: Callable[[str], Any], component: str, said: str) -> None:
    with pytest.raises(MorseError, match=said):
        start(component)
