"""The description of ROS 1, and its options."""

from __future__ import annotations

from morse.core.declarations import Option
from morse.middleware.registry import Middleware
from morse.rosmsgs.names import STREAM_OPTIONS as ROS2_OPTIONS

INSTALL = "sudo apt install python3-rospy python3-rosmaster python3-sensor-msgs python3-nav-msgs python3-tf2-msgs"
MEND = (
    f"To install ROS 1: {INSTALL}; a virtual environment needs python3 -m venv --system-site-packages. Without ROS 1: "
    "add_stream('ros2') for ROS 2, or add_stream('rosbridge') for clients of rosbridge, such as roslibpy"
)

MANAGER_OPTIONS = {
    "frames": Option(str, "1.4", "names of frames: those of MORSE 1.4, or by REP 105", choices=("1.4", "rep105")),
    "clock": Option(bool, True, "publish simulated time as /clock"),
    "tf": Option(bool, True, "publish /tf and /tf_static"),
    "tf_rate": Option(float, None, "messages on /tf per simulated second; default: one in each tick", low=0.1),
    "rosout": Option(bool, True, "publish the log of the simulation as /rosout"),
    "localization": Option(bool, False, "by REP 105: another node publishes the transform from map to odom"),
    "namespace": Option(str, None, "namespace of all topics, replaces the name of the robot; empty for none"),
    "frame_prefix": Option(str, None, "by REP 105: prefix of the names of frames, replaces the name of the robot"),
}
STREAM_OPTIONS = {
    **{name: option for name, option in ROS2_OPTIONS.items() if name != "qos"},
    "parent_frame_id": Option(str, None, "parent frame of a camera, as named by 1.4: /base_link by default"),
    "pub_tf": Option(bool, True, "publish the transform of a camera"),
    "infinite": Option(bool, False, "rays that hit nothing have an infinite range, not the maximum one"),
    "topic_suffix": Option(str, None, "name of the topic of images, replaces /image"),
}

MIDDLEWARE = Middleware(
    name="ros",
    stream_manager="morse.middleware.ros_datastream.ROSDatastreamManager",
    request_manager="morse.middleware.ros_request_manager.RosRequestManager",
    manager_options=MANAGER_OPTIONS,
    stream_options=STREAM_OPTIONS,
    default_publisher="morse.plugins.ros.stream.RosStream",
    default_reader="morse.plugins.ros.stream.RosStream",
    not_carried=("StereoUnit", "MocapControl"),
    takes_old_names=True,
    modules=("rosgraph", "rospy"),
    mend=MEND,
    install=INSTALL,
    purpose="topics, services and actions of ROS 1",
    names_topics_as_ros=True,
    imports=("roslib", "rosbag", "roslaunch", "tf", "actionlib", "move_base_msgs", "std_srvs"),
)
