"""Sends and receives data streams over a broker."""

from __future__ import annotations

import logging
import re
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from morse.core.datastream import DatastreamManager
from morse.core.exceptions import MorseMiddlewareError
from morse.core.mapping import maps
from morse.core.reports.quoting import shown
from morse.core.streams.kind_stream import KindStream
from morse.middleware.mqtt import MANAGER_OPTIONS, STREAM_OPTIONS
from morse.middleware.mqtt.broker import Broker
from morse.wire.encoding import from_json, plain
from morse.wire.lines import Inbox

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from morse.core.context import Context
    from morse.core.kinds import BoundKind, Message
    from morse.core.values import Fields, Options

    #: name of a topic below that of the component, and its payload
    Parcels = list[tuple[str, bytes]]


#: maximum size of a message, bytes
_LONGEST = 1 << 20
#: maximum size of the name of a topic, bytes
_LONGEST_TOPIC = 1024


class MqttStream(KindStream):
    """A stream with a topic."""

    options = STREAM_OPTIONS
    manager: MqttDatastreamManager

    def initialize(self) -> None:
        """Determine the name of the topic.

        Raises:
            MorseMiddlewareError: MQTT does not allow it.
        """
        super().initialize()
        option = self.kwargs["topic"]
        path = self.component_name.replace(".", "/")
        self.topic = f"{self.manager.options['prefix']}/{path}" if option is None else option
        if not self.topic or re.search("[+#\0]", self.topic) or len(self.topic.encode()) > _LONGEST_TOPIC:
            raise MorseMiddlewareError(
                f"{self.component_name}: the topic is {shown(self.topic)}, expected a name without '+' and '#', such "
                "as 'lab/robot/pose'"
            )


class MqttPublisher(MqttStream):
    """Sends the data of a component as a JSON object at each of its actions.

    Pixels and points are sent as bytes to topics below that of the component.
    """

    def initialize(self) -> None:
        """Reserve the topic."""
        super().initialize()
        self.manager.claim(self.topic, self.component_name)


class MqttReader(MqttStream):
    """Writes JSON objects from the topic ``<component>/set`` into the data of a component.

    Missing fields keep their values. An invalid object is refused as a whole.
    """

    def initialize(self) -> None:
        """Listen."""
        super().initialize()
        self._inbox = Inbox()
        self.topic = f"{self.topic}/set" if self.kwargs["topic"] is None else self.topic
        self.manager.claim(self.topic, self.component_name)
        self.manager.broker.listen(self.topic, self.kwargs["qos"], self.receive)

    def receive(self, data: bytes, slots: object = None, frame: str = "") -> None:
        """Queue a message; called in the thread of the connection."""
        if len(data) > _LONGEST:
            self.complain("large", f"a message is refused: {len(data)} bytes are more than {_LONGEST}")
        else:
            self._inbox.put(data)

    def finalize(self) -> None:
        """End the subscription."""
        self.manager.broker.ignore(self.topic)

    @property
    def waiting(self) -> Collection[object]:
        """Messages that have arrived."""
        return self._inbox.arrived

    def arrived(self) -> Iterable[bytes]:
        """The messages that have arrived since the last action."""
        if not self._inbox or self.rests:
            return ()
        messages, losses = self._inbox.take()
        if losses:
            self.complain("dropped", f"{losses} messages arrived too fast: newer messages replace them")
        return messages


logger = logging.getLogger(__name__)

#: NaN and infinity become null
_encoder = msgspec.json.Encoder(enc_hook=plain)


class MqttDatastreamManager(DatastreamManager):
    """``morse/robot/component`` for data of sensors, ``morse/robot/component/set`` for commands.

    ``morse/status`` is ``online`` while the simulation runs, and ``offline`` afterwards.

    Attributes:
        broker: the connection.
    """

    classpath = "morse.middleware.mqtt.datastream.MqttDatastreamManager"
    manager_options = MANAGER_OPTIONS
    by_component = True

    def __init__(self, options: Options, context: Context) -> None:
        super().__init__(options, context)
        self.broker = Broker(self.options, context.arrivals)
        logger.info("mqtt: the broker is expected at %s", self.broker.place)
        self._owners: dict[str, str] = {}

    def claim(self, topic: str, name: str) -> None:
        """Reserve a topic for a stream.

        Raises:
            MorseMiddlewareError: another stream has this topic.
        """
        owner = self._owners.get(topic)
        if owner is not None:
            raise MorseMiddlewareError(f"{name}: the topic {topic} is that of {owner}; set topic='...' for one of them")
        self._owners[topic] = name

    def closed(self, stream: Any) -> None:
        """Release the topic, unless it was refused to the stream."""
        topic = getattr(stream, "topic", "")
        if self._owners.get(topic) == stream.component_name:
            del self._owners[topic]

    # -- messages ----------------------------------------------------------------------------

    def wanted(self, stream: MqttStream, topic: str) -> bool:
        """Whether a broker is connected."""
        return self.broker.connected

    @maps("general")
    def general(self, stream: MqttStream, message: Message) -> Parcels:
        """All fields, unchanged."""
        return [("", _encoder.encode(message.fields))]

    @maps("image")
    def image(self, stream: MqttStream, message: Message) -> Parcels:
        """The pixels row by row on ``image``, their format on the topic of the camera."""
        height, width = message.pixels.shape[:2]
        about = {"height": height, "width": width, "encoding": message.encoding}
        return [("", _about(message, "image", about)), ("image", message.pixels.tobytes())]

    @maps("cloud")
    def cloud(self, stream: MqttStream, message: Message) -> Parcels:
        """The points on ``points``: x, y, z as float32, little-endian."""
        points = np.asarray(message.points, dtype="<f4").reshape(-1, 3)
        return [("", _about(message, "points", {"points": len(points)})), ("points", points.tobytes())]

    def send(self, stream: MqttStream, payload: Parcels) -> None:
        """Pass messages to the connection."""
        for below, data in payload:
            topic = f"{stream.topic}/{below}" if below else stream.topic
            self.broker.publish(topic, data, stream.kwargs["qos"], stream.kwargs["retain"])

    @maps("general", direction="IN")
    def command(self, stream: MqttStream, kind: BoundKind, data: bytes) -> object:
        """The fields of a JSON object."""
        return from_json(data)

    def finalize(self) -> None:
        """Say farewell."""
        super().finalize()
        self.broker.close()


def _about(message: Message, content: str, about: Fields) -> bytes:
    large = (content, "point_list", "range_list", "remission_list")
    rest = {name: value for name, value in message.fields.items() if name not in large}
    return _encoder.encode({**rest, **about})
