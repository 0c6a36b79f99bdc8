"""What plugins, ``ros2_control`` and transmissions of a URDF file stand for."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from morse.assets.gazebo.converted import Plugins
from morse.assets.gazebo.motors import prepare_motors
from morse.assets.gazebo.plugins import read_plugins
from morse.assets.urdf.references import read_references
from morse.scene import Control

if TYPE_CHECKING:
    from collections.abc import Iterator
    from xml.etree.ElementTree import Element

    from morse.assets.urdf.structure import Document

#: what a motor controls, by a word in the interface of ros2_control, or of a transmission of ROS 1. The controllers of
#: interfaces for efforts hold positions, too
_CONTROLS = {"position": Control.POSITION, "effort": Control.POSITION, "velocity": Control.VELOCITY}


def add_plugins(robot: Element, document: Document) -> None:
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
