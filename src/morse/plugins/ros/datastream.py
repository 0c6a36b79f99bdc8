"""Publishes data streams as topics of ROS 1."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from morse.core.exceptions import MorseMiddlewareError
from morse.plugins.ros.mapping import MANAGER_OPTIONS
from morse.plugins.ros.node import RospyBackend
from morse.plugins.ros.stream import LogTopicOfRos1, Ros1Topics, TransformsOf14
from morse.plugins.ros.variants import class_path
from morse.rosmsgs.table import Qos
from morse.rosmsgs.topics.manager import TF, TopicManager

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.datastream import AbstractDatastream
    from morse.core.object import Object
    from morse.core.values import Options, RosMessage
    from morse.plugins.ros.own_classes import ROSPublisher, ROSSubscriber
    from morse.rosmsgs.topics.backend import Backend, Publisher, RosClass, Subscription
    from morse.scene import StreamDeclaration


#: queue of topics of streams with classes of their own
_OWN = Qos(10)


class ROSDatastreamManager(TopicManager):
    """Topics of ROS 1: the messages and frames of MORSE 1.4, and those of ROS 2 for all other components.

    Options of ``env.configure_stream_manager('ros', ...)`` are in `morse.plugins.ros.mapping`.
    """

    classpath = "morse.middleware.ros_datastream.ROSDatastreamManager"
    manager_options = MANAGER_OPTIONS
    title = "ros"
    table = Ros1Topics()
    log_topic = LogTopicOfRos1
    backend: RospyBackend

    def __init__(self, options: Options, context: Context) -> None:
        super().__init__(options, context)
        if self.options["frames"] == "1.4":
            self.transforms = TransformsOf14(False, self._send_tf, self._send_static)

    def _send_static(self, message: RosMessage) -> None:
        if message["transforms"]:
            self._publish(self._tf_static, TF, message)

    def make_stream(self, component: Object, declaration: StreamDeclaration) -> object:
        """See `DatastreamManager.make_stream`; the class may have its name in 1.4."""
        stream = class_path(declaration.stream, component.name())
        return super().make_stream(component, replace(declaration, stream=stream))

    # -- streams with classes of their own ------------------------------------------------------

    def publisher_of(self, stream: ROSPublisher, kind: RosClass) -> tuple[str, Publisher]:
        """The topic of a stream that publishes messages of a class, and its publisher.

        Raises:
            MorseMiddlewareError: the topic is that of another component.
        """
        topic = self._topic_of(stream)
        owner = self._claims.get(topic)
        if owner is not None:
            raise MorseMiddlewareError(
                f"{stream.component_name}: the topic {topic} is that of {owner[1]}; set another one: topic='...'"
            )
        self._claims[topic] = (kind._type, stream.component_name)
        key = (topic, kind._type, _OWN)
        if key not in self._publishers:
            self._publishers[key] = self.backend.publisher_of(topic, kind, _OWN)
        return topic, self._publishers[key]

    def subscription_of(self, stream: ROSSubscriber, kind: RosClass) -> tuple[str, Subscription]:
        """The topic of a stream that receives messages of a class, and its subscription.

        Raises:
            MorseMiddlewareError: another component uses the topic with another message.
        """
        topic = self._topic_of(stream)
        claim = self._claims.setdefault(topic, (kind._type, stream.component_name))
        if claim[0] != kind._type:
            raise MorseMiddlewareError(
                f"{stream.component_name}: the topic {topic} has the type {claim[0]} for {claim[1]}, and cannot have "
                f"{kind._type} as well; set another one: topic='...'"
            )
        key = (f"{stream.component_name} {topic}", kind._type, _OWN)
        if key not in self._subscriptions:
            self._subscriptions[key] = self.backend.subscription_of(topic, kind)
        self._subscriptions[key].take()  # discard messages to a former component
        return topic, self._subscriptions[key]

    def _topic_of(self, stream: AbstractDatastream) -> str:
        return self.names.topic(stream.component_instance, {"namespace": None, "topic": None, **stream.kwargs})

    def send_transform(self, transform: RosMessage) -> None:
        """Publish a transform on ``/tf``, unless the scene has switched it off."""
        if self.wants_transforms():
            self._publish(self._tf, TF, {"transforms": [transform]})

    def _make_backend(self) -> Backend:
        # descriptions of robots are parameters in ROS 1
        self.options = {**self.options, "description": False}
        return RospyBackend(self.context.scene.settings.node_name, self.context.arrivals)
