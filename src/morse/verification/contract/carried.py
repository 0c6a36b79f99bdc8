"""Rule on middlewares: each of them supports the component, by a message kind or in the general format."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.actuator import Actuator
from morse.core.datastream import DatastreamManager
from morse.core.declarations import fields_of_component, says_nothing
from morse.core.mapping import maps
from morse.core.sensor import Sensor
from morse.middleware import registry
from morse.scene import StreamDeclaration
from morse.verification.contract.report import Fault
from morse.wire.encoding import to_json

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.core.context import Context
    from morse.core.values import Options
    from morse.verification.contract.stand import Stand

CARRIED = "carried by every middleware"
_KIND_STREAM = "morse.core.streams.kind_stream.KindStream"
_TICKS = 70


class Listener(DatastreamManager):
    """A middleware that writes every message as JSON, whatever its kind, and discards the result.

    Attributes:
        heard: number of messages.
    """

    def __init__(self, options: Options, context: Context) -> None:
        super().__init__(options, context)
        self.heard = 0

    @maps("general")
    def general(self, stream: Any, message: Any) -> None:
        """Take a message.

        Raises:
            TypeError: a slot cannot be written.
        """
        to_json(dict(message.fields))
        for kind in stream.kinds:
            to_json(dict(kind.gather().slots))
            self.heard += 1


def carried(stand: Stand) -> Iterator[Fault]:
    """Every installed middleware has a stream for it, and its data fit its message kinds."""
    component = stand.component
    cls = type(component)
    if not isinstance(component, (Sensor, Actuator)) or not fields_of_component(component) or says_nothing(cls):
        return
    direction = "IN" if isinstance(component, Actuator) else "OUT"
    place = stand.places.of_class(cls)
    for name, middleware in registry.installed().items():
        # text files have no commands, and omit images
        usual = middleware.default_reader if direction == "IN" else middleware.default_publisher
        is_left_out = any(base.__name__ in middleware.not_carried for base in cls.__mro__)
        if middleware.stream_manager is None or usual is None or is_left_out:
            continue
        if middleware.stream_of(cls, direction) is None:
            yield Fault(CARRIED, f"'{name}' has no stream for it", place)
    listener = Listener({}, stand.simulation.context)
    try:
        listener.connect(component, StreamDeclaration("check", _KIND_STREAM, direction, {}))
        stand.run(_TICKS)
    except Exception as error:
        yield Fault(CARRIED, f"its message cannot be made: {type(error).__name__}: {error}", place)
    if stand.failed or not listener.streams.get(component.name()):
        yield Fault(CARRIED, "its message cannot be made: the stream is closed when a client connects", place)
    listener.finalize()
