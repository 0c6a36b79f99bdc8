"""The options of topics and messages."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.declarations import Option

if TYPE_CHECKING:
    from collections.abc import Mapping

#: encodings of images that an option can select
_ENCODINGS = ("rgb8", "rgba8", "bgr8", "bgra8", "mono8")

MESSAGE_OPTIONS: Mapping[str, Option] = {
    "topic": Option(str, None, "name of the topic; without a leading slash: below the namespace"),
    "namespace": Option(str, None, "namespace of the topics of this stream"),
    "frame_id": Option(str, None, "frame of the messages"),
    "child_frame_id": Option(str, None, "for odometry: frame of the robot"),
    "stamped": Option(bool, False, "for velocity commands: TwistStamped until somebody sends Twist"),
    "fields": Option(bool, False, "every data field that is in no message gets its own topic"),
    "tf": Option(bool, True, "for odometry: publish the transform from odom to base_link"),
    "encoding": Option(str, None, "of images with colours; default: that of the camera", choices=_ENCODINGS),
    "depth16": Option(bool, False, "depth images in whole millimetres, 16UC1; 0 where there is no depth"),
    "points": Option(bool, False, "for laser scanners: a cloud on points, too"),
}
#: options of ``add_stream``
STREAM_OPTIONS: Mapping[str, Option] = {
    **MESSAGE_OPTIONS,
    "qos": Option(str, "default", "sensor: best effort", choices=("default", "sensor")),
}
#: options of the topics of a simulation
TOPIC_OPTIONS: Mapping[str, Option] = {
    "clock": Option(bool, True, "publish simulated time as /clock"),
    "tf": Option(bool, True, "publish /tf and /tf_static"),
    "tf_rate": Option(float, None, "messages on /tf per simulated second; default: one in each tick", low=0.1),
    "description": Option(bool, True, "publish robot_description, a URDF, for each robot"),
    "rosout": Option(bool, True, "publish the log of the simulation as /rosout"),
    "localization": Option(bool, False, "another node publishes the transform from map to odom"),
    "namespace": Option(str, None, "namespace of all topics, replaces the name of the robot; empty for none"),
    "remap": Option((str, dict), None, "YAML file, or topics to new names or to topic, reliability, durability, depth"),
    "frame_prefix": Option(str, None, "prefix of the names of frames, replaces the name of the robot and a slash"),
}
#: class path of the manager of ROS 2, whose topics recordings have as well
ROS2_MANAGER = "morse.middleware.ros2.datastream.Ros2DatastreamManager"
