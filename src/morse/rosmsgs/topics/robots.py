"""Topics of whole robots: ``joint_states`` and ``robot_description``."""

from __future__ import annotations

import logging
import math
from functools import partial
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np

from morse.rosmsgs.moving import joints_of, name_of
from morse.rosmsgs.parts import time
from morse.rosmsgs.table import Qos
from morse.rosmsgs.urdf import Carried, add_fixed, describe

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from morse.core.kinds import BoundKind, Message
    from morse.core.robot import Robot
    from morse.core.values import RosMessage
    from morse.rosmsgs.component import ComponentMessages
    from morse.rosmsgs.moving import Joint
    from morse.rosmsgs.topics.backend import Publisher
    from morse.rosmsgs.topics.manager import TopicManager


def describe_file(
    text: str, base: str, rename: Callable[[str], str], joints: list[Joint], components: Mapping[str, Carried]
) -> str:
    """The text of a URDF file with the names of frames as links.

    Args:
        text: of the file.
        base: frame of the robot.
        rename: the frame of a link.
        joints: joints of the robot, parents first.
        components: its components by frame.
    """
    model = ElementTree.fromstring(text)
    for element, attribute in _links(model):
        element.set(attribute, rename(element.get(attribute, "")))
    links = {element.get("name", "") for element in model.findall("link")}
    if base not in links:
        ElementTree.SubElement(model, "link", name=base)
    names = links | {base}
    for joint in joints:
        if joint.frame not in names or (joint.parent == base and base not in links):
            if joint.frame not in names:
                ElementTree.SubElement(model, "link", name=joint.frame)
            add_fixed(model, joint.name, joint.parent, joint.frame, joint.pose(), moves=not joint.is_fixed)
            names.add(joint.frame)
    for frame, one in components.items():
        if frame not in names:
            ElementTree.SubElement(model, "link", name=frame)
            add_fixed(model, f"{frame}_joint", base, frame, one.pose, moves=one.moves)
    return ElementTree.tostring(model, encoding="unicode")


def _links(model: Any) -> list[tuple[Any, str]]:
    """The elements that name links, and the attributes with the names."""
    elements = [(one, "name") for one in model.findall("link")]
    for joint in model.findall("joint"):
        elements += [(end, "link") for end in (joint.find("parent"), joint.find("child")) if end is not None]
    elements += [(one, "reference") for one in model.findall("gazebo") if one.get("reference")]
    return elements + [(one, "link") for one in model.findall("sensor/parent")]


logger = logging.getLogger(__name__)

_JOINTS, _TEXT = "sensor_msgs/msg/JointState", "std_msgs/msg/String"
_QUANTITIES = ("position", "velocity", "effort")


class _Robot:
    """The topics of one robot."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.streams: list[ComponentMessages] = []
        self.measured: list[tuple[object, BoundKind]] = []
        self.states: Publisher | None = None
        self.description: Publisher | None = None
        self.last = -1
        self.joints: list[Joint] = []


class Robots:
    """The topics of all robots with publishing components.

    Args:
        manager: publishes the topics.

    Attributes:
        changed: names of robots that are described again by `publish`.
        stating: robots with a topic of joint states.
    """

    def __init__(self, manager: TopicManager) -> None:
        self._manager = manager
        self._robots: dict[str, _Robot] = {}
        self.changed: set[str] = set()
        self.stating: list[_Robot] = []

    def add(self, stream: ComponentMessages) -> None:
        """Add the stream of a sensor."""
        name = stream.robot.name()
        robot = self._robots.get(name)
        if robot is None or robot.robot is not stream.robot:
            before, robot = robot, _Robot(stream.robot)
            if before is not None:
                robot.states, robot.description = before.states, before.description
            self._robots[name] = robot
        robot.streams.append(stream)
        robot.measured += [(stream.component_instance, bound) for bound in stream.kinds if bound.kind.name == "joints"]
        self.changed.add(name)

    def remove(self, stream: ComponentMessages) -> None:
        """Remove a stream."""
        robot = self._robots.get(stream.robot.name())
        if robot is None or stream not in robot.streams:
            return
        robot.streams.remove(stream)
        robot.measured = [(one, bound) for one, bound in robot.measured if one is not stream.component_instance]

    def left(self) -> None:
        """Components were deleted: close the topics of deleted robots."""
        for name in [name for name, robot in self._robots.items() if not robot.streams]:
            robot = self._robots.pop(name)
            self.changed.add(name)
            for publisher in (robot.states, robot.description):
                if publisher is not None:
                    publisher.close()
            self._manager.release(name)

    def publish(self) -> None:
        """Send the changes of a tick."""
        if self.changed:
            changes, self.changed = self.changed, set()
            for name in sorted(changes & self._robots.keys()):
                self._describe(self._robots[name])
            self.stating = [robot for robot in self._robots.values() if robot.states is not None]
        for robot in self.stating:
            if robot.states is not None and robot.states.wanted():
                self._send_states(robot)

    def _describe(self, entry: _Robot) -> None:
        manager, robot = self._manager, entry.robot
        entry.joints = joints_of(robot, manager.names)
        namespace = manager.names.namespace(robot)
        if entry.measured and entry.states is None:
            entry.states = manager.own(f"{namespace}/joint_states", _JOINTS, Qos(), robot.name())
        if not manager.options["description"]:
            return
        if entry.description is None:
            entry.description = manager.own(f"{namespace}/robot_description", _TEXT, Qos(1, latched=True), robot.name())
        frames = {
            stream.own_frame(): Carried(stream.component_instance.bge_object, stream.mounting(), stream.is_carried())
            for stream in entry.streams
            if stream.own_frame() != manager.names.base(robot)
        }
        base, articulation = manager.names.base(robot), robot.bge_object.node.articulation
        if articulation is not None and articulation.description:
            link = partial(manager.names.link, robot)
            text = describe_file(articulation.description, base, link, entry.joints, frames)
        else:
            text = describe(robot.name(), robot.bge_object, base, entry.joints, frames)
        manager.tell(entry.description, _TEXT, {"data": text})

    def _send_states(self, robot: _Robot) -> None:
        messages = [(owner, bound.gather()) for owner, bound in robot.measured]
        newest = max((message.stamp for _, message in messages), default=-1)
        if newest > robot.last or newest < robot.last:
            robot.last = newest
            self._manager.tell(robot.states, _JOINTS, union(messages, newest, robot.joints))


def union(messages: list[tuple[Any, Message]], stamp: int, joints: list[Joint]) -> RosMessage:
    """Merge several ``sensor_msgs/JointState``: missing values are NaN; without any values, lists are empty."""
    names: list[str] = []
    values: dict[str, list[float]] = {quantity: [] for quantity in _QUANTITIES}
    for owner, message in messages:
        own_names = [name_of(joints, owner, str(name)) for name in message.names]
        if own_names and own_names[0] in names:
            # another sensor of the same armature
            continue
        names += own_names
        count = len(message.names)
        for quantity, column in values.items():
            numbers = getattr(message, quantity)
            column += [math.nan] * count if numbers is None else np.asarray(numbers, dtype=np.float64).tolist()
    return {
        "header": {"stamp": time(stamp), "frame_id": ""},
        "name": names,
        **{quantity: column if not all(map(math.isnan, column)) else () for quantity, column in values.items()},
    }
