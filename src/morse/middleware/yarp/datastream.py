"""Sends and receives data streams on ports of YARP."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.core.datastream import DatastreamManager
from morse.core.mapping import maps
from morse.middleware.yarp.bottle import encode
from morse.middleware.yarp.images import ENCODINGS, encode_image
from morse.middleware.yarp.mapping import MANAGER_OPTIONS
from morse.middleware.yarp.ports import ports_of

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.middleware.yarp.port import Port
    from morse.middleware.yarp.streams import YarpPublisher

logger = logging.getLogger(__name__)


class YarpDatastreamManager(DatastreamManager):
    """``/morse/robot/component/out`` for data of sensors, ``/morse/robot/component/in`` for commands.

    Attributes:
        ports: the ports of the simulation.
    """

    classpath = "morse.middleware.yarp_datastream.YarpDatastreamManager"
    manager_options = MANAGER_OPTIONS

    def __init__(self, options: dict[str, Any], context: Context) -> None:
        super().__init__(options, context)
        self.ports = ports_of(context)
        self._outgoing: list[tuple[Port, bytes]] = []

    @maps("general")
    def general(self, stream: YarpPublisher) -> bytes:
        """The values of all fields, in the order of their declaration."""
        data = stream.data
        return encode([data[name] for name in data])

    def points(self, stream: YarpPublisher) -> bytes:
        """The points of a laser scanner alone, as in 1.4."""
        return encode(stream.data["point_list"])

    @maps("image")
    def image(self, stream: YarpPublisher) -> bytes | None:
        """The pixels alone, as in 1.4."""
        bound = next(one for one in stream.kinds if one.kind.name == "image")
        if not getattr(bound.component, "capturing", True):
            return None
        message = bound.gather()
        if message.encoding not in ENCODINGS:
            raise ValueError(f"YARP has no image for the encoding {message.encoding}; known: {', '.join(ENCODINGS)}")
        return encode_image(message.pixels, message.encoding)

    def send(self, port: Port, data: bytes) -> None:
        """Send a bottle at the end of the tick."""
        self._outgoing.append((port, data))

    def flush(self) -> None:
        """Pass the bottles of a tick to the network thread."""
        if self._outgoing:
            self.context.network.post(_deliver, self._outgoing)
            self._outgoing = []

    push = flush

    def finalize(self) -> None:
        """Send the last bottles, and remove the ports from the name server."""
        self.flush()
        super().finalize()
        self.ports.release()


def _deliver(outgoing: list[tuple[Port, bytes]]) -> None:
    for port, data in outgoing:
        port.send(data)
