"""Publishes data streams as topics with messages of ROS, on any backend."""

from __future__ import annotations

import logging
import math
import queue
import threading
from abc import abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar

from morse.core.clients.complaints import Complaints
from morse.core.datastream import DatastreamManager
from morse.core.exceptions import MorseMiddlewareError
from morse.core.mapping import maps
from morse.core.reports.faults import describe
from morse.rosmsgs.kinds import Ros2Topics
from morse.rosmsgs.kinds.states import clock
from morse.rosmsgs.names import TOPIC_OPTIONS, Names, robot_of
from morse.rosmsgs.remap import Remaps
from morse.rosmsgs.table import COMMAND, Qos
from morse.rosmsgs.topics.backend import announce
from morse.rosmsgs.topics.robots import Robots
from morse.rosmsgs.topics.rosout import LogTopic
from morse.rosmsgs.topics.transforms import Transforms
from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.core.context import Context
    from morse.core.kinds import BoundKind, Message
    from morse.core.values import Options, RosMessage
    from morse.rosmsgs.table import Inlet, Outlet, TopicTable
    from morse.rosmsgs.topics.backend import Backend, Publisher, Subscription
    from morse.rosmsgs.topics.stream import TopicStream

#: number of messages that wait; a tick with more of them waits, because none is dropped
_MOST = 32


class Sender:
    """Does work in its order, in a thread of its own.

    A simulation that is not paced by the wall clock does the work itself: a client that steps it finds the messages of
    a tick when the tick is over, and a thread would not make it faster.

    Args:
        is_paced: whether the simulation is in step with the wall clock, so that it waits between ticks.

    Attributes:
        failures: streams whose messages could not be made, and the errors; the simulation closes these streams.
    """

    def __init__(self, is_paced: Callable[[], bool]) -> None:
        self._is_paced = is_paced
        self.failures: list[tuple[Any, BaseException]] = []
        self._queue: queue.Queue[tuple[Callable[[], object], object] | None] = queue.Queue(_MOST)
        self._thread: threading.Thread | None = None

    def do(self, work: Callable[[], object], stream: object = None) -> None:
        """Do some work, at once or soon.

        Args:
            stream: the stream that is closed if the work raises an error later; None if only the work is lost.
        """
        if not self._is_paced():
            self.finish()
            work()
            return
        if self._thread is None:
            self._thread = threading.Thread(target=self._serve, name="morse-ros2", daemon=True)
            self._thread.start()
        self._queue.put((work, stream))

    def finish(self) -> None:
        """Wait until all work is done."""
        if self._thread is not None:
            self._queue.join()

    def close(self) -> None:
        """Do the rest, and end the thread."""
        if self._thread is not None:
            self._queue.put(None)
            self._thread.join()
            self._thread = None

    def _serve(self) -> None:
        while True:
            work = self._queue.get()
            try:
                if work is None:
                    return
                work[0]()
            except BaseException as error:
                assert work is not None
                if work[1] is None:
                    logger.error("ros2: a message could not be sent: %s", describe(error))
                else:
                    self.failures.append((work[1], error))
            finally:
                self._queue.task_done()


logger = logging.getLogger(__name__)

TF = "tf2_msgs/msg/TFMessage"
_CLOCK = "rosgraph_msgs/msg/Clock"
_SECOND = 10**9


class TopicManager(DatastreamManager):
    """Topics with simulated time and the tree of frames.

    Attributes:
        names: names of topics and frames.
        transforms: the tree of frames.
        sender: encodes and sends what need not be done in the tick.
        backend: transports the messages.
    """

    manager_options = TOPIC_OPTIONS
    #: name of this middleware in messages
    title = "topics"
    #: the topics of each kind
    table: ClassVar[TopicTable] = Ros2Topics()
    log_topic: ClassVar[type[LogTopic]] = LogTopic

    def __init__(self, options: Options, context: Context) -> None:
        super().__init__(options, context)
        self.names = Names(self.options)
        self._remaps = Remaps(self.options.get("remap"), context.scene.nearby_paths)
        self.backend = self._make_backend()
        announce(self.backend, self.title)
        self._complaints = Complaints(logger)
        self.sender = Sender(lambda: self.backend.takes_threads and context.paced())
        #: topics by name: their type, and the component that publishes them
        self._claims: dict[str, tuple[str, str]] = {}
        self._publishers: dict[tuple[str, str, Qos], Publisher] = {}
        self._subscriptions: dict[tuple[str, str, Qos], Subscription] = {}
        self._aliases: dict[str, str] = {}
        self._clock = self._own("/clock", _CLOCK, Qos(1, reliable=False)) if self.options["clock"] else None
        self._tf = self._own("/tf", TF, Qos(100)) if self.options["tf"] else None
        self._tf_static = self._own("/tf_static", TF, Qos(1, latched=True)) if self.options["tf"] else None
        self._tf_period = -1
        self.robots = Robots(self)
        self._log = self.log_topic(self) if self.options["rosout"] else None
        self.transforms = Transforms(
            self.options["localization"],
            self._send_tf,
            lambda message: self._publish(self._tf_static, TF, message),
        )

    def _send_tf(self, message: RosMessage) -> None:
        self._publish(self._tf, TF, message)

    @abstractmethod
    def _make_backend(self) -> Backend:
        """The backend."""

    def _own(self, topic: str, type_name: str, qos: Qos) -> Publisher | None:
        topic, qos = self._remaps.apply(topic, qos)
        self._claims[topic] = (type_name, "the simulation")
        publisher: Publisher | None = self.backend.publisher(topic, type_name, qos)
        if publisher is None:
            logger.warning("%s: %s is not published: %s", self.title, topic, self._lacks(type_name), extra=OF_MACHINE)
        return publisher

    def own(self, topic: str, type_name: str, qos: Qos, owner: str) -> Publisher | None:
        """A topic without a component; None if a component publishes it, or the backend does not have the message."""
        name, _ = self._remaps.apply(topic, qos)
        if name in self._claims:
            logger.info("%s: %s is published by %s only", self.title, name, self._claims[name][1])
            return None
        publisher = self._own(topic, type_name, qos)
        self._claims[name] = (type_name, owner)
        return publisher

    def tell(self, publisher: Publisher | None, type_name: str, message: RosMessage) -> None:
        """Publish a message that belongs to no component."""
        self._publish(publisher, type_name, message)

    # -- messages ----------------------------------------------------------------------------

    @classmethod
    def has_form(cls, kind: str, direction: str = "OUT") -> bool:
        """See `DatastreamManager.has_form`."""
        return cls.table.has(kind, direction)

    def wanted(self, stream: TopicStream, topic: str) -> bool:
        """Whether a topic of the messages has a reader, or the tree of frames needs them."""
        return stream.has_reader(topic) or stream.moves(topic)

    @maps("general")
    def message(self, stream: TopicStream, message: Message) -> None:
        """The topics of the kind of the message, see `morse.rosmsgs.table.TopicTable`."""
        stream.publish(message)

    def release(self, owner: str) -> None:
        """Release the topics of an owner."""
        self._claims = {topic: claim for topic, claim in self._claims.items() if claim[1] != owner}

    def _lacks(self, type_name: str) -> str:
        return f"{self.backend.name} has no {type_name} here (sudo apt install ros-$ROS_DISTRO-{_package(type_name)})"

    def _publish(self, publisher: Publisher | None, type_name: str, message: RosMessage) -> None:
        if publisher is not None:
            publisher.publish(self.backend.encode(type_name, message))

    # -- topics ------------------------------------------------------------------------------

    def offer(self, stream: TopicStream, topic: str, outlet: Outlet) -> tuple[str, Outlet, Publisher] | None:
        """A topic that a stream publishes; None if it is optional and the backend does not have the message.

        Raises:
            MorseMiddlewareError: the topic is that of another component, or the backend does not have the message.
        """
        qos = outlet.qos._replace(reliable=False) if stream.kwargs.get("qos") == "sensor" else outlet.qos
        original = topic
        topic, qos = self._remaps.apply(topic, qos)
        owner = self._claims.get(topic)
        if owner is not None:
            raise MorseMiddlewareError(
                f"{stream.component_name}: the topic {topic} is that of {owner[1]}; set another one: topic='...'"
            )
        key = (topic, outlet.type, qos)
        if key not in self._publishers:
            publisher = self.backend.publisher(*key)
            if publisher is None and outlet.instead is not None:
                return self.offer(stream, original, outlet.instead)
            if publisher is None and outlet.or_none:
                return None
            self._publishers[key] = self._made(publisher, stream, outlet.type)
        self._claims[topic] = (outlet.type, stream.component_name)
        return topic, outlet, self._publishers[key]

    def hear(self, stream: TopicStream, bound: BoundKind, inlet: Inlet) -> Iterator[tuple[str, Subscription]]:
        """The command topics of a stream.

        Raises:
            MorseMiddlewareError: another component uses the topic with another message.
        """
        base = self.names.topic(stream.component_instance, stream.kwargs)
        topics = ["/".join(part for part in (base, bound.topic, inlet.topic) if part)]
        if inlet.also:
            alias = f"{self.names.namespace(stream.robot, stream.kwargs['namespace'])}/{inlet.also}"
            if self._aliases.setdefault(alias, stream.component_name) == stream.component_name:
                topics.append(alias)
        usual = COMMAND._replace(reliable=False) if stream.kwargs.get("qos") == "sensor" else COMMAND
        for topic, qos in dict([self._remaps.apply(topic, usual) for topic in topics]).items():
            claim = self._claims.setdefault(topic, (inlet.type, stream.component_name))
            if claim[0] != inlet.type:
                raise MorseMiddlewareError(
                    f"{stream.component_name}: the topic {topic} has the type {claim[0]} for {claim[1]}, and "
                    f"cannot have {inlet.type} as well; set another one: topic='...'"
                )
            # each listener has its own subscription: a message can be taken only once
            key = (f"{stream.component_name} {topic}", inlet.type, qos)
            if key not in self._subscriptions:
                subscription = self.backend.subscription(topic, inlet.type, qos)
                if subscription is None and inlet.or_none:
                    del self._claims[topic]
                    continue
                self._subscriptions[key] = self._made(subscription, stream, inlet.type)
            self._subscriptions[key].take()  # discard messages to a former component
            yield topic, self._subscriptions[key]

    def change_type(self, stream: TopicStream, topic: str, before: str, after: str) -> tuple[str, Subscription]:
        """Replace a subscription of a stream by one with another type of messages, if the backend has it.

        Returns:
            The type, and the new subscription.
        """
        key = next(key for key in self._subscriptions if key[:2] == (f"{stream.component_name} {topic}", before))
        # a participant has one type for a topic at a time
        self._subscriptions.pop(key).close()
        subscription, kind = self.backend.subscription(topic, after, key[2]), after
        if subscription is None:
            subscription, kind = self._made(self.backend.subscription(topic, before, key[2]), stream, before), before
        self._subscriptions[(key[0], kind, key[2])] = subscription
        self._claims[topic] = (kind, stream.component_name)
        return kind, self._subscriptions[key[0], kind, key[2]]

    def _made(self, endpoint: object, stream: TopicStream, type_name: str) -> Any:
        if endpoint is None:
            raise MorseMiddlewareError(f"{stream.component_name}: {self._lacks(type_name)}")
        return endpoint

    def opened(self, stream: TopicStream) -> None:
        """Refuse a second robot if names do not contain the robot."""
        others = {robot_of(other.component_instance).name() for streams in self.streams.values() for other in streams}
        if self.names.for_one_robot and len(others) > 1:
            raise MorseMiddlewareError(
                f"the options 'namespace' and 'frame_prefix' of {self.title} are for one robot, and there are "
                f"{', '.join(sorted(others))}"
            )

    def closed(self, stream: TopicStream) -> None:
        """Release its topics; they stay open for a replacement of the component, so that readers stay connected."""
        name = stream.component_name
        self.sender.finish()
        self.release(name)
        self._aliases = {alias: owner for alias, owner in self._aliases.items() if owner != name}
        if stream.direction == "OUT":
            self.transforms.remove(stream)
            self.robots.remove(stream)

    def left(self, name: str) -> None:
        """Close the topics that are no longer used after a component was deleted."""
        self.sender.finish()
        self.robots.left()
        for key in [key for key in self._publishers if key[0] not in self._claims]:
            self._publishers.pop(key).close()
        for key in [key for key in self._subscriptions if key[0].startswith(f"{name} ")]:
            self._subscriptions.pop(key).close()

    # -- the tick ----------------------------------------------------------------------------

    def wants_transforms(self) -> bool:
        """Whether the transforms have subscribers."""
        return self._tf is not None and self._tf.wanted()

    def _tf_is_due(self, stamp: int) -> bool:
        rate = self.options.get("tf_rate")
        if rate is None:
            return True
        # the number of the period of a tick, so that the mean rate is that of the option
        before, self._tf_period = self._tf_period, math.floor(stamp * rate / _SECOND)
        return self._tf_period != before

    def flush(self) -> None:
        """The end of a tick: publish the time and the poses of all frames."""
        if self.sender.failures:
            failures, self.sender.failures = self.sender.failures, []
            for stream, error in failures:
                component = stream.component_instance
                self.context.guard.close(component, component.output_functions, stream, error)
        for problem in self._remaps.unused():
            logger.error("%s: %s", self.title, problem)
        stamp = self.context.clock.stamp()
        if self._clock is not None and self._clock.wanted():
            self._publish(self._clock, _CLOCK, clock(stamp))
        self._flush_frames(stamp)
        if self.robots.changed or self.robots.stating:
            self.robots.publish()
        if self._log is not None and self._log.lines:
            self._log.publish(stamp)
        self.backend.tell_graph()

    def _flush_frames(self, stamp: int) -> None:
        if self._tf is not None:
            is_wanted = self._tf_is_due(stamp) and self._tf.wanted()
            if not is_wanted and not self.transforms.changed:
                return
            moving = self.transforms.publish(stamp, wanted=is_wanted)
            if moving is not None:
                self.sender.do(moving)

    def finalize(self) -> None:
        """Close all topics and leave the domain."""
        super().finalize()
        self.sender.close()
        if self._log is not None:
            self._log.close()
        self.robots.left()
        publishers = [self._clock, self._tf, self._tf_static, *self._publishers.values()]
        for publisher in publishers:
            if publisher is not None:
                publisher.close()
        for subscription in self._subscriptions.values():
            subscription.close()
        self._publishers.clear()
        self._subscriptions.clear()
        self.backend.release()


def _package(type_name: str) -> str:
    return type_name.partition("/")[0].replace("_", "-")
