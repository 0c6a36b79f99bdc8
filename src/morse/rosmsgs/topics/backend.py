"""The interface of backends; all other parts of ROS 2 are implemented by MORSE and independent of the backend."""

from __future__ import annotations

import logging
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, Protocol

from morse.rosmsgs import cdr

if TYPE_CHECKING:
    from morse.core.values import DecodedMessage, RosMessage
    from morse.rosmsgs.table import Qos


class RosObject(Protocol):
    """A message, a request or a response of a ROS client library: its fields are attributes."""

    def __getattr__(self, field: str) -> Any:
        """A field: a number, a string, a list, or another message."""

    def __setattr__(self, field: str, value: object) -> None:
        """Set a field."""


class RosClass(Protocol):
    """The class of messages, services or actions of a ROS client library."""

    def __call__(self, *values: object, **fields: object) -> Any:
        """A message; of services and actions, the classes of the parts are attributes."""

    def __getattr__(self, name: str) -> Any:
        """A constant or a class of it."""


logger = logging.getLogger(__name__)


class Publisher(ABC):
    """Sends the messages of a topic."""

    @abstractmethod
    def publish(self, data: bytes) -> bool:
        """Send a message that `Backend.encode` has encoded.

        Returns:
            False if it is lost because readers are too slow.
        """

    @abstractmethod
    def wanted(self) -> bool:
        """Whether the topic has subscribers."""

    @abstractmethod
    def close(self) -> None:
        """Close the topic."""


class Subscription(ABC):
    """Receives the messages of a topic."""

    @abstractmethod
    def take(self) -> list[bytes]:
        """The received messages, oldest first; non-blocking."""

    def other_types(self) -> set[str]:
        """Types such as ``geometry_msgs/msg/Twist`` that others publish on the topic, and that are not received."""
        return set()

    @abstractmethod
    def close(self) -> None:
        """End the subscription."""


class ServiceServer(ABC):
    """Receives the calls of a service."""

    @abstractmethod
    def take(self, most: int) -> list[tuple[object, DecodedMessage]]:
        """The received calls, oldest first, up to a maximum number: the caller, and the request; non-blocking."""

    @abstractmethod
    def answer(self, caller: object, response: RosMessage) -> None:
        """Answer a call.

        Raises:
            ValueError, TypeError: a value does not fit its field.
        """

    @abstractmethod
    def close(self) -> None:
        """Remove the service."""


class Backend(ABC):
    """A participant of a ROS 2 domain. Its methods do not block, and are called in the simulation thread.

    If `takes_threads` is true, another thread may call `encode`, and `Publisher.publish` of its publishers.

    Attributes:
        name: the value of ``backend`` in ``env.configure_stream_manager('ros2', backend=...)``.
        opens: what it opens on which interface, for the log.
        has_services: whether it supports services.
        users: number of users.
    """

    has_services = False
    #: whether other threads may publish messages
    takes_threads = False
    users = 1
    #: whether the log reports what it opens
    announced = False

    name: str
    opens: str

    def encode(self, type_name: str, message: RosMessage) -> bytes:
        """Encode a message for publishers: CDR, unless the backend has another format.

        Raises:
            ValueError, TypeError, OverflowError, struct.error: a value does not fit its field.
        """
        return cdr.encode(type_name, message)

    def decode(self, type_name: str, data: bytes) -> DecodedMessage:
        """Decode data of a subscription into a message with all its fields.

        Raises:
            ValueError: the data is not a message of that type.
        """
        return cdr.decode(type_name, data)

    @abstractmethod
    def publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher | None:
        """Offer a topic; None if this backend does not have the type of message.

        Args:
            topic: absolute name, ``/robot/pose``.
            type_name: ``geometry_msgs/msg/PoseStamped``.
            qos: quality of service.
        """

    @abstractmethod
    def subscription(self, topic: str, type_name: str, qos: Qos) -> Subscription | None:
        """Subscribe to a topic; None if this backend does not have the type of message."""

    @abstractmethod
    def close(self) -> None:
        """Leave the domain."""

    def tell_graph(self) -> None:  # most backends have nothing to tell
        """Tell other nodes which topics were opened and closed; called at the end of each tick."""

    def has_namesake(self) -> bool:
        """Whether another simulation of the domain has been seen since the last call, by the name of its node."""
        return False

    def service(self, name: str, type_name: str) -> ServiceServer | None:
        """Offer a service; None if this backend has no services, or does not have the type.

        Args:
            name: absolute, ``/robot/motion/stop``.
            type_name: ``std_srvs/srv/Trigger``.
        """
        return None

    def typed_service(self, name: str, kind: object) -> Any:
        """Offer a service with a ROS class, whose messages are objects; None if this backend has no services."""
        return None

    def typed_publisher(self, topic: str, kind: object, qos: Qos) -> Any:
        """Offer a topic with a ROS class, whose messages are objects; None if this backend has no services."""
        return None

    def filled(self, message: RosObject, fields: RosMessage) -> Any:
        """A message object of `typed_publisher` with some fields, for backends with services.

        Raises:
            ValueError, TypeError: a value does not fit its field.
        """
        raise NotImplementedError

    def plain(self, message: Any) -> Any:
        """A message object of `typed_service` as a dictionary of its fields, for backends with services."""
        raise NotImplementedError

    def release(self) -> None:
        """Leave the domain if the backend is not shared."""
        self.users -= 1
        if self.users <= 0:
            self.close()


def announce(backend: Backend, title: str) -> None:
    """Log once what a backend has opened."""
    if not backend.announced:
        backend.announced = True
        logger.info("%s: %s, %s", title, backend.name, backend.opens)
