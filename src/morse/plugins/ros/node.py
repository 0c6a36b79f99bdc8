"""The rospy node of this process."""

from __future__ import annotations

import logging
import os
import re
import socket
import threading
import time
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from morse.core.clients.complaints import Complaints, Waiting
from morse.core.exceptions import MorseMiddlewareError
from morse.plugins.ros.mapping import MEND
from morse.rosmsgs.topics.backend import Backend, Publisher, Subscription
from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from collections.abc import MutableMapping
    from types import ModuleType

    from morse.core.clients.budgets import Arrivals
    from morse.core.values import RosMessage, Value
    from morse.rosmsgs.table import Qos
    from morse.rosmsgs.topics.backend import RosClass


#: fields that were renamed in ROS 2, by package and message
_RENAMED = {"sensor_msgs/CameraInfo": {"d": "D", "k": "K", "r": "R", "p": "P"}}
_TIMES = ("time", "duration")


@cache
def message_class(type_name: str) -> Any:
    """The class of a type such as ``sensor_msgs/msg/Image``; None if its package is not installed."""
    package, _, name = type_name.replace("/msg/", "/").replace("/srv/", "/").partition("/")
    folder = "srv" if "/srv/" in type_name else "msg"
    try:
        return getattr(import_module(f"{package}.{folder}"), name, None)
    except ImportError:
        return None


def message(type_name: str, fields: RosMessage) -> Any:
    """A message with some fields; fields that ROS 1 does not have are ignored.

    Raises:
        ValueError, TypeError: a value does not fit its field.
    """
    instance = message_class(type_name)()
    names = _RENAMED.get(instance._type, {})
    kinds = dict(zip(instance.__slots__, instance._slot_types, strict=True))
    if instance._type == "geometry_msgs/Quaternion":
        instance.w = 1.0  # the default of ROS 1 is all zeros, which is not a rotation
    for key, value in fields.items():
        name = names.get(key, key)
        if name in kinds and value is not None:
            setattr(instance, name, _value(kinds[name], value))
    return instance


def _value(kind: str, value: Value) -> object:
    base, bracket, _ = kind.partition("[")
    if base in _TIMES:
        import genpy

        time_class = genpy.Time if base == "time" else genpy.Duration
        return time_class(value.get("sec", 0), value.get("nanosec", 0))
    if bracket:
        if "/" in base:
            return [message(base, one) for one in value]
        return bytes(value) if base in ("uint8", "char") else value
    return message("std_msgs/Header" if base == "Header" else base, value) if "/" in base or base == "Header" else value


def plain(value: Any) -> Any:
    """A message as a dictionary with the names of ROS 2."""
    if hasattr(value, "secs"):
        return {"sec": value.secs, "nanosec": value.nsecs}
    if hasattr(value, "_slot_types"):
        back = {new: old for old, new in _RENAMED.get(value._type, {}).items()}
        return {back.get(name, name): plain(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, bytes):
        import numpy as np

        return np.frombuffer(value, dtype=np.uint8)
    return value


logger = logging.getLogger(__name__)

#: wall-clock seconds between two questions to the master
_INTERVAL = 1.0


class MasterWatch:
    """Asks the master from time to time whether it knows this process; in a thread of its own.

    Args:
        rospy: the module, after the process has become a node.
    """

    def __init__(self, rospy: ModuleType) -> None:
        self._rospy = rospy
        self._is_there = True

    def start(self) -> None:
        """Start the thread, which ends with the process."""
        threading.Thread(target=self._run, name="morse-ros-master", daemon=True).start()

    def _run(self) -> None:
        while not self._rospy.is_shutdown():
            time.sleep(_INTERVAL)
            self.look()

    def look(self) -> None:
        """Ask once, and register everything again if a new master has taken the place of the former one."""
        import rosgraph

        name = self._rospy.get_name()
        try:
            rosgraph.Master(name).lookupNode(name)
        except rosgraph.MasterError:
            self._is_there = True
            count = register_again()
            logger.warning(
                "ros: the master at %s was started again: %d topics and services are registered again",
                _uri(),
                count,
                extra=OF_MACHINE,
            )
        except Exception as error:  # the errors of sockets, of HTTP and of XML
            if self._is_there:
                self._is_there = False
                logger.warning(
                    "ros: there is no master at %s (%s); the simulation goes on, and new nodes do not find it until a "
                    "master is started",
                    _uri(),
                    error,
                    extra=OF_MACHINE,
                )
        else:
            self._is_there = True


def register_again() -> int:
    """Register all topics and services of this process with the master; returns their number."""
    from rospy.impl import registration

    listeners = registration.get_registration_listeners()
    kinds = registration.Registration
    topics, services = registration.get_topic_manager(), registration.get_service_manager()
    entries = [
        *((name, kind, kinds.PUB) for name, kind in topics.get_publications()),
        *((name, kind, kinds.SUB) for name, kind in topics.get_subscriptions()),
        *((name, uri, kinds.SRV) for name, uri in services.get_services()),
    ]
    for one in entries:
        listeners.notify_added(*one)
    return len(entries)


def _uri() -> str:
    return os.environ.get("ROS_MASTER_URI", "")


#: maximum number of messages of a topic that wait for the next tick
_WAITING = 64
_joining = threading.Lock()


def join(name: str | None = None) -> Any:
    """The module rospy, after this process has become a node.

    Args:
        name: of this simulation node.

    Raises:
        MorseMiddlewareError: rospy cannot be imported, or there is no master.
    """
    try:
        import rosgraph
        import rospy
    except ImportError as error:
        raise MorseMiddlewareError(f"ros: rospy cannot be imported ({error}). {MEND}") from None
    with _joining:
        if rospy.core.is_initialized():
            return rospy
        if not rosgraph.is_master_online():
            uri = os.environ.get("ROS_MASTER_URI", "http://localhost:11311")
            raise MorseMiddlewareError(f"ros: there is no master at {uri} (ROS_MASTER_URI): start it with 'roscore'")
        stay_on_this_machine(os.environ)
        before = logging.root.level, list(logging.root.handlers)
        suffix = f"_{re.sub(r'[^A-Za-z0-9_]', '_', name)}" if name else ""
        rospy.init_node(f"morse{suffix}", disable_signals=True)
        # rospy configures the logging of the whole process
        logging.root.level, logging.root.handlers[:] = before[0], before[1]
        MasterWatch(rospy).start()
    return rospy


def stay_on_this_machine(variables: MutableMapping[str, str]) -> None:
    """Have rospy listen on the loopback interface alone, unless the user has chosen an address.

    rospy listens on all networks otherwise. Nodes of other machines reach this node only if the user sets ``ROS_IP`` or
    ``ROS_HOSTNAME``, or if the master is on another machine.

    Args:
        variables: the environment of the process, which rospy reads.
    """
    if variables.get("ROS_IP") or variables.get("ROS_HOSTNAME"):
        return
    master = urlsplit(variables.get("ROS_MASTER_URI", "")).hostname or "localhost"
    if master in ("localhost", "::1", socket.gethostname()) or master.startswith("127."):
        variables["ROS_IP"] = "127.0.0.1"
    else:
        logger.warning(
            "ros: the master is on %s, so that rospy listens on all networks of this machine: "
            "set ROS_IP to the address on which it is to listen",
            master,
            extra=OF_MACHINE,
        )


class _Publisher(Publisher):
    def __init__(self, publisher: Any) -> None:
        self._publisher = publisher

    def publish(self, data: Any) -> bool:
        self._publisher.publish(data)
        return True

    def wanted(self) -> bool:
        return bool(self._publisher.get_num_connections())

    def close(self) -> None:
        self._publisher.unregister()


class _Latched(_Publisher):
    """Later subscribers receive the last message: it is always needed."""

    def wanted(self) -> bool:
        return True


class _Subscription(Subscription):
    def __init__(self, rospy: ModuleType, topic: str, kind: RosClass, arrivals: Arrivals) -> None:
        complaints = Complaints(logger)
        self._inbox: Waiting[object] = Waiting(_WAITING, complaints, f"ros: {topic}", "messages")
        self._arrivals = arrivals
        self._subscriber = rospy.Subscriber(topic, kind, self._arrive, queue_size=_WAITING)

    def _arrive(self, message: object) -> None:
        """Queue a message; in the thread of rospy that receives from its publisher."""
        self._inbox.append(message)
        self._arrivals.received()

    def take(self) -> list[Any]:
        return [self._inbox.popleft() for _ in range(len(self._inbox))]

    def close(self) -> None:
        self._subscriber.unregister()


class RospyBackend(Backend):
    """Topics of rospy. Messages are objects of rospy, not bytes.

    Args:
        name: of this simulation node.
        arrivals: the share of the time for what other nodes send.
    """

    name = "rospy"
    takes_threads = True

    def __init__(self, name: str | None, arrivals: Arrivals) -> None:
        self._arrivals = arrivals
        self._rospy = join(name)
        self.opens = f"node {self._rospy.get_name()}, master {os.environ.get('ROS_MASTER_URI')}"

    def encode(self, type_name: str, fields: RosMessage) -> Any:
        """See `Backend.encode`."""
        return message(type_name, fields)

    def decode(self, type_name: str, data: object) -> RosMessage:
        """See `Backend.decode`."""
        message: RosMessage = plain(data)
        return message

    def publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher | None:
        """See `Backend.publisher`."""
        kind = message_class(type_name)
        return None if kind is None else self.publisher_of(topic, kind, qos)

    def publisher_of(self, topic: str, kind: object, qos: Qos) -> Publisher:
        """A topic with messages of a class of rospy."""
        publisher = self._rospy.Publisher(topic, kind, queue_size=qos.depth, latch=qos.latched)
        return _Latched(publisher) if qos.latched else _Publisher(publisher)

    def subscription(self, topic: str, type_name: str, qos: Qos) -> Subscription | None:
        """See `Backend.subscription`."""
        kind = message_class(type_name)
        return None if kind is None else self.subscription_of(topic, kind)

    def subscription_of(self, topic: str, kind: RosClass) -> Subscription:
        """Receives messages of a class of rospy."""
        return _Subscription(self._rospy, topic, kind, self._arrivals)

    def close(self) -> None:
        """See `Backend.close`; a process remains a rospy node until it ends."""
