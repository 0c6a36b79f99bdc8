"""Streams with other messages than the usual ones, under the class names of MORSE 1.4.

Scripts name them as ``method``: ``pose.add_stream('ros', 'morse.middleware.ros.pose.TFPublisher')``.
"""

from __future__ import annotations

import logging
import math
import re
from typing import TYPE_CHECKING, Any

from morse.core.kinds import Message, bind
from morse.plugins.ros.mapping import MIDDLEWARE
from morse.plugins.ros.stream import RosStream
from morse.rosmsgs.kinds.spatial import pose_message
from morse.rosmsgs.parts import header, pose_of
from morse.rosmsgs.table import Inlet, Outlet

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from morse.core.kinds import BoundKind
    from morse.core.values import DecodedMessage, RosMessage
    from morse.plugins.ros.stream import Frame


#: a symbol: none of the characters that the Lisp reader treats specially, and not a number
_SYMBOL = re.compile(r"(?![+-]?[.\d])[\w.+*/<>=!?&$%^~-]+")


def as_lisp(objects: Iterable[RosMessage]) -> str:
    """Return ``((name description x y z qx qy qz qw) ...)``.

    An empty description is ``-``. Texts that are not symbols are strings in quotation marks.

    Args:
        objects: the ``visible_objects`` of a `SemanticCamera`: positions in m, orientations as quaternions.
    """
    return f"({' '.join(map(_object, objects))})"


def _object(description: DecodedMessage) -> str:
    orientation = description["orientation"]
    numbers = (*description["position"], orientation.x, orientation.y, orientation.z, orientation.w)
    words = (_atom(description["name"]), _atom(description["description"] or "-"), *(repr(float(n)) for n in numbers))
    return f"({' '.join(words)})"


def _atom(text: str) -> str:
    if _SYMBOL.fullmatch(text):
        return text
    content = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{content}"'


logger = logging.getLogger(__name__)

_BASE = "/base_link"
#: constant of sensor_msgs/Range
_INFRARED = 1


class PosePublisher(RosStream):
    """``geometry_msgs/Pose``, without stamp and frame."""

    def ports(self, bound: BoundKind) -> list[Outlet]:
        """See `TopicStream.ports`."""
        if bound.kind.name != "pose" or not bound.has("orientation"):
            return super().ports(bound)
        return [Outlet("geometry_msgs/msg/Pose", lambda m, f: pose_message(m))]


class PoseWithCovarianceStampedPublisher(RosStream):
    """A pose with the covariance of its noise; all zeros if it is unknown."""

    def ports(self, bound: BoundKind) -> list[Outlet]:
        """See `TopicStream.ports`."""
        if bound.kind.name != "pose" or bound.has("covariance") or not bound.has("orientation"):
            return super().ports(bound)
        return [
            Outlet(
                "geometry_msgs/msg/PoseWithCovarianceStamped",
                lambda m, f: {"header": header(m, f), "pose": {"pose": pose_message(m)}},
            )
        ]


class _OnlyTransforms(RosStream):
    """No messages of its own."""

    def ports(self, bound: BoundKind) -> list[Outlet]:
        """See `TopicStream.ports`."""
        return []


class TFPublisher(_OnlyTransforms):
    """The measured pose as a transform from ``frame_id``, ``/map``, to ``child_frame_id``, ``/base_link``."""

    def transforms(self) -> Iterator[Frame]:
        """See `RosStream.transforms`."""
        for bound in self.kinds:
            if bound.kind.name == "pose" and bound.has("orientation"):
                message = bound.gather()
                child = self.kwargs["child_frame_id"] or _BASE
                yield self.kwargs["frame_id"] or "/map", child, pose_of(message.position, message.orientation)


class StaticTFPublisher(_OnlyTransforms):
    """The transform from ``parent_frame_id``, ``base_link``, to ``child_frame_id``, ``/ROBOT/COMPONENT``.

    It is published on ``/tf`` once a second, with the time of a second later.
    """

    def _mounted(self) -> Iterator[Frame]:
        options = self.kwargs
        child = options["child_frame_id"] or options["frame_id"]
        child = child or self.names.topic(self.component_instance, options)
        yield options["parent_frame_id"] or "base_link", child, self.component_instance.sensor_to_robot_position_3d()

    def repeated_transforms(self) -> Iterator[Frame]:
        """See `RosStream.repeated_transforms`."""
        yield from self._mounted()


class StaticTF2Publisher(StaticTFPublisher):
    """The same on ``/tf_static``, once, with the present time."""

    def repeated_transforms(self) -> Iterator[Frame]:
        """See `RosStream.repeated_transforms`."""
        yield from ()

    def fixed_transforms(self) -> Iterator[Frame]:
        """See `RosStream.fixed_transforms`."""
        yield from self._mounted()


class TwistPublisher(RosStream):
    """The velocity of an accelerometer as ``TwistStamped``, without the angular velocity, which is not measured."""

    def ports(self, bound: BoundKind) -> list[Outlet]:
        """See `TopicStream.ports`."""
        if bound.kind.name != "accel":
            return super().ports(bound)
        data = self.component_instance.local_data

        def make(message: Message, frame: str) -> RosMessage:
            x, y, z = (float(speed) for speed in data["velocity"])
            return {"header": header(message, frame), "twist": {"linear": {"x": x, "y": y, "z": z}}}

        return [Outlet("geometry_msgs/msg/TwistStamped", make)]


class PointCloud2Publisher(RosStream):
    """The points of a laser scanner, without rays that hit nothing."""

    def find_kinds(self) -> tuple[BoundKind, ...]:
        """See `KindStream.find_kinds`."""
        clouds = tuple(b for b in bind(self.component_instance, on_request=True) if b.kind.name == "cloud")
        for bound in clouds:
            bound.topic = ""
        return clouds or super().find_kinds()


class RangePublisher(RosStream):
    """The shortest distance of a laser scanner as ``Range``."""

    def ports(self, bound: BoundKind) -> list[Outlet]:
        """See `TopicStream.ports`."""
        if bound.kind.name != "scan":
            return super().ports(bound)
        scanner: Any = self.component_instance

        def make(message: Message, frame: str) -> RosMessage:
            return {
                "header": header(message, frame),
                "radiation_type": _INFRARED,
                "field_of_view": math.radians(scanner.scan_window),
                "max_range": scanner.laser_range,
                "range": float(min(scanner.local_data["range_list"], default=scanner.laser_range)),
            }

        return [Outlet("sensor_msgs/msg/Range", make)]


class Pose2DReader(RosStream):
    """A target from ``Pose2D``; the height and the orientation are kept."""

    def ports(self, bound: BoundKind) -> list[Any]:
        """See `TopicStream.ports`."""
        if bound.kind.name != "pose":
            return super().ports(bound)
        data = self.component_instance.local_data
        return [Inlet("geometry_msgs/msg/Pose2D", lambda m: {"position": [m["x"], m["y"], data["z"]]})]


class SemanticCameraPublisherLisp(RosStream):
    """The recognised objects as a list of Lisp, see `as_lisp`."""

    def ports(self, bound: BoundKind) -> list[Outlet]:
        """See `TopicStream.ports`."""
        if bound.kind.name != "detections":
            return super().ports(bound)
        data = self.component_instance.local_data
        return [Outlet("std_msgs/msg/String", lambda m, f: {"data": as_lisp(data["visible_objects"])})]


_VARIANTS = {
    variant.__name__
    for variant in (
        PointCloud2Publisher,
        Pose2DReader,
        PosePublisher,
        PoseWithCovarianceStampedPublisher,
        RangePublisher,
        SemanticCameraPublisherLisp,
        StaticTF2Publisher,
        StaticTFPublisher,
        TFPublisher,
        TwistPublisher,
    )
}
_PACKAGE_OF_1_4 = "morse.middleware.ros."
#: ends of the names of the other classes of 1.4
_ENDS = ("Publisher", "Reader", "Subscriber")


def class_path(path: str, component: str) -> str:
    """The class of a stream.

    Args:
        path: its class path, which may be one of 1.4: ``morse.middleware.ros.pose.TFPublisher``.
        component: name of the component, for a message.
    """
    if not path.startswith(_PACKAGE_OF_1_4) or path.startswith(f"{_PACKAGE_OF_1_4}variants."):
        return path
    name = path.rpartition(".")[2]
    if name in _VARIANTS:
        return f"{__name__}.{name}"
    if not name.endswith(_ENDS):
        logger.warning("ros: there is no class %s: %s uses its usual messages", path, component)
    return str(MIDDLEWARE.default_publisher)
