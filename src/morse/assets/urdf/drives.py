"""What plugins, ``ros2_control`` and transmissions of a URDF file stand for."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from morse.assets.gazebo.plugins import Plugins, prepare_motors, read_plugins
from morse.assets.gazebo.values import color_of, friction_of, text_of
from morse.mathutils.portable import linear_color
from morse.scene import Control

if TYPE_CHECKING:
    from collections.abc import Iterator
    from xml.etree.ElementTree import Element

    from morse.assets.description import Link, RobotDescription

#: settings of the physics without a counterpart
_LEFT_OUT = (
    *("dampingFactor", "initial_joint_position", "kd", "kp", "maxVel", "minDepth", "selfCollide", "self_collide"),
    *("springStiffness", "stopKd", "stopKp", "turnGravityOff"),
)
#: values that mean nothing
_PLAIN = ("", "0", "0.0", "false", "False")


def read_references(robot: Element, document: RobotDescription) -> None:
    """Set the friction and the colours of links, and name what is left out."""
    left_out: set[str] = set()
    for gazebo in robot.findall("gazebo"):
        left_out |= {tag for tag in _LEFT_OUT if text_of(gazebo, tag) not in _PLAIN}
        link = document.links.get(gazebo.get("reference", ""))
        if link is None:
            continue
        friction, across = friction_of(gazebo, ("mu1", "mu")), friction_of(gazebo, ("mu2",))
        link.friction = link.friction if friction is None else friction
        if across is not None and across != friction:
            left_out.add("mu2")
        _paint(link, text_of(gazebo, "material"))
    if left_out:
        words = ", ".join(sorted(left_out, key=str.lower))
        document.warnings.append(f"settings of Gazebo that MORSE does not have are left out: {words}")


def _paint(link: Link, material: str) -> None:
    """Give shapes without a colour that of a material of Gazebo; meshes have colours of their own."""
    color = color_of(material)
    for shape in link.visuals:
        if color is not None and shape.color is None and shape.kind != "mesh":
            shape.color = linear_color((*color, 1.0))


#: what a motor controls, by a word in the interface of ros2_control, or of a transmission of ROS 1. The controllers of
#: interfaces for efforts hold positions, too
_CONTROLS = {"position": Control.POSITION, "effort": Control.POSITION, "velocity": Control.VELOCITY}


def add_plugins(robot: Element, document: RobotDescription) -> None:
    """Add actuators and sensors to a robot, and set the control modes of its motors."""
    joints = {joint.name: joint for joint in document.joints}
    read_references(robot, document)
    turning = set()
    for name, control in [*_transmissions(robot), *_interfaces(robot)]:
        joint = joints.get(name)
        if joint is None:
            document.warnings.append(f"the interface of the joint '{name:.60}' is left out: there is no such joint")
        elif joint.has_value:
            joint.dynamics = replace(joint.dynamics, control=control)
            if control is Control.VELOCITY and not joint.dynamics.limited:
                turning.add(name)
    # the link that carries the others comes first
    links = sorted(document.links, key=lambda name: name != document.root)
    plugins = Plugins(joints, links, "", document.name, document.warnings.append)
    read_plugins(plugins, ((element, "") for gazebo in robot.findall("gazebo") for element in gazebo.findall("plugin")))
    if len(turning) > 1 and not plugins.actuators:
        # the controller that drives them is not in the file
        plugins.add("motion", "MotionVWDiff", {}, options={"topic": "cmd_vel"})
        plugins.measure("odom", "Odometry", {"topic": "odom"}, 50.0)
    prepare_motors(document, plugins)
    document.actuators += plugins.actuators
    document.sensors += plugins.sensors


def _transmissions(robot: Element) -> Iterator[tuple[str, Control]]:
    for element in robot.findall("transmission"):
        for joint in element.findall("joint"):
            words = [child.text or "" for child in element.iter("hardwareInterface")]
            control = next((_CONTROLS[key] for word in words for key in _CONTROLS if key in word.lower()), None)
            if control is not None:
                yield joint.get("name", ""), control


def _interfaces(robot: Element) -> Iterator[tuple[str, Control]]:
    for element in robot.findall("ros2_control"):
        for joint in element.findall("joint"):
            names = [one.get("name", "") for one in joint.findall("command_interface")]
            control = next((_CONTROLS[key] for key in _CONTROLS if key in names), None)
            if control is not None:
                yield joint.get("name", ""), control
