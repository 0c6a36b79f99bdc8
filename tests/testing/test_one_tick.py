"""Latencies of commands and messages."""

from collections.abc import Callable

import pytest

from morse.builder import *  # noqa: F403
from pymorse import Morse

TICK = 1.0 / 60.0


def scene() -> None:
    robot = ATRV()  # noqa: F405
    pose = Pose()  # noqa: F405
    robot.append(pose)
    motion = MotionVW()  # noqa: F405
    robot.append(motion)
    robot.add_default_interface("socket")
    env = Environment("empty", fastmode=True)  # noqa: F405, F841


def test_a_command_acts_in_the_next_tick_and_a_message_arrives_in_its_own(simulate: Callable[..., Morse]) -> None:
    simu = simulate(scene)
    simu.sleep(0.5)
    simu.robot.pose.get()
    simu.pause()
    simu.step(1)
    for v in (1.0, -0.5, 2.0):
        simu.robot.motion.publish({"v": 0.0, "w": 0.0})
        simu.step(5)
        before = simu.robot.pose.last()
        simu.robot.motion.publish({"v": v, "w": 0.0})
        simu.step(1)
        after = simu.robot.pose.last()
        # the message of the tick itself, with the full effect of the command
        assert after["timestamp"] - before["timestamp"] == pytest.approx(TICK, abs=1e-6)
        assert after["timestamp"] == pytest.approx(simu.time(), abs=1e-6)
        assert after["x"] - before["x"] == pytest.approx(v * TICK, abs=2e-4)
