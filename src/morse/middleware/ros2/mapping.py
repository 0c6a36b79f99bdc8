"""The mapping of ROS 2, and its options."""

from __future__ import annotations

from morse.core.declarations import Option
from morse.middleware.registry import Middleware

#: encodings of images that an option can select
_ENCODINGS = ("rgb8", "rgba8", "bgr8", "bgra8", "mono8")
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
    "topic": Option(str, None, "name of the topic; without a leading slash: below the namespace"),
    "namespace": Option(str, None, "namespace of the topics of this stream"),
    "frame_id": Option(str, None, "frame of the messages"),
    "child_frame_id": Option(str, None, "for odometry: frame of the robot"),
    "stamped": Option(bool, False, "for velocity commands: TwistStamped instead of Twist"),
    "qos": Option(str, "default", "sensor: best effort", choices=("default", "sensor")),
    "fields": Option(bool, False, "every data field that is in no message gets its own topic"),
    "tf": Option(bool, True, "for odometry: publish the transform from odom to base_link"),
    "encoding": Option(str, None, "of images with colours; default: that of the camera", choices=_ENCODINGS),
    "depth16": Option(bool, False, "depth images in whole millimetres, 16UC1; 0 where there is no depth"),
    "points": Option(bool, False, "for laser scanners: a cloud on points, too"),
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
