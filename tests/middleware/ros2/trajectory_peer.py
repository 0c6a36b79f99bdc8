"""The peer: a node of rclpy with a client of FollowJointTrajectory. It prints the outcomes of its goals as JSON."""

from __future__ import annotations

import json
import os
import sys
import time
from typing import Any

os.environ["ROS_DOMAIN_ID"] = sys.argv[1]

import rclpy
from control_msgs.action import FollowJointTrajectory
from control_msgs.msg import JointTolerance
from rclpy.action import ActionClient
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

_LIMIT = 90.0


def goal_of(points: list[tuple[float, list[float]]], joints: list[str], **more: Any) -> FollowJointTrajectory.Goal:
    path = JointTrajectory(joint_names=joints)
    for moment, positions in points:
        point = JointTrajectoryPoint(positions=positions)
        point.time_from_start.sec, point.time_from_start.nanosec = int(moment), round(moment % 1 * 1e9)
        path.points.append(point)
    return FollowJointTrajectory.Goal(trajectory=path, **more)


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("planner")
    client = ActionClient(node, FollowJointTrajectory, "/robot/arm/follow_joint_trajectory")
    end = time.monotonic() + _LIMIT

    def wait(future: Any) -> Any:
        while not future.done() and time.monotonic() < end:
            rclpy.spin_once(node, timeout_sec=0.05)
        assert future.done()
        return future.result()

    assert client.wait_for_server(_LIMIT)
    told: list[Any] = []
    said: dict[str, Any] = {}

    def follow(goal: Any, **more: Any) -> Any:
        handle = wait(client.send_goal_async(goal, **more))
        return handle, handle.get_result_async() if handle.accepted else None

    def ended(result: Any) -> list[Any]:
        answer = wait(result)
        return [answer.status, answer.result.error_code, answer.result.error_string]

    # two of the joints, in another order; the first point is the present one
    near = [JointTolerance(name=name, position=0.01) for name in ("shoulder", "elbow")]
    points = [(0.0, [0.0, 0.0]), (2.0, [0.5, -0.4])]
    goal = goal_of(points, ["elbow", "shoulder"], goal_tolerance=near)
    _, result = follow(goal, feedback_callback=lambda message: told.append(message.feedback))
    said["reached"] = ended(result)
    said["names"] = list(told[0].joint_names)
    said["feedback"] = [
        [list(one.desired.positions), list(one.actual.positions), list(one.error.positions)] for one in told
    ]
    said["velocities"] = [list(one.actual.velocities) for one in told]
    said["stamps"] = [one.header.stamp.sec + one.header.stamp.nanosec * 1e-9 for one in told]

    # a new goal preempts the active one, and is cancelled
    _, first = follow(goal_of([(20.0, [1.0])], ["shoulder"]))
    second, result = follow(goal_of([(20.0, [-1.0])], ["shoulder"]))
    said["preempted"] = ended(first)
    said["cancelling"] = len(wait(second.cancel_goal_async()).goals_canceling)
    said["cancelled"] = ended(result)

    # the wall keeps the arm from its path
    tight = [JointTolerance(name="shoulder", position=0.15)]
    said["blocked"] = ended(follow(goal_of([(1.0, [2.5])], ["shoulder"], path_tolerance=tight))[1])
    back = goal_of([(1.0, [0.0])], ["shoulder"])
    said["back"] = ended(follow(back)[1])
    late = goal_of([(1.0, [2.5])], ["shoulder"], goal_tolerance=tight)
    late.goal_time_tolerance.nanosec = 500_000_000
    said["late"] = ended(follow(late)[1])

    unknown = goal_of([(1.0, [0.5])], ["wrist"])
    backwards = goal_of([(1.0, [0.5]), (0.5, [0.1])], ["shoulder"])
    short = goal_of([(1.0, [])], ["shoulder"])
    empty = goal_of([], ["shoulder"])
    said["accepted"] = [follow(one)[0].accepted for one in (unknown, backwards, short, empty)]
    print(json.dumps(said))
    node.destroy_node()
    rclpy.shutdown()


main()
