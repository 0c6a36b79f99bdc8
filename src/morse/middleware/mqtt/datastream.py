"""Sends and receives data streams over a broker."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from morse.core.datastream import DatastreamManager
from morse.core.exceptions import MorseMiddlewareError
from morse.core.mapping import maps
from morse.middleware.mqtt import MANAGER_OPTIONS
from morse.middleware.mqtt.broker import Broker
from morse.wire.encoding import from_json, plain

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.kinds import BoundKind, Message
    from morse.core.values import Fields, Options
    from morse.middleware.mqtt.streams import MqttStream

    #: name of a topic below that of the component, and its payload
    Parcels = list[tuple[str, bytes]]

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
