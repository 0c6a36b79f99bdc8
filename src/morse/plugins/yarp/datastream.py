"""Sends and receives data streams on ports of YARP."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.core.datastream import DatastreamManager
from morse.core.mapping import maps
from morse.plugins.yarp import MANAGER_OPTIONS
from morse.plugins.yarp.bottle import as_dict, encode
from morse.plugins.yarp.images import ENCODINGS, encode_image
from morse.plugins.yarp.ports import ports_of

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.kinds import BoundKind, Message
    from morse.core.values import Fields, Options
    from morse.plugins.yarp.port import Port
    from morse.plugins.yarp.streams import YarpReader, YarpStream

logger = logging.getLogger(__name__)

_LEFT_OUT = "a message for YARP is left out"


class YarpDatastreamManager(DatastreamManager):
    """``/morse/robot/component/out`` for data of sensors, ``/morse/robot/component/in`` for commands.

    Attributes:
        ports: the ports of the simulation.
    """

    classpath = "morse.middleware.yarp_datastream.YarpDatastreamManager"
    manager_options = MANAGER_OPTIONS
    by_component = True

    def __init__(self, options: Options, context: Context) -> None:
        super().__init__(options, context)
        self.ports = ports_of(context)
        self._outgoing: list[tuple[Port, bytes]] = []

    # -- messages ----------------------------------------------------------------------------

    def wanted(self, stream: YarpStream, topic: str) -> bool:
        """Whether another port is connected."""
        return bool(stream.port.outputs)

    @maps("general")
    def general(self, stream: YarpStream, message: Message) -> bytes | None:
        """The values of all fields, in the order of their declaration; of a laser scanner the points, as in 1.4."""
        fields = message.fields
        return bottle(stream, fields["point_list"] if "point_list" in fields else [fields[name] for name in fields])

    @maps("image")
    def image(self, stream: YarpStream, message: Message) -> bytes | None:
        """The pixels alone, as in 1.4."""
        if message.encoding in ENCODINGS:
            return encode_image(message.pixels, message.encoding)
        names = ", ".join(ENCODINGS)
        text = f"{_LEFT_OUT}: YARP has no image for the encoding {message.encoding}; known: {names}"
        stream.complain("form", text)
        return None

    def send(self, stream: YarpStream, payload: bytes) -> None:
        """Send a bottle at the end of the tick."""
        self._outgoing.append((stream.port, payload))

    @maps("general", direction="IN")
    def command(self, stream: YarpReader, kind: BoundKind, data: list[object]) -> Fields:
        """The fields of a bottle.

        Raises:
            ValueError: it does not fit.
        """
        if len(data) > len(stream.fields):
            fields = ", ".join(stream.fields)
            raise ValueError(f"it has {len(data)} values, expected at most {len(stream.fields)}: {fields}")
        return {name: _value(stream.data[name], value) for name, value in zip(stream.fields, data, strict=False)}

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


def bottle(stream: YarpStream, values: Any) -> bytes | None:
    """A bottle of values; None if YARP has no such values, which the log tells."""
    try:
        return encode(values)
    except (ValueError, TypeError) as error:
        stream.complain("form", f"{_LEFT_OUT}: {error}")
        return None


def _value(present: object, value: object) -> object:
    if isinstance(present, bool) and type(value) is int and value in (0, 1):
        return bool(value)  # a bottle of 1.4 has no booleans
    if isinstance(present, dict) and isinstance(value, list):
        return as_dict(value) or value
    return value


def _deliver(outgoing: list[tuple[Port, bytes]]) -> None:
    for port, data in outgoing:
        port.send(data)
