"""Topics over rclpy, the client library of a ROS 2 installation.

Messages are bytes, as on the other backend: rclpy sends and returns them unchanged. Nothing is spun: received
messages are taken from the subscriptions when the simulation polls.
"""

from __future__ import annotations

import os
from contextlib import contextmanager, nullcontext
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, NoReturn

import rclpy
from rclpy.context import Context
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from morse.core.exceptions import MorseMiddlewareError
from morse.middleware.ros2 import NODE
from morse.middleware.ros2.backends import Confined, confined, described
from morse.rosmsgs.topics.backend import Backend, Publisher, ServiceServer, Subscription

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.core.values import DecodedMessage, Options, RosMessage
    from morse.rosmsgs.table import Qos
    from morse.rosmsgs.topics.backend import RosObject

_LOOPBACK = ("", "lo", "127.0.0.1", "localhost")
#: variables by which the user can set the network range of ROS
_REACH = ("ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOCALHOST_ONLY")
#: distributions with another variable for it
_BEFORE_IRON = ("foxy", "galactic", "humble")
#: maximum number of messages that are taken in one tick
_MOST = 64


@contextmanager
def _limited(interface: str) -> Iterator[str]:
    """Within the block, restrict ROS to this machine, unless its environment variables are set.

    Yields:
        A text for the log; empty if nothing is restricted.
    """
    settings = [f"{name}={os.environ[name]}" for name in _REACH if os.environ.get(name)]
    if settings:
        yield ", ".join(settings)
    elif interface in _LOOPBACK:
        old = os.environ.get("ROS_DISTRO", "") in _BEFORE_IRON
        name, value = ("ROS_LOCALHOST_ONLY", "1") if old else ("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        os.environ[name] = value
        try:
            yield ""
        finally:  # do not affect other simulations of this process, or child processes
            del os.environ[name]
    elif interface == "any":
        yield "all interfaces"
    else:
        _refuse(interface)


def _refuse(interface: str) -> NoReturn:
    raise MorseMiddlewareError(
        f"ros2: rclpy cannot select the interface {interface!r}; set interface='any' and select it in the settings of "
        "your RMW, or set backend='cyclonedds'"
    )


def _profile(qos: Qos) -> QoSProfile:
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=qos.depth,
        reliability=ReliabilityPolicy.RELIABLE if qos.reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if qos.latched else DurabilityPolicy.VOLATILE,
    )


def _message_class(type_name: str) -> Any:
    package, _, name = type_name.partition("/msg/")
    try:
        return getattr(import_module(f"{package}.msg"), name)
    except (ImportError, AttributeError):
        return None


class _Publisher(Publisher):
    def __init__(self, node: Any, publisher: Any) -> None:
        self._node, self._publisher = node, publisher

    def publish(self, data: bytes) -> bool:
        self._publisher.publish(data)
        return True

    def wanted(self) -> bool:
        return bool(self._publisher.get_subscription_count())

    def close(self) -> None:
        self._node.destroy_publisher(self._publisher)


class _Subscription(Subscription):
    def __init__(self, node: Any, subscription: Any, type_name: str) -> None:
        self._node, self._subscription, self._type = node, subscription, type_name

    def other_types(self) -> set[str]:
        publishers = self._node.get_publishers_info_by_topic(self._subscription.topic_name)
        return {one.topic_type for one in publishers} - {self._type}

    def take(self) -> list[bytes]:
        subscription = self._subscription
        messages: list[bytes] = []
        with subscription.handle:
            while len(messages) < _MOST:
                message = subscription.handle.take_message(subscription.msg_type, True)
                if message is None:
                    break
                messages.append(bytes(message[0]))
        return messages

    def close(self) -> None:
        self._node.destroy_subscription(self._subscription)


class _Service(ServiceServer):
    def __init__(self, node: Any, service: Any) -> None:
        self._node, self._service = node, service

    def take(self, most: int) -> list[tuple[Any, RosMessage]]:
        return [(caller, plain(request)) for caller, request in self.take_messages(most)]

    def take_messages(self, most: int) -> list[tuple[Any, Any]]:
        """Like `take`, with requests as objects of rclpy."""
        service = self._service
        messages: list[tuple[Any, Any]] = []
        with service.handle:
            while len(messages) < most:
                request, info = service.handle.service_take_request(service.srv_type.Request)
                if info is None:
                    break
                messages.append((info.request_id, request))
        return messages

    def answer(self, caller: object, response: RosMessage) -> None:
        self.answer_message(caller, fill(self.new_response(), response))

    def answer_message(self, caller: Any, response: RosObject) -> None:
        """Like `answer`, with an object of rclpy."""
        with self._service.handle:
            self._service.handle.service_send_response(response, caller)

    def new_response(self) -> RosObject:
        """An empty response."""
        response: RosObject = self._service.srv_type.Response()
        return response

    def close(self) -> None:
        self._node.destroy_service(self._service)


def plain(message: object) -> Any:
    """A message as a dictionary of its fields."""
    if hasattr(message, "get_fields_and_field_types"):
        return {name: plain(getattr(message, name)) for name in message.get_fields_and_field_types()}
    return [plain(item) for item in message] if isinstance(message, list) else message


def fill(message: RosObject, fields: DecodedMessage) -> RosObject:
    """A message with the fields of a dictionary.

    Raises:
        ValueError, TypeError: a value does not fit its field.
    """
    kinds = message.get_fields_and_field_types()
    for name, value in fields.items():
        if name not in kinds:
            continue  # other versions of the package may have other fields
        present = getattr(message, name)
        try:
            if hasattr(present, "get_fields_and_field_types"):
                fill(present, value)
            elif kinds[name].startswith("sequence<") and "/" in kinds[name]:
                item = _message_class(kinds[name][len("sequence<") : -1].split(",")[0].replace("/", "/msg/"))
                setattr(message, name, [fill(item(), one) for one in value])
            else:
                setattr(message, name, value)
        except AssertionError as error:  # raised by rclpy for a value of a wrong type
            raise TypeError(f"field '{name}': {error}") from None
    return message


def _service_class(type_name: str) -> Any:
    package, _, name = type_name.partition("/srv/")
    try:
        return getattr(import_module(f"{package}.srv"), name)
    except (ImportError, AttributeError):
        return None


class RclpyBackend(Backend):
    """A node called ``morse``."""

    name = "rclpy"
    has_services = takes_threads = True

    def __init__(self, options: Options) -> None:
        self._options = options
        self._other: Backend | None = None
        self._context = Context()
        with _limited(options["interface"]) as reach, nullcontext(Confined()) if reach else confined() as sockets:
            try:
                rclpy.init(args=[], context=self._context, domain_id=options["domain_id"])
                # the services of rclpy would need a thread: see morse.middleware.ros2.parameters
                self._node = rclpy.create_node(
                    NODE, context=self._context, start_parameter_services=False, enable_rosout=False
                )
            except Exception as error:  # rclpy has no common class for errors of an RMW
                raise MorseMiddlewareError(
                    f"ros2: rclpy cannot join the domain {options['domain_id']}: {error}"
                ) from None
        kind = rclpy.get_rmw_implementation_identifier()
        self.opens = f"domain {options['domain_id']}, {kind}, {reach or described(sockets)}"

    def _without_package(self) -> Backend | None:
        """A participant of the same domain for messages whose package ROS does not have; None without cyclonedds."""
        if self._other is None and find_spec("cyclonedds") is not None:
            from morse.middleware.ros2.backends.cyclone import CycloneBackend

            # a name of its own: nodes with the same name confuse the tools of ROS
            self._other = CycloneBackend(self._options, f"{NODE}_messages")
        return self._other

    def tell_graph(self) -> None:
        """See `Backend.tell_graph`."""
        if self._other is not None:
            self._other.tell_graph()

    def has_namesake(self) -> bool:
        """See `Backend.has_namesake`."""
        return self._node.get_node_names_and_namespaces().count((NODE, "/")) > 1  # type: ignore[no-any-return]

    def publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher | None:
        """See `Backend.publisher`."""
        kind = _message_class(type_name)
        if kind is None:
            other = self._without_package()
            return None if other is None else other.publisher(topic, type_name, qos)
        return _Publisher(self._node, self._node.create_publisher(kind, topic, _profile(qos)))

    def subscription(self, topic: str, type_name: str, qos: Qos) -> Subscription | None:
        """See `Backend.subscription`."""
        kind = _message_class(type_name)
        if kind is None:
            other = self._without_package()
            return None if other is None else other.subscription(topic, type_name, qos)
        subscription = self._node.create_subscription(kind, topic, lambda _: None, _profile(qos), raw=True)
        return _Subscription(self._node, subscription, type_name)

    def service(self, name: str, type_name: str) -> ServiceServer | None:
        """See `Backend.service`."""
        kind = _service_class(type_name)
        return None if kind is None else self.typed_service(name, kind)

    def typed_service(self, name: str, kind: object) -> _Service:
        """See `Backend.typed_service`."""
        return _Service(self._node, self._node.create_service(kind, name, lambda request, response: response))

    def typed_publisher(self, topic: str, kind: object, qos: Qos) -> _Publisher:
        """See `Backend.typed_publisher`."""
        return _Publisher(self._node, self._node.create_publisher(kind, topic, _profile(qos)))

    def filled(self, message: RosObject, fields: RosMessage) -> RosObject:
        """See `Backend.filled`."""
        return fill(message, fields)

    def plain(self, message: RosObject) -> Any:
        """See `Backend.plain`."""
        return plain(message)

    def close(self) -> None:
        """See `Backend.close`."""
        if self._other is not None:
            self._other.close()
        self._node.destroy_node()
        self._context.try_shutdown()
