"""Plugins for drives, and for what they measure."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.gazebo.topics import topic_of
from morse.assets.gazebo.values import ValueMistakeError, boolean, number

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from morse.assets.gazebo.converted import Plugins, Properties

_LEFT = ("left_joint", "leftJoint", "leftFrontJoint", "leftRearJoint", "leftMidJoint", "left_wheel_joint")
_RIGHT = ("right_joint", "rightJoint", "rightFrontJoint", "rightRearJoint", "rightMidJoint", "right_wheel_joint")
_COMMANDS = ("topic", "command_topic", "commandTopic", "topicName")
_ODOMETRY = ("odom_topic", "odometry_topic", "odometryTopic")
#: whether the odometry is a transform
_TRANSFORM = ("publish_odom_tf", "publishOdomTF", "publishTf", "broadcastTF", "publish_tf")
#: properties of speeds, and the elements that may contain them
_LIMITS = {
    "MaxSpeed": ("max_linear_velocity", "max_speed"),
    "MaxAngularSpeed": ("max_angular_velocity",),
    "MaxAcceleration": ("max_linear_acceleration",),
    "MaxAngularAcceleration": ("max_angular_acceleration",),
}


def diff_drive(plugins: Plugins, element: Element, prefix: str) -> None:
    """Wheels on the left and on the right."""
    properties: Properties = {
        "LeftWheels": plugins.named(element, prefix, *_LEFT),
        "RightWheels": plugins.named(element, prefix, *_RIGHT),
        "WheelRadius": _radius(element),
        "WheelSeparation": _first(element, "wheel_separation", "wheelSeparation"),
    }
    if not (properties["LeftWheels"] and properties["RightWheels"]):
        raise ValueMistakeError("it names no joints")
    torque = _first(element, "max_wheel_torque", "wheelTorque", "torque")
    if torque > 0.0:
        plugins.torques |= dict.fromkeys(plugins.driven, torque)
    _drive(plugins, element, "MotionVWDiff", properties)


def ackermann(plugins: Plugins, element: Element, prefix: str) -> None:
    """Two wheels that steer, two that drive."""
    properties: Properties = {
        "LeftWheels": plugins.named(element, prefix, "left_joint", "rear_left_joint"),
        "RightWheels": plugins.named(element, prefix, "right_joint", "rear_right_joint"),
        "LeftSteering": plugins.named(element, prefix, "left_steering_joint"),
        "RightSteering": plugins.named(element, prefix, "right_steering_joint"),
        "WheelRadius": _radius(element),
        "WheelBase": _first(element, "wheel_base"),
        "WheelSeparation": _first(element, "wheel_separation"),
        "SteeringLimit": min(max(_first(element, "steering_limit", "max_steer") or 0.5, 1e-3), 1.5),
    }
    if not all(properties[name] for name in list(properties)[:4]):
        raise ValueMistakeError("it names no joints")
    _drive(plugins, element, "MotionVWAckermann", properties)


def any_direction(plugins: Plugins, element: Element, prefix: str) -> None:
    """A body that is moved, and whose wheels roll freely."""
    del prefix
    _drive(plugins, element, "MotionXYW", {})


def odometry(plugins: Plugins, element: Element, prefix: str) -> None:
    """The pose relative to the start."""
    del prefix
    if not boolean(element, "publish_odom", True):
        return
    is_transform = all(boolean(element, tag, True) for tag in _TRANSFORM)
    rate = _first(element, "odom_publish_frequency", "publish_rate", "update_rate", "updateRate", "odometryRate")
    plugins.measure("odom", "Odometry", {"topic": topic_of(element, "odom", *_ODOMETRY), "tf": is_transform}, rate)


def joint_states(plugins: Plugins, element: Element, prefix: str) -> None:
    """The positions of the joints."""
    del prefix
    options: dict[str, str | bool] = {"topic": topic_of(element, "joint_states", "topic")}
    plugins.measure("joint_states", "ArmaturePose", options, _first(element, "update_rate", "updateRate"), joints=True)


def _drive(plugins: Plugins, element: Element, product: str, properties: Properties) -> None:
    limits = {name: _first(element, *tags) for name, tags in _LIMITS.items()}
    properties |= {name: limit for name, limit in limits.items() if limit > 0.0}
    plugins.add("motion", product, properties, options={"topic": topic_of(element, "cmd_vel", *_COMMANDS)})
    odometry(plugins, element, "")


def _radius(element: Element) -> float:
    """The radius of the wheels, m; 0 if the file does not contain it."""
    return number(element, "wheel_radius", 0.5 * _first(element, "wheel_diameter", "wheelDiameter"))


def _first(element: Element, *tags: str) -> float:
    """The first of some numbers, or 0."""
    return next((value for tag in tags if (value := number(element, tag, 0.0))), 0.0)
