"""The topics of a message kind: published topics (outlets), and subscribed topics (inlets)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from morse.rosmsgs.qos import Qos

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.kinds import Message
    from morse.core.values import RosMessage

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
        numbers: for messages of a header and a fixed number of numbers: returns these, which `make` describes by name.
        has_child: whether the message has a ``child_frame_id`` after the header.
        is_detached: `make` and `numbers` use nothing but the message, and the pose of a sensor in its rigid group; they
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
    numbers: Callable[[Message], tuple[float, ...]] | None = None
    has_child: bool = False
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
    take: Callable[[RosMessage], RosMessage]
    topic: str = ""
    also: str = ""
    or_none: bool = False
    other: Inlet | None = None
    call: Callable[[RosMessage], tuple[str, list[Any]] | None] | None = None
