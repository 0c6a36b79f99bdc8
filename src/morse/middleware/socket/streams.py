"""The streams of components: publishers send their data, readers fill it."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.core.datastream import AbstractDatastream
from morse.core.declarations import kinds
from morse.core.kinds.table import GENERAL
from morse.core.validation import ClientCommands
from morse.middleware.socket.frames import data_frame, line_frame
from morse.wire.encoding import from_json, to_json
from morse.wire.images import cloud_fields, image_fields

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from morse.core.object import Object
    from morse.middleware.socket.frame_channel import FrameChannel
    from morse.middleware.socket.stream_client import StreamServer

logger = logging.getLogger(__name__)


class SocketStream(AbstractDatastream):
    """A stream with its own port.

    Attributes:
        server: the server of the port.
        outbox: receives pairs of port and message, which are sent at the end of the tick.
        frames: receives pairs of binary stream and frame.
    """

    server: StreamServer
    outbox: list[tuple[StreamServer, bytes]]
    frames: list[tuple[FrameChannel, bytes]]


def main_kind(component: Any) -> str:
    """The message kind of the topic of a component: ``general`` if it declares none."""
    uses = [use for use in kinds(type(component)) if not use.topic and use.on_level(component.level)]
    return next((use.kind for use in uses if use.when is None or use.when(component)), GENERAL)


def _as_it_is(stream: SocketStream) -> bytes:
    return to_json(stream.data)


def _all_fields(stream: SocketStream) -> dict[str, Any] | None:
    return stream.component_instance.local_data


def _line(message: bytes | str) -> bytes:
    if isinstance(message, str):
        message = message.encode()
    return message if message.endswith(b"\n") else message + b"\n"


#: fields of the messages of kinds whose lines have other fields than the data of the component
_FIELDS: dict[str, Callable[[SocketStream], dict[str, Any] | None]] = {"image": image_fields, "cloud": cloud_fields}


class SocketPublisher(SocketStream):
    """Sends the data of a component as one line of JSON to every client, at each of its actions.

    Subclass it and override `encode` for another format.
    """

    _writes_lines = False
    _form: Callable[[SocketStream], bytes | None] = staticmethod(_as_it_is)
    _fields: Callable[[SocketStream], dict[str, Any] | None] = staticmethod(_all_fields)

    def initialize(self) -> None:
        """Determine the format of the message kind of the component."""
        form = self.manager.mapping(main_kind(self.component_instance)) if self.manager is not None else None
        self._form = form or _as_it_is
        self._fields = _FIELDS.get(main_kind(self.component_instance), _all_fields)
        self._writes_lines = type(self).encode is not SocketPublisher.encode

    @property
    def waiting(self) -> Collection[Any] | None:
        """The clients."""
        return self.server.readers if type(self).default is SocketPublisher.default else None

    def encode(self) -> bytes | str | None:
        """The message, or None if there is nothing to send; a line end is added if it is missing."""
        return self._form(self)

    def default(self, ci: Object | None = None) -> bool:
        """Publish the data; without a connected client, nothing is encoded."""
        server, binary = self.server, self.server.binary
        sent = False
        if server.connected:
            message = self.encode()
            if message is not None:
                self.outbox.append((server, _line(message)))
                sent = True
        if binary is not None and (binary.every or binary.ready):
            frame = self._frame(binary.number)
            if frame is not None:
                self.frames.append((binary, frame))
                sent = True
        return sent

    def _frame(self, number: int) -> bytes | None:
        if self._writes_lines:
            message = self.encode()
            return None if message is None else line_frame(number, _line(message))
        fields = self._fields(self)
        return None if fields is None else data_frame(number, fields)


class SocketReader(SocketStream):
    """Writes lines of JSON from clients into the data of a component.

    Messages since the last tick are applied in order, so that the last one wins; missing fields
    keep their values. A message that is not JSON, or does not fit the fields of the component, is
    refused as a whole, and the log gives the reason.

    Subclass it and override `decode` for another format.
    """

    def __init__(self, component_instance: Object, kwargs: dict[str, Any]) -> None:
        super().__init__(component_instance, kwargs)
        self._commands = ClientCommands(component_instance, logger)

    @property
    def waiting(self) -> Collection[Any] | None:
        """Messages of clients."""
        return self.server.inbox.arrived if type(self).default is SocketReader.default else None

    def decode(self, msg: bytes) -> Any:
        """The fields that a message sets.

        Raises:
            ValueError: it cannot be decoded.
        """
        return from_json(msg)

    def default(self, ci: Object | None = None) -> bool:
        """Apply received messages; True if there were any."""
        if not self.server.inbox or self._commands.rest:
            return False
        lines, dropped = self.server.inbox.take()
        if dropped:
            self._commands.complain("dropped", f"{dropped} messages arrived too fast: newer messages replace them")
        taken = False
        for line in lines:
            taken = self._commands.take(self.decode, line) or taken
        return taken
