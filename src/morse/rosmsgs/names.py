"""Names of topics and frames (REP 105, REP 144: `/robot/component`, `robot/base_link`), and the options of both."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, cast
from weakref import WeakKeyDictionary

from morse.core.declarations import Option
from morse.core.exceptions import MorseMiddlewareError
from morse.core.reports.quoting import shown

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.interfaces import Carrier
    from morse.core.object import Object
    from morse.core.robot import Robot
    from morse.core.values import Options
    from morse.scene import Node


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


MAP = "map"
#: frames of components that are world frames in ROS
#: names of the frames that keep the axes of the world or of the earth
OF_WORLD = {"world": MAP, "ned": "map_ned", "enu": "enu", "utm": "utm", "earth": "earth"}
#: frames of REP 105
_BASE = "base_link"
_TAKEN = (MAP, "odom", _BASE)
_TOPIC = re.compile(r"/?[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*")


def _part(text: str) -> str:
    valid_name = re.sub(r"[^A-Za-z0-9_/]", "_", text.replace(".", "/"))
    return re.sub(r"(^|/)(?=[0-9])", r"\1_", valid_name)


def cleaned(text: str) -> str:
    """A name with characters that ROS allows; dots become slashes."""
    return _part(text)


def checked_topic(topic: str, what: str) -> str:
    """Check the name of a topic or a namespace, and return it unchanged.

    Raises:
        MorseMiddlewareError: ROS does not allow it.
    """
    if not _TOPIC.fullmatch(topic):
        raise MorseMiddlewareError(
            f"{what} is {shown(topic)}, expected words of letters, digits and _ with / between "
            "them, such as 'front/scan'"
        )
    return topic


def robot_of(component: Any) -> Robot:
    """The robot of a component; a robot itself."""
    return cast("Robot", component.robot_parent or component)


class Names:
    """Names according to the options of the middleware.

    Args:
        options: ``namespace`` and ``frame_prefix`` of the stream manager.
    """

    def __init__(self, options: Options) -> None:
        self._namespace, self._prefix = options["namespace"], options["frame_prefix"]
        self._roots: WeakKeyDictionary[Node, str] = WeakKeyDictionary()
        if self._namespace:
            checked_topic(self._namespace, "the option 'namespace'")

    @property
    def for_one_robot(self) -> bool:
        """Whether the names do not contain the robot."""
        return self._namespace is not None or self._prefix is not None

    def namespace(self, robot: Robot, name: str | None = None) -> str:
        """``/robot``, or an empty string for none."""
        text = self._namespace if name is None else name
        if name:
            checked_topic(name, f"{robot.name()}: the option 'namespace'")
        return "/" + text.strip("/") if text else "" if text == "" else "/" + _part(robot.name())

    def topic(self, component: Object, options: Options) -> str:
        """The topic of a component: from the options of its stream, or its name."""
        robot = robot_of(component)
        base = self.namespace(robot, options["namespace"])
        option = options["topic"]
        if option is None:
            return f"{base}/{_part(relative_name(component))}"
        checked_topic(option, f"{component.name()}: the option 'topic'")
        return str(option) if option.startswith("/") else f"{base}/{option}"

    def prefix(self, robot: Carrier) -> str:
        """The prefix of the frames of a robot."""
        return f"{_part(robot.name())}/" if self._prefix is None else str(self._prefix)

    def base(self, robot: Robot) -> str:
        """The frame of a robot: ``base_link``, or the first link of its file if another link is called so."""
        node = robot.bge_object.node
        name = self._roots.get(node)
        if name is None:
            name = self._roots[node] = _root_link(node)
        return f"{self.prefix(robot)}{_part(name)}"

    def odom(self, robot: Robot) -> str:
        """The frame of the initial pose of a robot."""
        return f"{self.prefix(robot)}odom"

    def own(self, component: Object) -> str:
        """The frame of a component."""
        if component.robot_parent is None:
            return self.base(component)
        name = _part(relative_name(component))
        # a sensor may be named odom: a frame can have only one parent
        return f"{self.prefix(component.robot_parent)}{name}{'_link' if name in _TAKEN else ''}"

    def part(self, owner: Object, joint: str) -> str:
        """The frame of a part that a joint of a robot or of a component moves."""
        if owner.robot_parent is None:
            return f"{self.prefix(owner)}{_part(joint)}"
        return f"{self.own(owner)}_{_part(joint)}"

    def link(self, robot: Robot, link: str) -> str:
        """The frame of a link that the file of a robot or of an arm names."""
        return f"{self.prefix(robot)}{_part(link)}"

    def frame(self, component: Object, frame: str) -> str:
        """A frame of a component, by its name in `morse.core.declarations.FRAMES`."""
        if frame in OF_WORLD:
            return OF_WORLD[frame]
        if frame == "robot":
            return self.base(robot_of(component))
        if frame == "start":
            return self.odom(robot_of(component))
        return f"{self.own(component)}_{frame}" if frame in ("optical", "frd", "down") else self.own(component)

    def frame_of(self, component: Object, frame_id: str) -> str | None:
        """The frame of a command; empty for the frame of the fields, None if it is unknown."""
        if not frame_id:
            return ""
        frames = {self.frame(component, frame): frame for frame in ("own", "robot", "world")}
        return frames.get(frame_id.lstrip("/"))


def relative_name(component: Object) -> str:
    """The name of a component on its robot."""
    name: str = component.name()
    robot = component.robot_parent
    return name.removeprefix(f"{robot.name()}.") if robot is not None else name


def _root_link(root: Node) -> str:
    """The link of a robot that has the frame of the robot; by REP 120, the parent of base_link is base_footprint."""
    for armature in root.children:
        links = {child.source_name or child.name: child for child in armature.children if armature.bones}
        base = links.get(_BASE)
        if base is not None and base.bone:
            return next((name for name, link in links.items() if not link.bone), _BASE)
    return _BASE
