"""Actions and services with their own types, called by a real node in another process."""

import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest
from other_side import DOMAIN, PYTHON, has, lent, need, talk

import morse

OVERLAY = """
from std_srvs.srv import SetBool
from test_msgs.action import Fibonacci

from morse.core.overlay import MorseOverlay
from morse.core.services import interruptible
from morse.middleware.ros_request_manager import ros_action, ros_service


class Driver(MorseOverlay):
    def name(self):
        return "driver"

    @ros_service(type=SetBool)
    def halt(self, data):
        self.overlaid_object.stop()
        return data, "halted"

    @interruptible
    @ros_action(type=Fibonacci, feedback="rest")
    def go(self, goal):
        if goal.order < 0:
            raise ValueError("not that way")
        self.overlaid_object.goto(self.chain_callback(self.arrived), float(goal.order), 0.0, 0.0, 0.5, 2.0)

    def rest(self):
        return Fibonacci.Feedback(sequence=[round(1000 * self.progress()["distance_remaining"])])

    def arrived(self, outcome):
        status, _ = outcome
        return status, Fibonacci.Result(sequence=[1, 1, 2])
"""
SCENE = """
from morse.builder import *
robot = ATRV()
goal = Waypoint("goal")
goal.add_overlay("ros2", "driver_overlay2.Driver")
robot.append(goal)
env = Environment("empty", fastmode=True)
env.configure_stream_manager("ros2", domain_id={domain}, backend="rclpy")
"""

if has(sys.executable, "rclpy"):

    def test_a_node_has_goals(tmp_path: Path) -> None:
        (tmp_path / "driver_overlay2.py").write_text(OVERLAY)
        (tmp_path / "scene.py").write_text(SCENE.format(domain=DOMAIN))
        with morse.load(tmp_path / "scene.py", sockets=True) as sim:
            said = talk("action_peer.py", sim.step)
            assert sim.context.robots["robot"].position_3d.x > 1.0
        succeeded, canceled, aborted = 4, 5, 6  # action_msgs/GoalStatus
        assert said["reached"] == [True, succeeded, [1, 1, 2]]
        assert said["cancelled"] == [1, canceled]
        assert said["refused"] == aborted
        # the distance in mm, five times per second: 1.5 m at 2 m/s, with the tolerance of 0.5 m
        rest = said["feedback"]
        assert rest == sorted(rest, reverse=True)
        assert 3 <= len(rest) <= 5
        assert rest[0] > 1900
        assert [before - after for before, after in pairwise(rest)] == pytest.approx([400] * (len(rest) - 1), abs=35)
        assert said["feedback of others"] == 0
        assert said["halted"] == [True, "halted"]

else:

    @pytest.mark.timeout(200)
    @pytest.mark.peer("ros-jazzy-rclpy", does="a node sends goals of actions, gets feedback and results, cancels")
    def test_by_the_python_that_has_rclpy() -> None:
        need("rclpy", PYTHON)
        command = [PYTHON, "-m", "pytest", "-n0", "-q", "-p", "no:cacheprovider", "-k", "has_goals", __file__]
        done = subprocess.run(command, env=lent(), capture_output=True, text=True, timeout=180, check=False)
        assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-2000:]
        assert "1 passed" in done.stdout
