"""The mapping of ROS 2, and its options."""

from __future__ import annotations

from morse.core.declarations import Option
from morse.middleware.registry import Middleware
from morse.rosmsgs.options import MESSAGE_OPTIONS

BACKENDS = ("rclpy", "cyclonedds")
#: the largest domain with ports below 65536
LAST_DOMAIN = 232
INSTALL = "pip install 'morse-simulator[ros2]'"

MANAGER_OPTIONS = {
    "backend": Option(str, None, "library for the topics; default: rclpy if it can be imported", choices=BACKENDS),
    "domain_id": Option(int, None, "ROS domain; default: ROS_DOMAIN_ID, or 0", low=0, high=LAST_DOMAIN),
    "interface": Option(str, "lo", "network interface or its address; any: all interfaces"),
    "clock": Option(bool, True, "publish simulated time as /clock"),
    "tf": Option(bool, True, "publish /tf and /tf_static"),
    "tf_rate": Option(float, None, "messages on /tf per simulated second; default: one in each tick", low=0.1),
    "description": Option(bool, True, "publish robot_description, a URDF, for each robot"),
    "rosout": Option(bool, True, "publish the log of the simulation as /rosout"),
    "localization": Option(bool, False, "another node publishes the transform from map to odom"),
    "namespace": Option(str, None, "namespace of all topics, replaces the name of the robot; empty for none"),
    "frame_prefix": Option(str, None, "prefix of the names of frames, replaces the name of the robot and a slash"),
}
STREAM_OPTIONS = {
    **MESSAGE_OPTIONS,
    "qos": Option(str, "default", "sensor: best effort", choices=("default", "sensor")),
}

MIDDLEWARE = Middleware(
    name="ros2",
    stream_manager="morse.middleware.ros2.datastream.Ros2DatastreamManager",
    request_manager="morse.middleware.ros2.request_manager.Ros2RequestManager",
    manager_options=MANAGER_OPTIONS,
    stream_options=STREAM_OPTIONS,
    default_publisher="morse.middleware.ros2.stream.Ros2Stream",
    default_reader="morse.middleware.ros2.stream.Ros2Stream",
    not_carried=("StereoUnit", "MocapControl"),
)
