"""Topics by rclpy, the client library of a ROS 2 installation.

Messages stay bytes, as on the other backend: rclpy sends and gives them as they are. Nothing is spun: what has
arrived is taken from the subscriptions when the simulation asks for it.
"""

from __future__ import annotations

import os
from contextlib import contextmanager, nullcontext
from importlib import import_module
from typing import TYPE_CHECKING, Any, NoReturn

import rclpy
from rclpy.context import Context
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from morse.core.exceptions import MorseMiddlewareError
from morse.middleware.ros2.backends.backend import Backend, Publisher, Qos, Subscription
from morse.middleware.ros2.backends.loopback import Confined, confined, described

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

_LOOPBACK = ("", "lo", "127.0.0.1", "localhost")
#: variables by which the user has said how far ROS reaches
_REACH = ("ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOCALHOST_ONLY")
#: distributions with another variable for it
_BEFORE_IRON = ("foxy", "galactic", "humble")
#: messages that are taken in one tick
_MOST = 64


@contextmanager
def _limited(interface: str) -> Iterator[str]:
    """While the block runs, ROS is told to stay on this machine unless somebody has said otherwise.

    Yields:
        What the log says of it; nothing if it is to stay.
    """
    said = [f"{name}={os.environ[name]}" for name in _REACH if os.environ.get(name)]
    if said:
        yield ", ".join(said)
    elif interface in _LOOPBACK:
        old = os.environ.get("ROS_DISTRO", "") in _BEFORE_IRON
        name, value = ("ROS_LOCALHOST_ONLY", "1") if old else ("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        os.environ[name] = value
        try:
            yield ""
        finally:  # other simulations of this process, and programs that it starts, are not meant
            del os.environ[name]
    elif interface == "any":
        yield "all interfaces"
    else:
        _refuse(interface)


def _refuse(interface: str) -> NoReturn:
    raise MorseMiddlewareError(
        f"ros2: rclpy cannot be told the interface {interface!r}; say interface='any' and choose it by the settings of "
        "your RMW, or say backend='cyclonedds'"
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
    except ImportError:
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
    def __init__(self, node: Any, subscription: Any) -> None:
        self._node, self._subscription = node, subscription

    def take(self) -> list[bytes]:
        subscription = self._subscription
        found: list[bytes] = []
        with subscription.handle:
            while len(found) < _MOST:
                taken = subscription.handle.take_message(subscription.msg_type, True)
                if taken is None:
                    break
                found.append(bytes(taken[0]))
        return found

    def close(self) -> None:
        self._node.destroy_subscription(self._subscription)


class RclpyBackend(Backend):
    """A node called ``morse``."""

    name = "rclpy"

    def __init__(self, options: Mapping[str, Any]) -> None:
        self._context = Context()
        with _limited(options["interface"]) as reach, nullcontext(Confined()) if reach else confined() as sockets:
            try:
                rclpy.init(args=[], context=self._context, domain_id=options["domain_id"])
                # services of parameters would need a thread, and a simulation has no parameters
                self._node = rclpy.create_node(
                    "morse", context=self._context, start_parameter_services=False, enable_rosout=False
                )
            except Exception as error:  # rclpy has no common class for what can fail in an RMW
                raise MorseMiddlewareError(
                    f"ros2: rclpy cannot join the domain {options['domain_id']}: {error}"
                ) from None
        kind = rclpy.get_rmw_implementation_identifier()
        self.opens = f"domain {options['domain_id']}, {kind}, {reach or described(sockets)}"

    def publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher | None:
        """See `Backend.publisher`."""
        kind = _message_class(type_name)
        return None if kind is None else _Publisher(self._node, self._node.create_publisher(kind, topic, _profile(qos)))

    def subscription(self, topic: str, type_name: str, qos: Qos) -> Subscription | None:
        """See `Backend.subscription`."""
        kind = _message_class(type_name)
        if kind is None:
            return None
        made = self._node.create_subscription(kind, topic, lambda _: None, _profile(qos), raw=True)
        return _Subscription(self._node, made)

    def close(self) -> None:
        """See `Backend.close`."""
        self._node.destroy_node()
        self._context.try_shutdown()
