"""Topics and services for Foxglove, over its WebSocket protocol."""

from __future__ import annotations

from morse.middleware.registry import Middleware
from morse.middleware.ros2 import MIDDLEWARE as ROS2
from morse.middleware.web import TOPIC_OPTIONS, server_options

#: 8765, the default of Foxglove, is the port of the live view
PORT = 8766
MANAGER_OPTIONS = {**server_options(PORT), **TOPIC_OPTIONS}

MIDDLEWARE = Middleware(
    name="foxglove",
    stream_manager="morse.middleware.foxglove.datastream.FoxgloveDatastreamManager",
    request_manager="morse.middleware.foxglove.datastream.FoxgloveRequestManager",
    manager_options=MANAGER_OPTIONS,
    stream_options=ROS2.stream_options,
    default_publisher=ROS2.default_publisher,
    default_reader=ROS2.default_reader,
    not_carried=ROS2.not_carried,
)
