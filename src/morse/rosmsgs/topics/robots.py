"""Topics of whole robots: ``joint_states`` and ``robot_description``."""

from __future__ import annotations

import logging
import math
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.rosmsgs.moving import joints_of, name_of
from morse.rosmsgs.parts import time
from morse.rosmsgs.qos import Qos
from morse.rosmsgs.urdf import Carried, describe
from morse.rosmsgs.urdf_of_file import describe_file

if TYPE_CHECKING:
    from morse.core.kinds import BoundKind, Message
    from morse.core.robot import Robot
    from morse.core.values import RosMessage
    from morse.rosmsgs.component import ComponentMessages
    from morse.rosmsgs.moving import Joint
    from morse.rosmsgs.topics.backend import Publisher

logger = logging.getLogger(__name__)

_JOINTS, _TEXT = "sensor_msgs/msg/JointState", "std_msgs/msg/String"
_QUANTITIES = ("position", "velocity", "effort")


class _Robot:
    """The topics of one robot."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.streams: list[ComponentMessages] = []
        self.measured: list[tuple[Any, BoundKind]] = []
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

    def __init__(self, manager: Any) -> None:
        self._manager = manager
        self._robots: dict[str, _Robot] = {}
        self.changed: set[str] = set()
        self.stating: list[_Robot] = []

    def add(self, stream: ComponentMessages) -> None:
        """Add the stream of a sensor."""
        name = stream.robot.name()
        known = self._robots.get(name)
        if known is None or known.robot is not stream.robot:
            before, known = known, _Robot(stream.robot)
            if before is not None:
                known.states, known.description = before.states, before.description
            self._robots[name] = known
        known.streams.append(stream)
        known.measured += [(stream.component_instance, bound) for bound in stream.kinds if bound.kind.name == "joints"]
        self.changed.add(name)

    def remove(self, stream: ComponentMessages) -> None:
        """Remove a stream."""
        known = self._robots.get(stream.robot.name())
        if known is None or stream not in known.streams:
            return
        known.streams.remove(stream)
        known.measured = [(one, bound) for one, bound in known.measured if one is not stream.component_instance]

    def left(self) -> None:
        """Components were deleted: close the topics of deleted robots."""
        for name in [name for name, known in self._robots.items() if not known.streams]:
            known = self._robots.pop(name)
            self.changed.add(name)
            for publisher in (known.states, known.description):
                if publisher is not None:
                    publisher.close()
            self._manager.release(name)

    def publish(self) -> None:
        """Send the changes of a tick."""
        if self.changed:
            changed, self.changed = self.changed, set()
            for name in sorted(changed & self._robots.keys()):
                self._describe(self._robots[name])
            self.stating = [known for known in self._robots.values() if known.states is not None]
        for known in self.stating:
            if known.states is not None and known.states.wanted():
                self._send_states(known)

    def _describe(self, known: _Robot) -> None:
        manager, robot = self._manager, known.robot
        known.joints = joints_of(robot, manager.names)
        namespace = manager.names.namespace(robot)
        if known.measured and known.states is None:
            known.states = manager.own(f"{namespace}/joint_states", _JOINTS, Qos(), robot.name())
        if not manager.options["description"]:
            return
        if known.description is None:
            known.description = manager.own(f"{namespace}/robot_description", _TEXT, Qos(1, latched=True), robot.name())
        frames = {
            stream.own_frame(): Carried(stream.component_instance.bge_object, stream.mounting(), stream.is_carried())
            for stream in known.streams
            if stream.own_frame() != manager.names.base(robot)
        }
        base, articulation = manager.names.base(robot), robot.bge_object.node.articulation
        if articulation is not None and articulation.description:
            link = partial(manager.names.link, robot)
            text = describe_file(articulation.description, base, link, known.joints, frames)
        else:
            text = describe(robot.name(), robot.bge_object, base, known.joints, frames)
        manager.tell(known.description, _TEXT, {"data": text})

    def _send_states(self, known: _Robot) -> None:
        messages = [(owner, bound.gather()) for owner, bound in known.measured]
        newest = max((message.stamp for _, message in messages), default=-1)
        if newest > known.last or newest < known.last:
            known.last = newest
            self._manager.tell(known.states, _JOINTS, union(messages, newest, known.joints))


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
            known = getattr(message, quantity)
            column += [math.nan] * count if known is None else np.asarray(known, dtype=np.float64).tolist()
    return {
        "header": {"stamp": time(stamp), "frame_id": ""},
        "name": names,
        **{quantity: column if not all(map(math.isnan, column)) else () for quantity, column in values.items()},
    }
