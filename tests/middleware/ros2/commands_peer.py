"""The peer: a node of rclpy that drives with Twist, then with TwistStamped, and moves an arm along a trajectory."""

from __future__ import annotations

import json
import os
import sys
import time
from functools import partial
from typing import Any

os.environ["ROS_DOMAIN_ID"] = sys.argv[1]

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

_LIMIT = 40.0


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("commander")
    seen: dict[str, Any] = {"speed": 0.0, "joints": []}
    node.create_subscription(
        Odometry, "/robot/path", lambda m: seen.update(speed=m.twist.twist.linear.x), qos_profile_sensor_data
    )

    def noted(state: JointState) -> None:
        stamp = state.header.stamp.sec + state.header.stamp.nanosec * 1e-9
        seen["joints"].append((stamp, list(state.position)))
        seen["names"] = list(state.name)

    node.create_subscription(JointState, "/robot/joint_states", noted, 100)

    def wait(done: Any, act: Any = lambda: None) -> bool:
        end = time.monotonic() + _LIMIT
        while not done() and time.monotonic() < end:
            act()
            rclpy.spin_once(node, timeout_sec=0.02)
        return bool(done())

    said: dict[str, Any] = {"speeds": []}
    for kind, speed in ((Twist, 0.3), (TwistStamped, 0.6), (Twist, 0.9)):
        publisher = node.create_publisher(kind, "/robot/cmd_vel", 10)
        message = kind()
        (message.twist if kind is TwistStamped else message).linear.x = speed
        send = partial(publisher.publish, message)
        wait(lambda speed=speed: abs(seen["speed"] - speed) < 0.02, send)
        said["speeds"].append(seen["speed"])
        node.destroy_publisher(publisher)

    arm = node.create_publisher(JointTrajectory, "/robot/arm/joint_trajectory", 10)
    wait(lambda: arm.get_subscription_count() and seen["joints"])
    path = JointTrajectory(joint_names=["kuka_2"])
    for number, angle in ((1, 0.4), (3, -0.4)):
        point = JointTrajectoryPoint(positions=[angle])
        point.time_from_start.sec = number
        path.points.append(point)
    index = next(i for i, name in enumerate(seen["names"]) if name.endswith("kuka_2"))
    seen["joints"].clear()
    # the writer may know the reader before the reader knows the writer: what is sent once may be lost
    wait(lambda: seen["joints"] and seen["joints"][-1][1][index] > 0.005, lambda: arm.publish(path))
    wait(lambda: seen["joints"] and abs(seen["joints"][-1][1][index] + 0.4) < 0.005)
    said["joint"] = [(stamp, positions[index]) for stamp, positions in seen["joints"]]
    print(json.dumps(said))
    node.destroy_node()
    rclpy.shutdown()


main()
