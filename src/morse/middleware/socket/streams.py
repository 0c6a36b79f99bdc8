"""The streams of components: publishers send their data, readers fill it."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.core.complaints import Complaints
from morse.core.datastream import AbstractDatastream
from morse.core.declarations import kinds
from morse.core.kinds.table import GENERAL
from morse.core.validation import CommandError, Commands
from morse.middleware.socket.encoding import from_json, to_json

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from morse.core.object import Object
    from morse.middleware.socket.stream_client import StreamServer

logger = logging.getLogger(__name__)


class SocketStream(AbstractDatastream):
    """A stream with its own port.

    Attributes:
        server: the server of the port.
        outbox: receives pairs of port and message, which are sent at the end of the tick.
    """

    server: StreamServer
    outbox: list[tuple[StreamServer, bytes]]


def main_kind(component: Any) -> str:
    """The message kind of the topic of a component: ``general`` if it declares none."""
    uses = [use for use in kinds(type(component)) if not use.topic and use.on_level(component.level)]
    return next((use.kind for use in uses if use.when is None or use.when(component)), GENERAL)


def _as_it_is(stream: SocketStream) -> bytes:
    return to_json(stream.data)


class SocketPublisher(SocketStream):
    """Sends the data of a component as one line of JSON to every client, at each of its actions.

    Subclass it and override `encode` for another format.
    """

    _form: Callable[[SocketStream], bytes | None] = staticmethod(_as_it_is)

    def initialize(self) -> None:
        """Determine the format of the message kind of the component."""
        form = self.manager.mapping(main_kind(self.component_instance)) if self.manager is not None else None
        self._form = form or _as_it_is

    @property
    def waiting(self) -> Collection[Any] | None:
        """The clients."""
        return self.server.clients if type(self).default is SocketPublisher.default else None

    def encode(self) -> bytes | str | None:
        """The message, or None if there is nothing to send; a line end is added if it is missing."""
        return self._form(self)

    def default(self, ci: Object | None = None) -> bool:
        """Publish the data; without a connected client, nothing is encoded."""
        if not self.server.connected:
            return False
        message = self.encode()
        if message is None:
            return False
        if isinstance(message, str):
            message = message.encode()
        self.outbox.append((self.server, message if message.endswith(b"\n") else message + b"\n"))
        return True


class SocketReader(SocketStream):
    """Writes lines of JSON from clients into the data of a component.

    Messages since the last tick are applied in order, so that the last one wins; missing fields
    keep their values. A message that is not JSON, or does not fit the fields of the component, is
    refused as a whole, and the log gives the reason.

    Subclass it and override `decode` for another format.
    """

    def __init__(self, component_instance: Object, kwargs: dict[str, Any]) -> None:
        super().__init__(component_instance, kwargs)
        self._commands = Commands(component_instance)
        self._complaints = Complaints(logger)

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
        if not self.server.inbox:
            return False
        lines, dropped = self.server.inbox.take()
        if dropped:
            self._complain("dropped", f"{dropped} messages arrived too fast: newer messages replace them")
        taken = False
        for line in lines:
            taken = self._take(line) or taken
        return taken

    def _take(self, line: bytes) -> bool:
        try:
            message = self.decode(line)
        except Exception as error:  # decode may be user code: a message must not deactivate the component
            self._refuse("decode", f"this message cannot be read ({type(error).__name__}: {error}): {line[:80]!r}")
            return False
        if message is None:
            return False
        try:
            remark = self._commands.take(message)
        except CommandError as error:
            self._refuse("field " + error.field, f"a message is refused: {error}")
            return False
        if remark is not None:
            logger.warning("%s: %s", self.component_name, remark)
        return True

    def _refuse(self, kind: str, text: str) -> None:
        if self.component_instance.context.strict:
            self._complaints.log(logging.ERROR, kind, f"[ERROR][MORSE] {self.component_name}: {text}")
        else:
            self._complain(kind, text)

    def _complain(self, kind: str, text: str) -> None:
        self._complaints.warn(kind, f"{self.component_name}: {text}")
