"""A reset uses the scene script as it was when the simulation was loaded."""

from pathlib import Path

import pytest

import morse

SCENE = """
from morse.builder import *
robot = FakeRobot()
robot.translate(x={x})
pose = Pose()
robot.append(pose)
teleport = Teleport()
robot.append(teleport)
env = Environment('empty')
"""


def test_a_reset_does_not_read_an_edited_script(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(SCENE.format(x=1.0))
    with morse.load(script) as simulation:
        simulation.robot.teleport.publish({"x": 5.0, "y": 0.0, "z": 0.0, "yaw": 0.0, "pitch": 0.0, "roll": 0.0})
        simulation.step(10)
        assert simulation.robot.pose.get()["x"] == pytest.approx(5.0)
        script.write_text(SCENE.format(x=2.0))
        simulation.restart()
        simulation.step(2)
        assert simulation.robot.pose.get()["x"] == pytest.approx(1.0)
    with morse.load(script) as simulation:
        simulation.step(2)
        assert simulation.robot.pose.get()["x"] == pytest.approx(2.0)
