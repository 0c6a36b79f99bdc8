"""Sends and receives data streams on ports of YARP."""

from __future__ import annotations

import logging
import struct
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.datastream import DatastreamManager
from morse.core.mapping import maps
from morse.core.streams.kind_stream import KindStream
from morse.plugins.yarp import JSON_STREAM_MANAGER, MANAGER_OPTIONS, STREAM_OPTIONS
from morse.plugins.yarp.bottle import BLOB, INT32, LIST, VOCAB, as_dict, encode
from morse.plugins.yarp.ports import WaitingBottles, ports_of
from morse.wire.encoding import from_json, to_json

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sized

    from morse.core.context import Context
    from morse.core.kinds import BoundKind, Message
    from morse.core.values import Fields, Options
    from morse.plugins.yarp.port import Port


#: word of each encoding: yarp::sig::ImageOf<PixelRgba>, <PixelFloat>, <PixelRgbFloat>, <PixelMono16>, …
_TYPES = {
    "rgba8": b"rgba",
    "rgb8": b"rgb\0",
    "mono8": b"mono",
    "16UC1": b"mo16",
    "mono16": b"mo16",
    "32FC1": b"dec\0",
    "32FC3": b"rgb.",
}
ENCODINGS = tuple(_TYPES)
#: rows are padded to a multiple of this number of bytes
_QUANTUM = 8
#: rows from the top to the bottom
_FROM_TOP = 0
_HEADER = struct.Struct("<3i4si4s4i2h3ii")


def encode_image(pixels: np.ndarray, encoding: str) -> bytes:
    """An image.

    Args:
        pixels: (H, W) or (H, W, C), row 0 on top; uint8, uint16 or float32, as the encoding says.
        encoding: one of `ENCODINGS`.
    """
    height, width = pixels.shape[:2]
    rows = np.ascontiguousarray(pixels).reshape(height, -1).view(np.uint8)
    padding = -rows.shape[1] % _QUANTUM
    if padding:
        rows = np.pad(rows, ((0, 0), (0, padding)))
    depth = pixels.dtype.itemsize * int(np.prod(pixels.shape[2:]))
    data = rows.tobytes()
    return (
        _HEADER.pack(
            LIST, 4, VOCAB, b"mat\0", VOCAB, _TYPES[encoding], LIST | INT32, 5, depth, len(data), _QUANTUM, _FROM_TOP,
            width, height, BLOB, len(data),
        )
        + data
    )  # fmt: skip


#: number of bottles that wait for the next action of an actuator
_MOST_WAITING = 64


class YarpStream(KindStream):
    """A stream with a port."""

    options = STREAM_OPTIONS
    manager: YarpDatastreamManager
    _end = ""

    def initialize(self) -> None:
        """Open the port.

        Raises:
            MorseMiddlewareError: its name is not one of YARP, or another component has it.
        """
        super().initialize()
        path = f"{self.component_name.replace('.', '/')}/{self._end}"
        name = self.kwargs["port"] or self.manager.ports.name(path)
        self.port = self.manager.ports.open(name, self.component_name, self.taker())

    def taker(self) -> Callable[[list[object], int], object] | None:
        """The function that takes the bottles that arrive."""
        return None

    def finalize(self) -> None:
        """Close the port."""
        self.manager.ports.close(self.port)


class YarpPublisher(YarpStream):
    """Sends the values of a component as a bottle at each of its actions; pixels as an image."""

    _end = "out"


class YarpReader(YarpStream):
    """Writes the values of bottles into the data of an actuator, in the order of its fields.

    A bottle may have fewer values than the actuator has fields; the others keep their values. A bottle with a wrong
    value is refused as a whole.
    """

    _end = "in"
    what = "bottle"

    def initialize(self) -> None:
        """Listen."""
        #: fields that bottles set, in their order
        self.fields = [name for name in self.data if name != "timestamp"]
        super().initialize()

    def taker(self) -> Callable[[list[object], int], object]:
        """See `YarpStream.taker`."""
        self._bottles: WaitingBottles[list[object]] = WaitingBottles(
            _MOST_WAITING, self.complaints, f"{self.component_name}: bottles"
        )
        return self._bottles.append

    @property
    def waiting(self) -> Sized:
        """Bottles that have arrived."""
        return self._bottles

    def arrived(self) -> Iterable[list[object]]:
        """The bottles that have arrived, as many as there is time for."""
        while self._bottles and not self.rests:
            yield self._bottles.popleft()


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
            ValueError: it is not JSON text.
        """
        if len(data) != 1 or not isinstance(data[0], str):
            raise ValueError("expected one JSON text")
        return from_json(data[0].encode("utf-8", "replace"))


class YarpJsonPublisher(YarpPublisher):
    """Sends the data of a component as a JSON text."""


class YarpJsonReader(YarpReader):
    """Writes the fields of JSON objects into the data of an actuator."""
