"""Topics of a WebSocket server, as a backend of the topics of ROS 2."""

from __future__ import annotations

import itertools
import logging
import threading
from collections import deque
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol

from morse.core.clients.complaints import Complaints
from morse.rosmsgs.topics.backend import Backend, Publisher, Subscription

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.rosmsgs.table import Qos


logger = logging.getLogger(__name__)

#: limits of the messages of a topic that wait for the next action of an actuator: number and bytes
_MOST_ARRIVED, _MOST_BYTES = 64, 1 << 20
#: maximum number of ticks whose messages wait for the network thread
_MOST_TICKS = 32


class TopicHub(Protocol):
    """The part of `morse.middleware.web.hub.Hub` that topics use."""

    name: ClassVar[str]
    context: Context
    server: Any
    topics: Any

    def frame(self, topic: WebTopic, stamp: int, data: bytes) -> Any:
        """See `morse.middleware.web.hub.Hub.frame`."""

    def join(self) -> None:
        """See `morse.middleware.web.hub.Hub.join`."""

    def leave(self) -> None:
        """See `morse.middleware.web.hub.Hub.leave`."""


class WebTopic(Publisher):
    """A topic that the simulation publishes.

    Attributes:
        topic, type, qos: as offered.
        number: unique id of the topic.
        readers: the clients that have subscribed, with their options; changed in the network thread.
        kept: stamp and data of the last messages, for later subscribers; empty unless the topic is latched.
    """

    def __init__(self, topics: WebTopics, number: int, topic: str, type_name: str, qos: Qos) -> None:
        self.topic, self.type, self.qos, self.number = topic, type_name, qos, number
        self.readers: dict[Any, Any] = {}
        self.kept: deque[tuple[int, bytes]] = deque(maxlen=qos.depth if qos.latched else 0)
        self._topics = topics

    def publish(self, data: bytes) -> bool:
        """See `Publisher.publish`."""
        stamp = self._topics.stamp()
        self.kept.append((stamp, data))
        if self.readers:
            self._topics.put(self, stamp, data)
        return True

    def wanted(self) -> bool:
        """See `Publisher.wanted`."""
        return bool(self.readers)

    def close(self) -> None:
        """See `Publisher.close`."""
        self._topics.withdraw(self)


class WebInlet(Subscription):
    """A topic to which a component has subscribed."""

    def __init__(self, topics: WebTopics, topic: str) -> None:
        self._topics, self._topic = topics, topic
        self._lock = threading.Lock()
        self._inbox: deque[bytes] = deque()
        self._size = 0

    def put(self, data: bytes) -> None:
        """A message has arrived; the oldest messages are dropped if there are too many. In the network thread."""
        with self._lock:
            self._inbox.append(data)
            self._size += len(data)
            while len(self._inbox) > _MOST_ARRIVED or (self._size > _MOST_BYTES and len(self._inbox) > 1):
                self._size -= len(self._inbox.popleft())
                self._topics.complain_of_loss(self._topic)

    def take(self) -> list[bytes]:
        """See `Subscription.take`."""
        if not self._inbox:
            return []
        with self._lock:
            messages = list(self._inbox)
            self._inbox.clear()
            self._size = 0
        return messages

    def close(self) -> None:
        """See `Subscription.close`."""
        self._topics.stop_hearing(self._topic, self)


class Heard(NamedTuple):
    """A topic for commands.

    Attributes:
        type: type of its messages.
        inlets: its subscribers.
    """

    type: str
    inlets: tuple[WebInlet, ...]


class WebTopics(Backend):
    """The topics of one middleware. Methods are called in the simulation thread unless stated otherwise.

    Attributes:
        offered: the published topics by name. The table is replaced, never modified, so that the network thread
            can read it at any time.
        heard: the command topics.
    """

    def __init__(self, hub: TopicHub) -> None:
        self.name = hub.name
        self._hub = hub
        hub.join()
        hub.topics = self
        self.opens = f"port {hub.server.port}"
        self.offered: dict[str, WebTopic] = {}
        self.heard: dict[str, Heard] = {}
        self._numbers = itertools.count(1)
        self._outbox: list[tuple[WebTopic, int, bytes]] = []
        self._parcels: deque[list[tuple[WebTopic, int, bytes]]] = deque(maxlen=_MOST_TICKS)
        self._is_waiting = False
        self._complaints = Complaints(logger)

    def publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        """See `Backend.publisher`."""
        publisher = WebTopic(self, next(self._numbers), topic, type_name, qos)
        self.offered = {**self.offered, topic: publisher}
        self._hub.context.network.post(self._tell_added, publisher)
        return publisher

    def complain_of_loss(self, topic: str) -> None:
        """Log that messages on a topic were dropped."""
        text = f"{self.name}: messages on {topic} arrive faster than they are read: the oldest are lost"
        self._complaints.warn(text, text)

    def withdraw(self, topic: WebTopic) -> None:
        """Remove a published topic."""
        self.offered = {name: one for name, one in self.offered.items() if one is not topic}
        self._hub.context.network.post(self._tell_removed, topic)

    def subscription(self, topic: str, type_name: str, qos: Qos) -> Subscription:
        """See `Backend.subscription`."""
        inlet = WebInlet(self, topic)
        topic_subscription = self.heard.get(topic)
        inlets = (
            topic_subscription.inlets if topic_subscription is not None and topic_subscription.type == type_name else ()
        )
        self.heard = {**self.heard, topic: Heard(type_name, (*inlets, inlet))}
        return inlet

    def stop_hearing(self, topic: str, inlet: WebInlet) -> None:
        """End the subscription of a component."""
        subscription = self.heard.get(topic)
        if subscription is not None:
            inlets = tuple(one for one in subscription.inlets if one is not inlet)
            others = {name: one for name, one in self.heard.items() if name != topic}
            self.heard = {**others, topic: Heard(subscription.type, inlets)} if inlets else others

    # -- the tick ----------------------------------------------------------------------------

    def stamp(self) -> int:
        """Simulated time, ns."""
        return self._hub.context.clock.stamp()

    def put(self, topic: WebTopic, stamp: int, data: bytes) -> None:
        """Queue a message for the end of the tick."""
        self._outbox.append((topic, stamp, data))

    def flush(self) -> None:
        """The end of a tick: pass the messages to the network thread."""
        if not self._outbox and not self._hub.server.clients:
            return
        if len(self._parcels) == _MOST_TICKS:
            self._complaints.warn("late", f"{self.name}: ticks are faster than messages can be sent: some are lost")
        self._parcels.append(self._outbox)
        self._outbox = []
        if not self._is_waiting:
            self._is_waiting = True
            self._hub.context.network.post(self._send)

    def close(self) -> None:
        """See `Backend.close`."""
        self.flush()
        self._hub.topics = None
        self._hub.leave()

    # -- in the network thread ---------------------------------------------------------------

    def _tell_added(self, topic: WebTopic) -> None:
        for client in list(self._hub.server.clients):
            client.topic_added(topic)

    def _tell_removed(self, topic: WebTopic) -> None:
        topic.readers.clear()
        for client in list(self._hub.server.clients):
            client.topic_removed(topic)

    def _send(self) -> None:
        self._is_waiting = False
        while self._parcels:
            for topic, stamp, data in self._parcels.popleft():
                if topic.readers:
                    frame = self._hub.frame(topic, stamp, data)
                    for client in list(topic.readers):
                        client.show(topic, frame)
        stamp = self.stamp()
        for client in list(self._hub.server.clients):
            client.tick(stamp)
