"""The peer: a ROS 2 node in a separate process. It prints the received data as JSON."""

from __future__ import annotations

import json
import os
import sys
import time
from typing import Any

os.environ["ROS_DOMAIN_ID"] = sys.argv[1]

import rclpy
from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import Odometry
from rclpy.qos import qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan

_LIMIT = 90.0


def plain(value: Any) -> Any:
    if hasattr(value, "get_fields_and_field_types"):
        return {name: plain(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if hasattr(value, "tolist"):
        return value.tolist()
    return [plain(v) for v in value] if isinstance(value, (list, tuple)) else value


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("peer")
    got: dict[str, list[Any]] = {}
    for topic, kind, qos in (
        ("/robot/pose", PoseStamped, 10),
        ("/robot/odometry", Odometry, 10),
        ("/robot/scan", LaserScan, qos_profile_sensor_data),
        ("/clock", Clock, qos_profile_sensor_data),
    ):
        messages = got.setdefault(topic, [])
        node.create_subscription(kind, topic, messages.append, qos)
    drive = node.create_publisher(Twist, "/robot/cmd_vel", 10)
    command = Twist()
    command.linear.x = 0.5
    end = time.monotonic() + _LIMIT
    while time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.02)
        drive.publish(command)
        odometry = got["/robot/odometry"]
        if all(len(messages) > 5 for messages in got.values()) and odometry[-1].pose.pose.position.x > 0.3:
            break
    said = {
        "messages": {topic: plain(m[-6:]) for topic, m in got.items()},
        "types": dict(node.get_topic_names_and_types()),
        "publishers": [info.node_name for info in node.get_publishers_info_by_topic("/robot/pose")],
    }
    if ("morse", "/") in node.get_node_names_and_namespaces():
        said["published"] = dict(node.get_publisher_names_and_types_by_node("morse", "/"))
        said["subscribed"] = dict(node.get_subscriber_names_and_types_by_node("morse", "/"))
    print(json.dumps(said))
    node.destroy_node()
    rclpy.shutdown()


main()
