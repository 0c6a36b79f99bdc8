"""The sensors whose messages a capture can encode."""

from __future__ import annotations

from typing import Any

from morse.sensors.laserscanner import LaserScanner
from morse.sensors.pose import Pose

#: the type of the message by the class of the sensor; subclasses may measure in another way
MESSAGES: dict[Any, str] = {Pose: "geometry_msgs/msg/PoseStamped", LaserScanner: "sensor_msgs/msg/LaserScan"}


def is_captured(component: Any) -> bool:
    """Whether there is a capture for the messages of sensors of its class."""
    return type(component) in MESSAGES
