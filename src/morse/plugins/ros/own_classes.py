"""Base classes for streams of users with message classes of their own, as in MORSE 1.4.

A scene names such a class: ``pose.add_stream('ros', 'my_lab.streams.Marked')``.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar

from morse.core.datastream import AbstractDatastream
from morse.core.exceptions import MorseMiddlewareError
from morse.plugins.ros.node import message
from morse.rosmsgs.parts import quaternion, quaternion_of, time, xyz

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.object import Object
    from morse.plugins.ros.datastream import ROSDatastreamManager
    from morse.rosmsgs.topics.backend import Publisher, RosClass, RosObject, Subscription

_SECOND = 1e9
#: value of `ROSPublisher.default_frame_id`: the frame has the name of the topic
TOPIC_NAME = "USE_TOPIC_NAME"
_BASE = "/base_link"


class _OwnClass(AbstractDatastream):
    """A stream with one topic.

    Attributes:
        ros_class: the class of the messages, such as ``std_msgs.msg.String``.
        topic_name: the name of the topic: the option ``topic``, or that of the component.
    """

    manager: ROSDatastreamManager
    ros_class: ClassVar[RosClass | None] = None
    topic_name: str = ""

    def _checked_class(self) -> RosClass:
        if self.ros_class is None or getattr(self.ros_class, "_type", None) is None:
            raise MorseMiddlewareError(
                f"{self.component_name}: {type(self).__name__}.ros_class is {self.ros_class!r}, expected a class of "
                "messages: ros_class = std_msgs.msg.String"
            )
        return self.ros_class


class ROSPublisher(_OwnClass):
    """Publishes messages of `ros_class`; a subclass defines `default`, which creates and publishes them.

    Attributes:
        default_frame_id: frame of the messages without the option ``frame_id``; ``USE_TOPIC_NAME`` for the name of the
            topic.
        frame_id: the frame of the messages.
        sequence: number of published messages.
    """

    default_frame_id: ClassVar[str] = TOPIC_NAME
    frame_id: str = ""
    sequence: int = 0

    def initialize(self) -> None:
        """Open the topic.

        Raises:
            MorseMiddlewareError: the class of the messages is missing, or the topic is that of another component.
        """
        super().initialize()
        self.topic_name, self._publisher = self._opened()
        default = self.topic_name if self.default_frame_id == TOPIC_NAME else self.default_frame_id
        self.frame_id = str(self.kwargs.get("frame_id") or default)

    def _opened(self) -> tuple[str, Publisher]:
        kind = self._checked_class()
        topic_and_publisher: tuple[str, Publisher] = self.manager.publisher_of(self, kind)
        return topic_and_publisher

    @abstractmethod
    def default(self, ci: Object | None = None) -> object:
        """Publish a message; called whenever the component has acted."""

    def publish(self, message: Any) -> None:
        """Publish a message of `ros_class`."""
        if self._publisher.wanted():
            self._publisher.publish(message)
        self.sequence += 1

    def get_time(self) -> RosObject:
        """The simulated time of the data, as ``rospy.Time``."""
        from genpy import Time

        seconds = self.data.get("timestamp")
        stamp = self.manager.context.clock.stamp() if seconds is None else round(seconds * _SECOND)
        time: RosObject = Time(*divmod(stamp, int(_SECOND)))
        return time

    def get_ros_header(self) -> object:
        """A ``std_msgs.msg.Header`` with the time of the data and the frame of the stream."""
        header = message("std_msgs/Header", {"frame_id": self.frame_id})
        header.seq, header.stamp = self.sequence, self.get_time()
        return header


class ROSPublisherTF(ROSPublisher):
    """Publishes transforms on ``/tf`` as well.

    The option ``tf=False`` of the middleware switches them off.
    """

    def sendTransform(  # noqa: N802 (the name in 1.4)
        self, translation: Sequence[float], rotation: Sequence[float], time_: RosObject, child: str, parent: str
    ) -> None:
        """Publish a transform.

        Args:
            translation: x, y, z of the child in the frame of the parent, m.
            rotation: x, y, z, w of the child in the frame of the parent.
            time_: simulated time, as returned by `get_time`.
            child, parent: names of the frames.
        """
        x, y, z, w = (float(number) for number in rotation)
        self.manager.send_transform(
            {
                "header": {"stamp": time(time_.to_nsec()), "frame_id": parent},
                "child_frame_id": child,
                "transform": {"translation": xyz(translation), "rotation": quaternion((w, x, y, z))},
            }
        )

    def get_robot_transform(self) -> tuple[list[float], list[float]]:
        """The pose of the component on its robot: x, y, z (m), and the quaternion x, y, z, w."""
        pose = self.component_instance.sensor_to_robot_position_3d()
        w, x, y, z = quaternion_of(pose)
        return [pose.x, pose.y, pose.z], [x, y, z, w]

    def send_transform_robot(
        self, time: RosObject | None = None, child: str | None = None, parent: str | None = None
    ) -> None:
        """Publish the transform from the robot, ``parent_frame_id`` or ``/base_link``, to the component."""
        translation, rotation = self.get_robot_transform()
        above = parent or str(self.kwargs.get("parent_frame_id") or _BASE)
        self.sendTransform(translation, rotation, time or self.get_time(), child or self.frame_id, above)

    def publish_with_robot_transform(self, message: RosObject) -> None:
        """Publish a message, and the transform from the robot to the component with the same time."""
        self.send_transform_robot(message.header.stamp)
        self.publish(message)


class ROSSubscriber(_OwnClass):
    """Receives messages of `ros_class`; a subclass defines `update`, which writes them into ``self.data``."""

    def initialize(self) -> None:
        """Open the topic.

        Raises:
            MorseMiddlewareError: the class of the messages is missing, or the topic has messages of another type.
        """
        super().initialize()
        kind = self._checked_class()
        self.topic_name, self._subscription = self._opened(kind)

    def _opened(self, kind: RosClass) -> tuple[str, Subscription]:
        topic_and_subscription: tuple[str, Subscription] = self.manager.subscription_of(self, kind)
        return topic_and_subscription

    def default(self, ci: Object | None = None) -> bool:
        """Pass the received messages to `update`, in the thread of the simulation; returns whether there were any."""
        messages = self._subscription.take()
        for one in messages:
            self.update(one)
        return bool(messages)

    @abstractmethod
    def update(self, message: object) -> None:
        """Write a message into ``self.data``, the fields of the component."""
