"""The stream of a recorded sensor."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

from morse.core.groups.joining import may_join
from morse.core.kinds.binding import stamp_of
from morse.core.kinds.table import PICTURES
from morse.middleware.ros2.stream import Ros2Stream
from morse.recording.captures.classes import is_captured
from morse.recording.captures.lone import Lone
from morse.rosmsgs.definitions import fields_of

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from morse.core.kinds import BoundKind, Message
    from morse.core.object import Object
    from morse.recording.streams import RecordedStreams
    from morse.rosmsgs.outlets import Outlet


class Single(NamedTuple):
    """The message of a sensor with one message.

    Attributes:
        channel: id of its channel in the file.
        data: the present message.
    """

    channel: int
    data: bytes


class RecordedLine(NamedTuple):
    """A topic of a recorded sensor.

    Attributes:
        bound: the kind of its messages.
        outlet: the topic.
        channel: id of its channel in the file.
        is_stamped: whether its messages begin with a header.
        frame: name of the frame of a message.
        encode: encodes a message, given its fields.
    """

    bound: BoundKind
    outlet: Outlet
    channel: int
    is_stamped: bool
    frame: Callable[[Message], str]
    encode: Callable[[Any], bytes]

    def encoded(self, message: Message) -> bytes | None:
        """The bytes of a message; None if there is nothing to send."""
        made = self.outlet.make(message, self.frame(message))
        return None if made is None else self.encode(made)


class RecordedStream(Ros2Stream):
    """A stream of ROS 2 whose messages may be encoded by a capture instead.

    See `morse.recording.keeping.Captures`.
    """

    manager: RecordedStreams
    #: None: no capture can encode its messages while it acts alone
    _lone: Lone | None = None
    _is_known = False

    def default(self, ci: Object | None = None) -> bool:
        """Publish the messages of a sensor, or leave the messages to a capture."""
        component = self.component_instance
        if component.group is None:
            if not self._is_known:
                self._look_at(component)
            lone = self._lone
            if lone is not None and lone.is_plain():
                captures: Any = self.manager.captures
                lone.stamp = captures.world.stamp
                captures.fire(lone)
                if component in captures.quiet:
                    return False
        return super().default(ci)

    def _look_at(self, component: Object) -> None:
        self._is_known = True
        if self.manager.captures is None:
            return
        if is_captured(component) and may_join(component):
            self._lone = Lone(component)
        elif not self.moves_frames and (lines := self.lines()) and all(line.outlet.is_copy for line in lines):
            self._lone = Lone(component, is_of_data=True)

    def publish_now(self) -> None:
        """Publish the present messages."""
        super().default(self.component_instance)

    @property
    def waiting(self) -> Collection[Any] | None:
        """See `AbstractDatastream.waiting`."""
        captures = self.manager.captures
        return () if captures is not None and self.component_instance in captures.quiet else None

    def stamp(self) -> int:
        """The time of the present measurement, ns."""
        return stamp_of(self.component_instance)

    def lines(self) -> list[RecordedLine] | None:
        """Return its topics in the file; None if a message depends on more than the slots of the component."""
        found = []
        for bound, lines in self.sending:
            for line in lines:
                number, outlet = getattr(line.publisher, "number", None), line.outlet
                if bound.kind.name in PICTURES or (number is None and line.publisher.wanted()):
                    return None
                if number is not None:
                    is_stamped = fields_of(outlet.type)[0].type == "std_msgs/msg/Header"
                    encode = partial(self.manager.backend.encode, outlet.type)
                    found.append(RecordedLine(bound, outlet, number, is_stamped, self._frame_of(outlet), encode))
        return found

    def _frame_of(self, outlet: Outlet) -> Callable[[Message], str]:
        return lambda message: self.frame_id(outlet.frame or message.frame)

    def single(self, type_name: str) -> Single | None:
        """Return the present message if the sensor has one message of that type; else None."""
        if len(self.sending) != 1 or len(self.sending[0][1]) != 1 or self.moves_frames:
            return None
        bound, (line,) = self.sending[0]
        number = getattr(line.publisher, "number", None)
        if line.outlet.type != type_name or number is None or bound.is_silent:
            return None
        message = bound.gather()
        made = line.outlet.make(message, self.frame_id(line.outlet.frame or message.frame))
        return None if made is None else Single(number, self.manager.backend.encode(type_name, made))
