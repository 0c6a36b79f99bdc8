"""Services and actions with their own types, declared as in MORSE 1.4."""

import json
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from master import master, need_ros, run, simulation

HERE = Path(__file__).parent
OVERLAY = """
from actionlib.msg import TestAction, TestResult
from move_base_msgs.msg import MoveBaseAction
from std_srvs.srv import SetBool, Trigger

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

    @ros_service(type=Trigger)
    def fail(self):
        raise ValueError("a mistake of the user")

    @interruptible
    @ros_action(type=MoveBaseAction)
    def drive(self, goal):
        place = goal.target_pose.pose.position
        self.overlaid_object.goto(self.chain_callback(), place.x, place.y, place.z)

    def wrong(self):
        return "half way"

    @interruptible
    @ros_action(type=TestAction, feedback="wrong")
    def go(self, goal):
        if goal.goal < 0:
            raise ValueError("not that way")
        self.overlaid_object.goto(self.chain_callback(self.arrived), float(goal.goal), 0.0, 0.0)

    def arrived(self, outcome):
        status, _ = outcome
        return status, TestResult(result=42)
"""
SCENE = """
from morse.builder import *
robot = ATRV()
goal = Waypoint("goal")
goal.add_overlay("ros", "driver_overlay.Driver")
goal.add_overlay("ros", "morse.middleware.ros.overlays.waypoints.WayPoint")
robot.append(goal)
env = Environment("empty", fastmode=True)
"""


@pytest.fixture(scope="module")
def said(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    need_ros()
    folder = tmp_path_factory.mktemp("ros1_actions")
    (folder / "driver_overlay.py").write_text(OVERLAY)
    (folder / "scene.py").write_text(SCENE)
    with master() as uri, simulation(folder / "scene.py", uri) as log:
        answers = json.loads(run(HERE / "actions_peer.py", uri))
        yield {**answers, "log": log.read_text()}


@pytest.mark.peer("python3-rospy")
def test_a_goal_is_reached_and_has_a_result(said: Any) -> None:
    succeeded = 3
    assert said["reached"] == [succeeded, 42]


@pytest.mark.peer("python3-rospy")
def test_the_overlay_of_1_4_takes_goals_of_the_navigation_stack(said: Any) -> None:
    succeeded = 3
    assert said["move_base"] == succeeded


@pytest.mark.peer("python3-rospy")
def test_a_goal_that_is_cancelled_ends_as_preempted(said: Any) -> None:
    preempted = 2
    assert said["cancelled"] == preempted


def test_a_goal_that_fails_ends_as_aborted_with_the_reason(said: Any) -> None:
    aborted = 4
    assert said["refused"][0] == aborted
    assert "not that way" in said["refused"][1]


@pytest.mark.peer("python3-rospy")
def test_services_with_types_of_their_own(said: Any) -> None:
    assert said["halt"] == [True, "halted"]
    assert "a mistake of the user" in said["failure"]
    assert "the service fail of driver failed: ValueError" in said["log"]


def test_feedback_has_the_pose_of_the_robot_that_drives(said: Any) -> None:
    # by default, of the fields of MoveBaseFeedback: two metres, told five times per simulated second
    frames, places = {frame for frame, _ in said["feedback"]}, [x for _, x in said["feedback"]]
    assert frames == {"map"}
    assert places == sorted(places)
    assert len(places) >= 5
    assert max(after - before for before, after in pairwise(places)) == pytest.approx(0.2, abs=0.02)


def test_feedback_of_another_type_is_named_and_not_sent(said: Any) -> None:
    assert "the feedback of driver failed: TypeError: wrong returned a str, expected a TestFeedback" in said["log"]


def test_status_is_told_again_and_again(said: Any) -> None:
    assert said["statuses"] > 3
