"""The topics of message kinds: published (outlets) and subscribed ones (inlets), and the tables of each kind."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol, TypeVar

from morse.core.kinds.table import GENERAL
from morse.core.mapping import IN, OUT, mapped_kinds, maps

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

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
        methods = self._methods
        name = methods.get((bound.kind.name, direction)) or methods.get((GENERAL, direction))
        return [] if name is None else list(getattr(self, name)(carrier, bound))
