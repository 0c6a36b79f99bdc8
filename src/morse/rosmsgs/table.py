"""The topics of message kinds: published (outlets) and subscribed ones (inlets), and the tables of each kind."""

from __future__ import annotations

import logging
from functools import lru_cache
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol, TypeVar

from morse.core.classes.plugins import PluginError, entry_points, load
from morse.core.kinds.table import GENERAL, KINDS
from morse.core.mapping import IN, OUT, mapped_kinds, maps
from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from importlib.metadata import EntryPoint

    from morse.core.kinds import BoundKind, Message
    from morse.core.values import DecodedMessage, RosMessage


class Qos(NamedTuple):
    """Quality of service of a topic.

    Attributes:
        depth: number of messages that are kept.
        reliable: lost messages are sent again.
        latched: a subscriber that joins later gets the last messages, too (durability transient local).
        history: number of large messages that a writer of DDS keeps for readers that are behind; 0 for its usual one.
    """

    depth: int = 10
    reliable: bool = True
    latched: bool = False
    history: int = 0


COMMAND = Qos(1)


class Outlet(NamedTuple):
    """A topic that publishes a kind.

    Attributes:
        type: type of its messages.
        make: converts a message of the component; None if there is nothing to send. It is called with the frame.
        topic: relative to that of the component; empty for the topic of the component.
        qos: quality of service.
        frame: a name of `morse.core.declarations.FRAMES`, or ``down``; empty for the frame of the message.
        instead: outlet that is used if the backend does not have the type.
        or_none: nothing is published if the backend does not have the type.
        takes_long: `make` takes so long that it is called in another thread while the simulation is paced by the wall
            clock. It must then use nothing but the message, whose arrays do not change.
        is_of_robot: whether `make` is `Carrier.odometry`, which depends on the pose of the sensor on the robot.
        is_detached: `make` uses nothing but the message, and the pose of a sensor in its rigid group; they
            take vectors as sequences of numbers, too. Another thread may call them later.
        by_rows: `make` uses nothing but the message, and also takes many messages at once, whose slots have a first
            axis of rows; words are the same in all rows.
    """

    type: str
    make: Callable[[Message, str], RosMessage | None]
    topic: str = ""
    qos: Qos = Qos()
    frame: str = ""
    instead: Any = None
    or_none: bool = False
    takes_long: bool = False
    is_of_robot: bool = False
    is_detached: bool = False
    by_rows: bool = False


class Inlet(NamedTuple):
    """A topic that commands a component.

    Attributes:
        type: type of its messages.
        take: converts a message to slots by name.
        topic: relative to that of the component; empty for the topic of the component.
        also: below the namespace of the robot, for the first component of the robot with this inlet.
        or_none: nothing is subscribed to if the backend does not have the type.
        other: used instead as soon as somebody sends messages of its type, and nobody those of this type.
        call: the service of the component that a message calls, and its arguments; None if it is read by `take`.
    """

    type: str
    take: Callable[[DecodedMessage], RosMessage]
    topic: str = ""
    also: str = ""
    or_none: bool = False
    other: Inlet | None = None
    call: Callable[[DecodedMessage], tuple[str, list[object]] | None] | None = None


_F = TypeVar("_F", bound="Callable[..., object]")

#: attribute of a method that describes topics
_MARK = "_morse_topics"


class Carrier(Protocol):
    """The component whose messages are carried, as the methods of a table see it."""

    @property
    def component_name(self) -> str:
        """Name of the component."""

    @property
    def kwargs(self) -> Mapping[str, object]:
        """Options of the stream."""

    @property
    def kinds(self) -> Sequence[BoundKind]:
        """All message kinds of the component."""

    def odometry(self, message: Message, frame: str) -> RosMessage:
        """``nav_msgs/Odometry`` of the robot."""


def topics(*kinds: str, direction: str = OUT) -> Callable[[_F], _F]:
    """Declare that a method of a `TopicTable` describes the topics of some kinds.

    It is called with the `Carrier` and the `BoundKind`, and returns instances of `Outlet`; with ``direction="IN"``
    instances of `Inlet`.
    """
    return maps(*kinds, direction=direction, mark=_MARK)


class TopicTable:
    """The topics of all kinds."""

    _methods: ClassVar[dict[tuple[str, str], str]] = {}

    def __init_subclass__(cls, **kwargs: object) -> None:
        super().__init_subclass__(**kwargs)
        cls._methods = mapped_kinds(cls, _MARK, needs_general=False)

    @classmethod
    def has(cls, kind: str, direction: str = OUT) -> bool:
        """Whether a method names the kind."""
        return (kind, direction) in cls._methods

    def outlets(self, carrier: Carrier, bound: BoundKind) -> list[Outlet]:
        """The topics that publish a kind; those of ``general`` for a kind that no method names."""
        return self._ports(carrier, bound, OUT)  # type: ignore[return-value]

    def inlets(self, carrier: Carrier, bound: BoundKind) -> list[Inlet]:
        """The topics for commands of a kind."""
        return self._ports(carrier, bound, IN)  # type: ignore[return-value]

    def _ports(self, carrier: Carrier, bound: BoundKind, direction: str) -> list[Outlet] | list[Inlet]:
        kind = bound.kind.name
        name = self._methods.get((kind, direction))
        if name is None and kind not in KINDS:
            for extension in extensions():
                if extension.topics.has(kind, direction):
                    return extension.topics._ports(carrier, bound, direction)
        name = name or self._methods.get((GENERAL, direction))
        return [] if name is None else list(getattr(self, name)(carrier, bound))


class RosExtension(NamedTuple):
    """What a package adds to the messages of ROS: an entry point ``morse.ros_messages`` names one.

    Attributes:
        topics: the topics of its message kinds (``morse.kinds``). Kinds of MORSE keep their topics.
        messages: the definitions of messages that MORSE does not have, a line for each, as in
            `morse.rosmsgs.definitions`: ``my_msgs/Scan: std_msgs/Header header, my_msgs/Echo[] echoes``; a message
            follows those that it contains.
    """

    topics: TopicTable
    messages: str = ""


logger = logging.getLogger(__name__)


def extensions() -> list[RosExtension]:
    """The extensions of all installed packages."""
    found = (_loaded(point) for point in entry_points("morse.ros_messages"))
    return [extension for extension in found if extension is not None]


@lru_cache(maxsize=64)
def _loaded(point: EntryPoint) -> RosExtension | None:
    try:
        return load(point, _checked)
    except PluginError as error:  # a broken package must not prevent loading the others
        logger.warning("the ROS messages of %s are left out: %s", point.value, error, extra=OF_MACHINE)
        return None


def _checked(entry: object) -> RosExtension:
    if isinstance(entry, RosExtension) and isinstance(entry.topics, TopicTable) and isinstance(entry.messages, str):
        return entry
    raise TypeError(f"expected a morse.rosmsgs.table.RosExtension, got {type(entry).__name__}")
