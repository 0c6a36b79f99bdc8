"""What a message kind becomes: topics that are published (outlets), and topics that are heard (inlets)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from morse.middleware.ros2.backends.backend import Qos

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from morse.core.kinds import Message

COMMAND = Qos(1)
#: clouds and images: more of them would fill the memory of slow readers
LARGE = Qos(2)


class Outlet(NamedTuple):
    """A topic that carries a kind.

    Attributes:
        type: of its messages.
        make: the message for one of the component; None if there is nothing to send. It is called with the frame.
        topic: below that of the component; empty for that itself.
        qos: quality of service.
        frame: a name of `morse.core.declarations.FRAMES`, or ``down``; empty for that of the message of the component.
        instead: what is published if the backend has no such type.
        or_none: nothing is published if the backend has no such type.
    """

    type: str
    make: Callable[[Message, str], dict[str, Any] | None]
    topic: str = ""
    qos: Qos = Qos()
    frame: str = ""
    instead: Any = None
    or_none: bool = False


class Inlet(NamedTuple):
    """A topic that commands a component.

    Attributes:
        type: of its messages.
        take: slots by name for a message.
        topic: below that of the component; empty for that itself.
        also: below the namespace of the robot, for the first component of the robot that has this inlet.
    """

    type: str
    take: Callable[[Mapping[str, Any]], dict[str, Any]]
    topic: str = ""
    also: str = ""
