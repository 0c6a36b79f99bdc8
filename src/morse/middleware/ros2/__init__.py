"""Components as ROS 2 topics, with rclpy, or with Cyclone DDS without a ROS installation."""

from __future__ import annotations

from morse.core.declarations import Option
from morse.middleware.registry import Middleware
from morse.rosmsgs.names import ROS2_MANAGER, STREAM_OPTIONS, TOPIC_OPTIONS

BACKENDS = ("rclpy", "cyclonedds")
#: the largest domain with ports below 65536
LAST_DOMAIN = 232
#: the name of the simulation in the graph of ROS
NODE = "morse"
INSTALL_ROS = "sudo apt install ros-jazzy-ros-base && source /opt/ros/jazzy/setup.bash"

MANAGER_OPTIONS = {
    "backend": Option(str, None, "library for the topics; default: rclpy if it can be imported", choices=BACKENDS),
    "domain_id": Option(int, None, "ROS domain; default: ROS_DOMAIN_ID, or 0", low=0, high=LAST_DOMAIN),
    "interface": Option(str, "lo", "network interface or its address; any: all interfaces"),
    "diagnostics": Option(bool, True, "publish the state of all components as /diagnostics"),
    **TOPIC_OPTIONS,
}

MIDDLEWARE = Middleware(
    name="ros2",
    stream_manager=ROS2_MANAGER,
    request_manager="morse.middleware.ros2.request_manager.Ros2RequestManager",
    manager_options=MANAGER_OPTIONS,
    stream_options=STREAM_OPTIONS,
    default_publisher="morse.rosmsgs.topics.stream.TopicStream",
    default_reader="morse.rosmsgs.topics.stream.TopicStream",
    names_topics_as_ros=True,
    not_carried=("StereoUnit", "MocapControl"),
)
