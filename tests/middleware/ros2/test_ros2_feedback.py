"""The feedback of actions, with the fields of nav2_msgs/NavigateToPose and control_msgs/FollowJointTrajectory."""

from typing import Any

import pytest

from morse.rosmsgs.actions import Feedback

#: of the definitions of these actions
NAVIGATE = {
    "current_pose": "geometry_msgs/PoseStamped",
    "navigation_time": "builtin_interfaces/Duration",
    "estimated_time_remaining": "builtin_interfaces/Duration",
    "number_of_recoveries": "int16",
    "distance_remaining": "float",
}
FOLLOW = {
    "header": "std_msgs/Header",
    "joint_names": "sequence<string>",
    "desired": "trajectory_msgs/JointTrajectoryPoint",
    "actual": "trajectory_msgs/JointTrajectoryPoint",
    "error": "trajectory_msgs/JointTrajectoryPoint",
}
SECOND = 10**9
SCENE = """
from morse.builder import *
robot = FakeRobot()
goal = Waypoint(); robot.append(goal)
turret = PTU(); robot.append(turret)
env = Environment("empty", fastmode=True)
"""


def feedback_of(loaded: Any, name: str, kinds: dict[str, str]) -> Feedback:
    return Feedback(loaded.context.components[name].interrupt, dict, kinds, lambda fields: fields)


def test_a_drive_is_described_by_pose_distance_and_times(loaded: Any) -> None:
    goal = loaded.context.components["robot.goal"]
    goal.setdest(3.0, 4.0, 0.0, 0.1, 2.0)
    begun = loaded.context.clock.stamp()
    told = feedback_of(loaded, "robot.goal", NAVIGATE).message(begun, begun + 1_250_000_000)
    assert told["distance_remaining"] == pytest.approx(5.0)
    assert told["estimated_time_remaining"] == {"sec": 2, "nanosec": 500_000_000}
    assert told["navigation_time"] == {"sec": 1, "nanosec": 250_000_000}
    assert told["current_pose"]["header"]["frame_id"] == "map"
    assert told["current_pose"]["pose"]["position"] == pytest.approx({"x": 0.0, "y": 0.0, "z": 0.0})
    assert "number_of_recoveries" not in told
    # at constant speed, as long as it has to turn first or drives straight, it does not go away
    loaded.step(180)
    later = feedback_of(loaded, "robot.goal", NAVIGATE).message(begun, loaded.context.clock.stamp())
    assert later["distance_remaining"] < 3.0
    assert later["navigation_time"] == {"sec": 3, "nanosec": 0}
    goal.stop()
    assert "estimated_time_remaining" not in feedback_of(loaded, "robot.goal", NAVIGATE).message(begun, begun)


def test_joints_are_described_by_values_setpoints_and_errors(loaded: Any) -> None:
    turret = loaded.context.components["robot.turret"]
    turret.local_data.update(pan=0.5, tilt=-0.25)
    told = feedback_of(loaded, "robot.turret", FOLLOW).message(0, 0)
    assert told["joint_names"] == ["pan", "tilt"]
    assert told["desired"] == {"positions": [0.5, -0.25]}
    actual, error = told["actual"]["positions"], told["error"]["positions"]
    assert [value + rest for value, rest in zip(actual, error, strict=True)] == pytest.approx([0.5, -0.25])


def test_an_action_without_known_fields_has_no_feedback(loaded: Any) -> None:
    assert feedback_of(loaded, "robot.goal", {"sequence": "sequence<int32>"}).message(0, SECOND) is None


def test_feedback_is_due_five_times_per_second_also_after_a_restart(loaded: Any) -> None:
    feedback = feedback_of(loaded, "robot.goal", NAVIGATE)
    due = [tick for tick in range(60) if feedback.is_due(tick * SECOND // 60)]
    assert len(due) == 5
    assert feedback.is_due(0)


def test_a_mistake_of_a_component_is_named(loaded: Any, caplog: pytest.LogCaptureFixture) -> None:
    goal = loaded.context.components["robot.goal"]
    goal.progress = lambda: 1 / 0
    assert feedback_of(loaded, "robot.goal", NAVIGATE).message(0, 0) is None
    del goal.progress
    assert "the feedback of robot.goal failed: ZeroDivisionError: division by zero" in caplog.text
