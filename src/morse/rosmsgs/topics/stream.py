"""The stream of a component: its messages on topics."""

from __future__ import annotations

import logging
import struct
from functools import cache, partial
from struct import calcsize
from typing import TYPE_CHECKING, NamedTuple
from zlib import crc32

import numpy as np

from morse.core.exceptions import MorseError
from morse.core.journal import CALL
from morse.core.streams.kind_stream import KindStream
from morse.rosmsgs.cdr import CdrError
from morse.rosmsgs.component import ComponentMessages, kinds_of
from morse.rosmsgs.definitions import PRIMITIVES, SEQUENCE, fields_of
from morse.rosmsgs.names import STREAM_OPTIONS
from morse.rosmsgs.parts import pose_of, product, quaternion_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sized

    from morse.core.kinds import BoundKind, Message
    from morse.core.values import DecodedMessage
    from morse.rosmsgs.table import Inlet, Outlet
    from morse.rosmsgs.topics.backend import Publisher, Subscription
    from morse.rosmsgs.topics.manager import TopicManager

#: size of a message with lists, bytes: more than ten thousand names of joints, whose decoding takes some ticks
_LARGEST = 1 << 19
#: a message without lists may have this multiple of its usual size: texts, and the text of numbers in JSON, are longer
_MULTIPLE, _LEAST = 100, 1 << 13
#: usual length of a text
_TEXT = 16


@cache
def largest(type_name: str) -> int:
    """The size up to which a message of a type is decoded, bytes."""
    usual = _usual(type_name)
    return _LARGEST if usual is None else min(_LARGEST, max(_LEAST, _MULTIPLE * usual))


def check_size(type_name: str, data: object) -> None:
    """Refuse a message that is too large for its type.

    Raises:
        CdrError: it is.
    """
    if isinstance(data, (bytes, str)) and len(data) > largest(type_name):
        raise CdrError(f"it has {len(data)} bytes; a {type_name} of at most {largest(type_name)} is accepted")


def _usual(type_name: str) -> int | None:
    """The usual size of a message; None if it has a list."""
    size = 0
    for field in fields_of(type_name):
        if field.size == SEQUENCE:
            return None
        one = _TEXT if field.type == "string" else calcsize(PRIMITIVES.get(field.type, "x"))
        if field.type != "string" and field.type not in PRIMITIVES:
            inner = _usual(field.type)
            if inner is None:
                return None
            one = inner
        size += one * max(field.size, 1)
    return size


logger = logging.getLogger(__name__)

#: number of actions without a message after which a stream checks for senders of another type
_PATIENCE = 60
_UNFIT = (ValueError, TypeError, OverflowError, struct.error, RecursionError)


class Sending(NamedTuple):
    """A topic that a stream publishes."""

    topic: str
    outlet: Outlet
    publisher: Publisher


class _Hearing(NamedTuple):
    topic: str
    bound: BoundKind
    inlet: Inlet
    subscription: Subscription


class _Readers:
    """The readers of the messages of a stream: false without any."""

    def __init__(self, stream: TopicStream) -> None:
        self._stream = stream

    def __len__(self) -> int:
        return self._stream.has_readers


class TopicStream(KindStream, ComponentMessages):
    """Sends the messages of a component on their topics, or writes received messages into the component."""

    options = STREAM_OPTIONS
    manager: TopicManager

    def initialize(self) -> None:
        """Open the topics.

        Raises:
            MorseMiddlewareError: a topic is in use, or has a name that ROS does not allow.
        """
        super().initialize()
        self.name_frames(self.manager.names)
        self._sender = self.manager.context.arrivals.sender()
        # streams check in different ticks
        self._silence = crc32(self.component_name.encode()) % _PATIENCE
        self.sending: list[tuple[BoundKind, list[Sending]]] = []
        self._hearing: list[_Hearing] = []
        if self.direction == "IN":
            self._hearing = [
                _Hearing(topic, bound, inlet, subscription)
                for bound in self.kinds
                for inlet in self.table.inlets(self, bound)
                for topic, subscription in self.manager.hear(self, bound, inlet)
            ]
        else:
            self._offer_all()
        self._readers = _Readers(self) if self._commands is None else None

    def find_kinds(self) -> tuple[BoundKind, ...]:
        """See `KindStream.find_kinds`."""
        return kinds_of(self.component_instance, self.kwargs)

    def _offer_all(self) -> None:
        self.sending = [(bound, self._offered(bound, outlets)) for bound, outlets in self.outlets()]
        self._lines: dict[str, list[Sending]] = {}
        for bound, lines in self.sending:
            self._lines.setdefault(bound.topic, []).extend(lines)
        moving = [bound.topic for bound in self.kinds if bound.kind.name == "odometry"]
        #: sub-topic of the messages that move the robot in the tree of frames
        self._moving = moving[0] if moving and self.gives_transform else None
        self.manager.robots.add(self)
        # a scene that was not made for ROS may have two odometry sensors
        self.manager.transforms.add(self, lenient="ros2" in self.manager.context.scene.interfaces)

    def _offered(self, bound: BoundKind, outlets: list[Outlet]) -> list[Sending]:
        offers = [self.manager.offer(self, self.topic_of(bound, outlet), outlet) for outlet in outlets]
        return [Sending(*offer) for offer in offers if offer is not None]

    def frames(self) -> set[str]:
        """The frames of the messages of the component, on all of their topics."""
        frame_names = {line.outlet.frame for _, lines in self.sending for line in lines if line.outlet.frame}
        return super().frames() | frame_names

    # -- readers -----------------------------------------------------------------------------

    @property
    def waiting(self) -> Sized | None:
        """See `AbstractDatastream.waiting`."""
        return self._readers

    @property
    def moves_frames(self) -> bool:
        """Whether the frame of the robot follows from its messages."""
        return self._moving is not None

    @property
    def has_readers(self) -> bool:
        """Whether somebody reads a message, or the frame that follows from one."""
        return any(self.has_reader(topic) or self.moves(topic) for topic in self._lines)

    def _detached(self, line: Sending) -> Sending:
        """A topic whose messages another thread may make: with the present pose of the sensor on the robot."""
        if not line.outlet.is_of_robot:
            return line
        make = partial(self.odometry, mounting=self.mounting())
        return line._replace(outlet=line.outlet._replace(make=make))

    # -- publishing --------------------------------------------------------------------------

    def moves(self, topic: str) -> bool:
        """Whether somebody wants the frame of the robot, which follows from the messages of a sub-topic."""
        return topic == self._moving and self.manager.wants_transforms()

    def has_reader(self, topic: str) -> bool:
        """Whether somebody reads a message of a sub-topic."""
        # a loop takes half the time of a generator
        for line in self._lines.get(topic, ()):  # noqa: SIM110
            if line.publisher.wanted():
                return True
        return False

    def publish(self, message: Message) -> None:
        """Send a message on all of its topics that somebody reads."""
        if self.moves(message.topic):
            pose = self.motion(message).pose
            self.manager.sender.do(partial(self.manager.transforms.moved, self, pose))
        for line in self._lines.get(message.topic, ()):
            if not line.publisher.wanted():
                continue
            frame = self.frame_id(line.outlet.frame or message.frame)
            if line.outlet.takes_long or line.outlet.is_detached:
                self.manager.sender.do(partial(self.send, self._detached(line), message.complete(), frame), self)
            else:
                self.send(line, message, frame)

    def send(self, line: Sending, message: Message, frame: str) -> None:
        """Encode and send a message."""
        try:
            content = line.outlet.make(message, frame)
            if content is None:
                return
            data = self.manager.backend.encode(line.outlet.type, content)
        except _UNFIT as error:
            self.complain(
                f"encode {line.topic}",
                f"a message for {line.topic} is not a valid {line.outlet.type} and is omitted: {error}",
            )
            return
        if not line.publisher.publish(data):
            self.complain(f"slow {line.topic}", f"a reader of {line.topic} is too slow: a message is lost")

    # -- commands ----------------------------------------------------------------------------

    def arrived(self) -> Iterable[object]:
        """See `KindStream.arrived`: what has arrived, unless it took more than its share of the time."""
        if not self._sender.rests:
            self._take()
        return super().arrived()

    def _take(self) -> None:
        silent = True
        for hearing in self._hearing:
            messages = hearing.subscription.take()
            if messages:
                silent = False
                with self._sender.measured():
                    for data in messages:
                        self._take_message(hearing, data)
        if silent:
            self._look_for_others()
        elif self.manager.context.paced():
            self._sender.rest_if_due()

    def _look_for_others(self) -> None:
        """If no messages arrive, warn about senders of messages of another type, which are not received."""
        self._silence += 1
        if self._silence % _PATIENCE:
            return
        for hearing in list(self._hearing):
            others = hearing.subscription.other_types()
            if hearing.inlet.other is not None and hearing.inlet.other.type in others and self._change(hearing):
                continue
            for other in sorted(others):
                self.complain(
                    f"type {hearing.topic}",
                    f"somebody sends {other} on {hearing.topic}, which takes {hearing.inlet.type}",
                )

    def _change(self, hearing: _Hearing) -> bool:
        """Take the other type of messages on a topic; False if the backend does not have it."""
        before, after = hearing.inlet, hearing.inlet.other
        assert after is not None
        kind, subscription = self.manager.change_type(self, hearing.topic, before.type, after.type)
        inlet = before._replace(other=None)
        if kind == after.type:
            inlet = after._replace(other=inlet)
            logger.info("%s: %s takes %s now, which somebody sends", self.component_name, hearing.topic, kind)
        self._hearing[self._hearing.index(hearing)] = hearing._replace(inlet=inlet, subscription=subscription)
        return kind == after.type

    def _take_message(self, hearing: _Hearing, data: bytes) -> None:
        try:
            check_size(hearing.inlet.type, data)
            message = self.manager.backend.decode(hearing.inlet.type, data)
            call = hearing.inlet.call(message) if hearing.inlet.call is not None else None
            if call is not None:
                self._call(*call)
                return
            slots = hearing.inlet.take(message)
        except (CdrError, MorseError, *_UNFIT) as error:
            self.complain(f"read {hearing.topic}", f"a message on {hearing.topic} is refused: {error}")
            return
        frame_id = message.get("header", {}).get("frame_id", "")
        frame = ""
        if frame_id and any(hearing.bound.kind.slots[name].moves for name in slots if name in hearing.bound.kind.slots):
            converted_slots = self._from_frame(frame_id, slots)
            if converted_slots is None:
                self.complain(
                    f"frame {hearing.topic}", f"a message on {hearing.topic} is in the unknown frame {frame_id!r:.80}"
                )
                return
            frame = converted_slots
        self.receive(hearing.bound, slots, frame)

    def _call(self, service: str, arguments: list[object]) -> None:
        """Call an asynchronous service of the component, whose outcome nobody waits for."""
        component = self.component_instance
        component.context.journal.note(CALL, self.component_name, (service, arguments))
        getattr(component, service)(lambda outcome: None, *arguments)

    def _from_frame(self, frame_id: str, slots: DecodedMessage) -> str | None:
        """The frame of a command; a pose relative to the start is converted to the world frame."""
        names = self.names
        if frame_id.lstrip("/") != names.odom(self.robot) or "position" not in slots:
            frame: str | None = names.frame_of(self.component_instance, frame_id)
            return frame
        orientation = slots.get("orientation", (1.0, 0.0, 0.0, 0.0))
        has_rotation = bool(np.any(orientation))
        place = pose_of(slots["position"], orientation if has_rotation else (1.0, 0.0, 0.0, 0.0))
        pose = product(self.robot.initial_position_3d, place)
        slots["position"] = [pose.x, pose.y, pose.z]
        if "orientation" in slots and has_rotation:
            slots["orientation"] = list(quaternion_of(pose))
        return "world"
