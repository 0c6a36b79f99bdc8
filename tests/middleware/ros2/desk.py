"""A backend that stores messages; they are decoded by rosbags, which is independent of MORSE."""

from collections import deque
from typing import Any

from morse.rosmsgs.table import Qos
from morse.rosmsgs.topics.backend import Backend, Publisher, Subscription


class DeskPublisher(Publisher):
    def __init__(self) -> None:
        self.sent: list[bytes] = []
        self.listened, self.closed = True, False

    def publish(self, data: bytes) -> bool:
        self.sent.append(data)
        return True

    def wanted(self) -> bool:
        return self.listened

    def close(self) -> None:
        self.closed = True


class DeskSubscription(Subscription):
    def __init__(self) -> None:
        self.arrived: deque[bytes] = deque()
        self.closed = False

    def take(self) -> list[bytes]:
        found = list(self.arrived)
        self.arrived.clear()
        return found

    def close(self) -> None:
        self.closed = True


class Desk(Backend):
    name, opens = "desk", "nothing"

    def __init__(self, store: Any) -> None:
        self.store = store
        self.publishers: dict[str, tuple[str, Qos, DeskPublisher]] = {}
        self.subscriptions: dict[str, tuple[str, Qos, list[DeskSubscription]]] = {}
        self.closed = False

    def publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        made = DeskPublisher()
        self.publishers[topic] = (type_name, qos, made)
        return made

    def subscription(self, topic: str, type_name: str, qos: Qos) -> Subscription:
        made = DeskSubscription()
        self.subscriptions.setdefault(topic, (type_name, qos, []))[2].append(made)
        return made

    def close(self) -> None:
        self.closed = True

    # -- functions for tests -----------------------------------------------------------------

    def last(self, topic: str) -> Any:
        """The last message of a topic, decoded by rosbags."""
        type_name, _, publisher = self.publishers[topic]
        return self.store.deserialize_cdr(publisher.sent[-1], type_name)

    def send(self, topic: str, **fields: Any) -> None:
        """A message, encoded by rosbags."""
        type_name = self.subscriptions[topic][0]
        message = self.store.types[type_name](**fields)
        self.send_bytes(topic, bytes(self.store.serialize_cdr(message, type_name)))

    def send_bytes(self, topic: str, data: bytes) -> None:
        for subscription in self.subscriptions[topic][2]:
            subscription.arrived.append(data)
