"""Topics and services for clients of rosbridge: JSON over WebSocket."""

from __future__ import annotations

from morse.middleware.registry import Middleware
from morse.middleware.ros2 import MIDDLEWARE as ROS2
from morse.middleware.web import TOPIC_OPTIONS, server_options

PORT = 9090
SERVER_OPTIONS = server_options(PORT)
MANAGER_OPTIONS = {**SERVER_OPTIONS, **TOPIC_OPTIONS}

MIDDLEWARE = Middleware(
    name="rosbridge",
    stream_manager="morse.middleware.rosbridge.datastream.RosbridgeDatastreamManager",
    request_manager="morse.middleware.rosbridge.datastream.RosbridgeRequestManager",
    manager_options=MANAGER_OPTIONS,
    stream_options=ROS2.stream_options,
    default_publisher=ROS2.default_publisher,
    default_reader=ROS2.default_reader,
    names_topics_as_ros=True,
    not_carried=ROS2.not_carried,
)
