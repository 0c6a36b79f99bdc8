"""The streams of components: publishers send their data, readers fill it."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.core.datastream import AbstractDatastream
from morse.middleware.socket.complaints import Complaints
from morse.middleware.socket.encoding import from_json, to_json
from morse.middleware.socket.fields import Fields, WrongMessage

if TYPE_CHECKING:
    from morse.core.object import Object
    from morse.middleware.socket.stream_client import StreamServer

logger = logging.getLogger("morse." + __name__)


class SocketStream(AbstractDatastream):
    """A stream on a port of its own.

    Attributes:
        server: the port.
        outbox: takes pairs of port and message, which are sent at the end of the tick.
    """

    server: StreamServer
    outbox: list[tuple[StreamServer, bytes]]


class SocketPublisher(SocketStream):
    """Sends the data of a component as one line of JSON to every client, at each of its actions.

    Subclass it and override `encode` to send something else.
    """

    def encode(self) -> bytes | str | None:
        """The message, or None if there is nothing to send; a line end is added if it is missing."""
        return to_json(self.data)

    def default(self, ci: Object | None = None) -> bool:
        """Publish; nothing is encoded while nobody is connected."""
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
    """Takes lines of JSON from clients into the data of a component.

    Messages that arrived since the last tick are taken in their order, so that the last one wins;
    fields that a message does not have stay as they are. A message that is no JSON, or does not fit
    the fields of the component, is refused as a whole, and the log says why.

    Subclass it and override `decode` to take something else.
    """

    def __init__(self, component_instance: Object, kwargs: dict[str, Any]) -> None:
        super().__init__(component_instance, kwargs)
        self._fields = Fields(component_instance)
        self._complaints = Complaints(logger)

    def decode(self, msg: bytes) -> Any:
        """The fields that a message sets.

        Raises:
            ValueError: it cannot be read.
        """
        return from_json(msg)

    def default(self, ci: Object | None = None) -> bool:
        """Take what has arrived; True if something did."""
        if not self.server.inbox:
            return False
        lines, dropped = self.server.inbox.take()
        if dropped:
            self._complain("dropped", f"{dropped} messages came too fast: newer ones replace them")
        taken = False
        for line in lines:
            taken = self._take(line) or taken
        return taken

    def _take(self, line: bytes) -> bool:
        try:
            message = self.decode(line)
        except Exception as error:  # decode may be the user's: a client's message must not stop the component
            self._complain("decode", f"this message cannot be read ({type(error).__name__}: {error}): {line[:80]!r}")
            return False
        if message is None:
            return False
        try:
            remark = self._fields.merge(message)
        except WrongMessage as error:
            self._complain("field " + error.field, f"a message is refused: {error}")
            return False
        if remark is not None:
            logger.warning("%s: %s", self.component_name, remark)
        return True

    def _complain(self, kind: str, text: str) -> None:
        self._complaints.warn(kind, f"{self.component_name}: {text}")
