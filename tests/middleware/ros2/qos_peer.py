"""The peer: a node that starts late, with subscriptions of all qualities of service; prints what each has got."""

from __future__ import annotations

import json
import os
import sys
import time

os.environ["ROS_DOMAIN_ID"] = sys.argv[1]

import rclpy
from nav_msgs.msg import Odometry
from rclpy.qos import (
    DurabilityPolicy,
    QoSProfile,
    ReliabilityPolicy,
    qos_profile_sensor_data,
    qos_profile_system_default,
)
from sensor_msgs.msg import Image
from std_msgs.msg import String

BEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
WANTED = {
    "default": (Odometry, "/robot/odometry", 10),
    "system": (Odometry, "/robot/odometry", qos_profile_system_default),
    "sensor": (Odometry, "/robot/odometry", qos_profile_sensor_data),
    "best effort": (Odometry, "/robot/odometry", BEST),
    "image": (Image, "/robot/eye/image", 10),
    "image, sensor": (Image, "/robot/eye/image", qos_profile_sensor_data),
    "description": (String, "/robot/robot_description", LATCHED),
    "named": (Odometry, "odometry", 10),
}
seen: dict[str, int] = dict.fromkeys(WANTED, 0)


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("late", namespace="robot")

    def counter(name: str):  # type: ignore[no-untyped-def] # a function of the peer
        def count(_message: object) -> None:
            seen[name] += 1

        return count

    for name, (kind, topic, qos) in WANTED.items():
        node.create_subscription(kind, topic, counter(name), qos)
    end = time.monotonic() + 60.0
    while time.monotonic() < end and not all(seen.values()):
        rclpy.spin_once(node, timeout_sec=0.05)
    print(json.dumps(seen))


main()
