"""A node that receives the messages of classes of the user, steers the robot and moves its arm."""

from __future__ import annotations

import json
import time
from typing import Any

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from control_msgs.msg import (
    FollowJointTrajectoryAction,
    FollowJointTrajectoryGoal,
    JointTrajectory,
    JointTrajectoryAction,
    JointTrajectoryGoal,
    JointTrajectoryPoint,
)
from geometry_msgs.msg import PointStamped, Twist
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

_LIMIT = 60.0
_GOAL = [0.3, -0.2, 0.1, 0.4, 0.0, 0.2, -0.3]
_JOINTS = [f"kuka_{number}" for number in range(1, 8)]


def follow() -> dict[str, Any]:
    """Command one joint of the second arm by the action and by the topic of controllers of ros_control."""
    client = actionlib.SimpleActionClient("/robot/second/follow_joint_trajectory", FollowJointTrajectoryAction)
    while not client.wait_for_server(rospy.Duration(1.0)):
        pass
    states: list[JointState] = []
    rospy.Subscriber("/robot/second/stand", JointState, states.append)
    topic = rospy.Publisher("/robot/second/joint_trajectory", JointTrajectory, queue_size=1)
    end = time.monotonic() + _LIMIT
    while time.monotonic() < end and not (states and topic.get_num_connections()):
        time.sleep(0.01)
    joint = states[-1].name[1]
    told: list[tuple[list[str], float]] = []

    def tell(feedback: Any) -> None:
        told.append((list(feedback.joint_names), feedback.desired.positions[0]))

    def path(name: str, position: float, seconds: float) -> JointTrajectory:
        point = JointTrajectoryPoint()
        point.positions, point.time_from_start = [position], rospy.Duration(seconds)
        return JointTrajectory(joint_names=[name], points=[point])

    def go(name: str, position: float, seconds: float) -> list[int]:
        goal = FollowJointTrajectoryGoal(trajectory=path(name, position, seconds))
        client.send_goal(goal, feedback_cb=tell)
        end = time.monotonic() + _LIMIT
        ended = (GoalStatus.SUCCEEDED, GoalStatus.PREEMPTED, GoalStatus.ABORTED, GoalStatus.REJECTED)
        while time.monotonic() < end and (client.get_state() not in ended or client.get_result() is None):
            time.sleep(0.01)
        return [client.get_state(), client.get_result().error_code]

    def reached(position: float) -> float:
        end = time.monotonic() + _LIMIT
        while time.monotonic() < end and abs(states[-1].position[1] - position) > 1e-4:
            time.sleep(0.01)
        return float(states[-1].position[1])

    answers: dict[str, Any] = {"follow": go(joint, 0.5, 1.0), "follow end": reached(0.5), "follow feedback": told[:]}
    answers["follow unknown"] = go("elbow", 0.5, 1.0)
    topic.publish(path(joint, 0.4, 0.5))
    return {**answers, "topic": reached(0.4)}


def main() -> None:
    rospy.init_node("peer", disable_signals=True)
    marked: list[PointStamped] = []
    mast: list[PointStamped] = []
    states: list[JointState] = []
    frames: dict[str, Any] = {}

    def keep(message: TFMessage) -> None:
        for one in message.transforms:
            place, turn = one.transform.translation, one.transform.rotation
            numbers = [[place.x, place.y, place.z], [turn.x, turn.y, turn.z, turn.w]]
            frames[f"{one.header.frame_id} {one.child_frame_id}"] = numbers

    rospy.Subscriber("/robot/pose", PointStamped, marked.append)
    rospy.Subscriber("/mast/place", PointStamped, mast.append)
    rospy.Subscriber("/robot/arm/posture", JointState, states.append)
    rospy.Subscriber("/tf", TFMessage, keep)
    rospy.Subscriber("/robot/broken", String, lambda message: None)
    wheel = rospy.Publisher("/wheel", Twist, queue_size=1)
    forward = Twist()
    forward.linear.x = 0.2
    end = time.monotonic() + _LIMIT
    while time.monotonic() < end and not (marked and marked[-1].point.x > 4.0 and mast and states and len(frames) > 1):
        wheel.publish(forward)
        time.sleep(0.01)
    first = next(one for one in marked if one.point.x > 3.3)
    last = marked[-1]
    speed = (last.point.x - first.point.x) / (last.header.stamp - first.header.stamp).to_sec()
    wheel.publish(Twist())

    ended = (GoalStatus.SUCCEEDED, GoalStatus.PREEMPTED, GoalStatus.ABORTED, GoalStatus.REJECTED)
    client = actionlib.SimpleActionClient("/robot/arm/joint_trajectory_action", JointTrajectoryAction)
    # rospy measures timeouts by /clock, which may be faster than the wall clock
    while not client.wait_for_server(rospy.Duration(1.0)):
        pass

    def go(joints: list[str], positions: list[float]) -> int:
        goal = JointTrajectoryGoal()
        goal.trajectory.joint_names = joints
        point = JointTrajectoryPoint()
        point.positions, point.time_from_start = positions, rospy.Duration(1.0)
        goal.trajectory.points = [point]
        client.send_goal(goal)
        end = time.monotonic() + _LIMIT
        while time.monotonic() < end and client.get_state() not in ended:
            time.sleep(0.01)
        return int(client.get_state())

    # in another order than that of the arm
    state = go(_JOINTS[::-1], _GOAL[::-1])
    seen = len(states)
    while time.monotonic() < end and len(states) < seen + 5:
        time.sleep(0.01)
    refused = go(["elbow"], [0.1]), client.get_goal_status_text()
    followed = follow()
    print(
        json.dumps(
            {
                **followed,
                "marked": [last.header.frame_id, last.point.x, last.point.z],
                "stamp": last.header.stamp.to_sec(),
                "mast frame": mast[-1].header.frame_id,
                "tf": frames,
                "speed": speed,
                "arm": {
                    "state": state,
                    "positions": list(states[-1].position),
                    "parameter": rospy.get_param("/robot/arm/joints", rospy.get_param("robot_arm/joints", [])),
                },
                "refused": refused,
            }
        )
    )


if __name__ == "__main__":
    main()
