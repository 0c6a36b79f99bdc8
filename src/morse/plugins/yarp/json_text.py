"""Sends and receives data streams as JSON on ports of YARP."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.mapping import maps
from morse.plugins.yarp import JSON_STREAM_MANAGER
from morse.plugins.yarp.datastream import YarpDatastreamManager, bottle
from morse.plugins.yarp.streams import YarpPublisher, YarpReader
from morse.wire.encoding import from_json, to_json

if TYPE_CHECKING:
    from morse.core.kinds import BoundKind, Message
    from morse.plugins.yarp.streams import YarpStream


class YarpJsonDatastreamManager(YarpDatastreamManager):
    """The ports of YARP, with bottles of one JSON text."""

    classpath = JSON_STREAM_MANAGER

    @maps("general", "image")
    def general(self, stream: YarpStream, message: Message) -> bytes | None:
        """All fields as one JSON text."""
        return bottle(stream, [to_json(message.fields).decode("ascii")])

    @maps("general", direction="IN")
    def command(self, stream: YarpStream, kind: BoundKind, data: list[object]) -> Any:
        """The fields of a bottle.

        Raises:
            ValueError: it is not a JSON text.
        """
        if len(data) != 1 or not isinstance(data[0], str):
            raise ValueError("expected one JSON text")
        return from_json(data[0].encode("utf-8", "replace"))


class YarpJsonPublisher(YarpPublisher):
    """Sends the data of a component as a JSON text."""


class YarpJsonReader(YarpReader):
    """Writes the fields of JSON objects into the data of an actuator."""
