"""The stream of a recorded sensor."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from morse.middleware.ros2.stream import Ros2Stream

if TYPE_CHECKING:
    from collections.abc import Collection


class Single(NamedTuple):
    """The message of a sensor with one message.

    Attributes:
        channel: id of its channel in the file.
        data: the present message.
    """

    channel: int
    data: bytes


class RecordedStream(Ros2Stream):
    """A stream of ROS 2 whose messages may be encoded by a capture instead.

    See `morse.recording.keeping.Captures`.
    """

    @property
    def waiting(self) -> Collection[Any] | None:
        """See `AbstractDatastream.waiting`."""
        captures = self.manager.captures
        return () if captures is not None and captures.is_quiet(self.component_instance) else None

    def single(self, type_name: str) -> Single | None:
        """Return the present message if the sensor has one message of that type; else None."""
        if len(self._sending) != 1 or len(self._sending[0][1]) != 1 or self._odometry is not None:
            return None
        bound, (line,) = self._sending[0]
        number = getattr(line.publisher, "number", None)
        if line.outlet.type != type_name or number is None:
            return None
        message = bound.gather()
        made = line.outlet.make(message, self.frame_id(line.outlet.frame or message.frame))
        return None if made is None else Single(number, self.manager.backend.encode(type_name, made))
