"""Messages of sensors that act together: the tick keeps their data, and another thread encodes and sends them."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple
from weakref import WeakKeyDictionary

from morse.core.groups.joining import has_group_action

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.core.context import Context
    from morse.core.groups.group import Group, Kept
    from morse.core.kinds import BoundKind
    from morse.rosmsgs.topics.sending import Sender
    from morse.rosmsgs.topics.stream import Sending, TopicStream


class _Line(NamedTuple):
    """The messages of one kind of one sensor.

    Attributes:
        row: row of the sensor in its group.
        topics: each topic, and the frame of its messages.
    """

    row: int
    stream: TopicStream
    bound: BoundKind
    topics: Sequence[tuple[Sending, str]]


class Together:
    """Sends the messages of groups of sensors.

    Args:
        context: of the simulation.
        sender: the thread, or the tick if the simulation is not paced.
        wants_frames: whether somebody needs the frames that odometry moves.
    """

    def __init__(self, context: Context, sender: Sender, wants_frames: Callable[[], bool]) -> None:
        self._context, self._sender, self._wants_frames = context, sender, wants_frames
        self._streams: dict[Any, list[TopicStream]] = {}
        self._plans: WeakKeyDictionary[Group, tuple[list[int], list[_Line], list[TopicStream]]] = WeakKeyDictionary()
        self._displacements = -1
        context.group_taps.append(self._measured)

    def close(self) -> None:
        """Send nothing more."""
        if self._measured in self._context.group_taps:
            self._context.group_taps.remove(self._measured)

    # -- streams -----------------------------------------------------------------------------

    def takes(self, stream: TopicStream, sending: Sequence[tuple[BoundKind, Sequence[Sending]]]) -> bool:
        """Whether the messages of a stream follow from the data of its sensor; the stream is then silent in a group."""
        component = stream.component_instance
        lines = [line for _, lines in sending for line in lines]
        taken = (
            has_group_action(type(component))
            and bool(lines)
            and all(line.outlet.is_detached for line in lines)
            # those of other components, and of the robot
            and all(bound.component is component and bound.needs is not None for bound, _ in sending)
        )
        if taken:
            self._streams.setdefault(component, []).append(stream)
        return taken

    def remove(self, stream: TopicStream) -> None:
        """Remove a stream."""
        component = stream.component_instance
        left = [one for one in self._streams.pop(component, ()) if one is not stream]
        if left:
            self._streams[component] = left
        self._plans.clear()

    # -- the tick ----------------------------------------------------------------------------

    def _measured(self, group: Group) -> None:
        plan = self._plans.get(group)
        if plan is None or self._context.world.displacements != self._displacements:
            self._renew()
            plan = self._plans[group] = self._plan(group)
        rows, lines, others = plan
        for stream in others:
            try:
                stream.default(stream.component_instance)
            except BaseException as error:
                self._context.guard.close(
                    stream.component_instance, stream.component_instance.output_functions, stream, error
                )
        if rows:
            moves = any(line.stream.moves_frames for line in lines) and self._wants_frames()
            self._sender.do(partial(self._send, group.keep(rows), lines, moves))

    def _renew(self) -> None:
        displacements = self._context.world.displacements
        if displacements != self._displacements:
            self._displacements = displacements
            self._sender.finish()  # the messages that wait are those of sensors in their former places
            self._plans.clear()

    def _plan(self, group: Group) -> tuple[list[int], list[_Line], list[TopicStream]]:
        written = group.written()
        rows: list[int] = []
        lines: list[_Line] = []
        others: list[TopicStream] = []
        for row, member in enumerate(group.members):
            for stream in self._streams.get(member, ()):
                if not stream.is_ready(written):
                    others.append(stream)
                    continue
                rows.append(row)
                for bound, topics in stream.sending:
                    named = [
                        (stream.detached(topic), stream.frame_id(topic.outlet.frame or bound.frame)) for topic in topics
                    ]
                    lines.append(_Line(row, stream, bound, named))
        return rows, lines, others

    # -- in the thread -----------------------------------------------------------------------

    def _send(self, kept: Kept, lines: Sequence[_Line], moves: bool) -> None:
        for line in lines:
            try:
                self._send_line(kept, line, moves)
            except BaseException as error:
                self._sender.failures.append((line.stream, error))

    @staticmethod
    def _send_line(kept: Kept, line: _Line, moves: bool) -> None:
        row, stream, bound, topics = line
        wanted = [one for one in topics if one[0].publisher.wanted()]
        moved = moves and stream.moves_frames
        if wanted or moved:
            message = bound.gather_from(kept.data(row), kept.stamp)
            if moved:
                stream.move_frames(message)
            for topic, frame in wanted:
                stream.send(topic, message, frame)
