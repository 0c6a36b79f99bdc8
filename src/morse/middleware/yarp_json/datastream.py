"""Sends and receives data streams as JSON on ports of YARP."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.mapping import maps
from morse.middleware.yarp.bottle import encode
from morse.middleware.yarp.datastream import YarpDatastreamManager
from morse.wire.encoding import to_json

if TYPE_CHECKING:
    from morse.middleware.yarp.streams import YarpPublisher


class YarpJsonDatastreamManager(YarpDatastreamManager):
    """The ports of YARP, with bottles of one JSON text."""

    classpath = "morse.middleware.yarp_json.datastream.YarpJsonDatastreamManager"

    @maps("general")
    def general(self, stream: YarpPublisher) -> bytes:
        """All fields as one JSON text."""
        return encode([to_json(stream.data).decode("ascii")])
