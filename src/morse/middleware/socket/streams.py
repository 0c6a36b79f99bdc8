"""The streams of components: publishers send their data, readers fill it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.streams.kind_stream import KindStream
from morse.wire.encoding import from_json, to_json

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable

    from morse.middleware.socket.datastream import SocketDatastreamManager
    from morse.middleware.socket.stream_client import StreamServer


class SocketStream(KindStream):
    """A stream with its own port.

    Attributes:
        server: the server of the port.
    """

    manager: SocketDatastreamManager
    server: StreamServer


class SocketPublisher(SocketStream):
    """Sends the data of a component as one line of JSON to every client, at each of its actions.

    Subclass it and override `encode` for another format.
    """

    def encode(self) -> Any:
        """The message, or None if there is nothing to send; a line end is added if it is missing."""
        return to_json(self.data)

    def own_form(self) -> Callable[[], object] | None:
        """See `KindStream.own_form`."""
        return None if type(self).encode is SocketPublisher.encode else self.encode

    @property
    def waiting(self) -> Collection[object] | None:
        """The clients."""
        return self.server.readers if type(self).default is KindStream.default else None


class SocketReader(SocketStream):
    """Writes lines of JSON from clients into the data of a component.

    Messages since the last tick are applied in order, so that the last one wins; missing fields
    keep their values. A message that is not JSON, or does not fit the fields of the component, is
    refused as a whole, and the log gives the reason.

    Subclass it and override `decode` for another format.
    """

    @property
    def waiting(self) -> Collection[object] | None:
        """Messages of clients."""
        return self.server.inbox.arrived if type(self).default is KindStream.default else None

    def arrived(self) -> Iterable[bytes]:
        """The lines that have arrived since the last action."""
        if not self.server.inbox or self.rests:
            return ()
        lines, losses = self.server.inbox.take()
        if losses:
            self.complain("dropped", f"{losses} messages arrived too fast: newer messages replace them")
        return lines

    def decode(self, msg: bytes) -> Any:
        """The fields that a message sets.

        Raises:
            ValueError: it cannot be decoded.
        """
        return from_json(msg)
