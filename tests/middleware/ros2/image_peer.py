"""The peer: a reliable reader of images. It prints the number and the size of each image."""

from __future__ import annotations

import os
import sys

os.environ["ROS_DOMAIN_ID"] = sys.argv[1]

import rclpy
from sensor_msgs.msg import Image


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("watcher")
    node.create_subscription(Image, "/eye/image", lambda m: print(m.header.stamp.sec, len(m.data), flush=True), 10)
    while True:
        rclpy.spin_once(node, timeout_sec=0.05)


main()
