"""Binary streams: all streams of a simulation on one connection."""

from __future__ import annotations

import json
import logging
import threading
from typing import TYPE_CHECKING, Any

from pymorse.channel import Channel
from pymorse.errors import printable
from pymorse.frames import NOTICE, decode, read_head
from pymorse.messages import Messages
from pymorse.stream import connect

if TYPE_CHECKING:
    from collections.abc import Callable

    from pymorse.poller import Poller

logger = logging.getLogger("pymorse")


class BinaryConnection(Channel):
    """A connection that carries the binary streams of many components.

    Args:
        host: name or address of the host of the simulation.
        port: TCP port of the binary streams.
        poller: thread that serves the connection.
        latest: whether to receive the next message of a stream only when the last one has been processed.

    Raises:
        ConnectionError: no server listens there.
    """

    def __init__(self, host: str, port: int, poller: Poller, *, latest: bool = False) -> None:
        self.latest = latest
        self._buffer = bytearray()
        self._count = 0
        self._streams: dict[str, BinaryStream] = {}
        self._numbers: dict[int, BinaryStream] = {}
        self._news = threading.Condition()
        super().__init__(connect(host, port), poller)

    def open(self, name: str) -> BinaryStream:
        """Subscribe to the stream of a component.

        The method does not wait for the answer, because the simulation processes the request before any later service
        call.
        """
        stream = self._streams[name] = BinaryStream(name, self)
        self.request(f"subscribe {name}{' latest' if self.latest else ''}")
        return stream

    def request(self, line: str) -> None:
        """Send a request."""
        self.send(line.encode() + b"\n")

    def forget(self, stream: BinaryStream) -> None:
        """Unsubscribe from a stream."""
        if self._streams.get(stream.name) is stream and stream.is_up():
            del self._streams[stream.name]
            self.request(f"unsubscribe {stream.name}")
        stream.end("it was closed")

    # -- received data; called in the poll thread ---------------------------------------------

    def received(self, data: bytes) -> None:
        """Cut received bytes into frames."""
        self._buffer += data
        begin = 0
        try:
            while (head := read_head(self._buffer, begin)) is not None and begin + head.size <= len(self._buffer):
                with memoryview(self._buffer) as view:
                    frame = bytes(view[begin : begin + head.size])
                begin += head.size
                if head.kind == NOTICE:
                    self._handle_notice(decode(frame))
                else:
                    self._handle_message(head.stream, frame)
        except ValueError as error:
            logger.error("%s sent invalid data for a binary stream, the connection is closed: %s", self.peer, error)
            self._buffer.clear()
            self.close()
            return
        del self._buffer[:begin]

    def _handle_message(self, number: int, frame: bytes) -> None:
        stream = self._numbers.get(number)
        # a message may have been sent before the simulation processed the request to unsubscribe
        if stream is not None and stream is not self._streams.get(stream.name):
            stream = None
        if stream is not None:
            self.poller.arrivals.add(stream, frame)
        else:
            self.count()

    def count(self) -> None:
        """Count a message that was processed."""
        with self._news:
            self._count += 1
            self._news.notify_all()

    def _handle_notice(self, notice: object) -> None:
        match notice:
            case {"subscribed": str(name), "stream": int(number)} if name in self._streams:
                self._numbers[number] = self._streams[name]
            case {"closed": str(name)} if name in self._streams:
                self._streams.pop(name).end("the component was deleted")
            case {"error": str(text), "subject": str(name)} if name in self._streams:
                self._streams.pop(name).end(printable(text))
            case {"subscribed": _} | {"closed": _}:
                pass  # the message was sent before the simulation processed the request to unsubscribe
            case _:
                logger.warning("%s: %s", self.peer, json.dumps(notice)[:200])

    def closed(self) -> None:
        """Called when the connection has ended, and all its streams with it."""
        for stream in list(self._streams.values()):
            stream.end(Messages.ending)
        with self._news:
            self._news.notify_all()

    def has_received(self, count: int) -> bool:
        """Whether that number of messages has arrived since the connection was opened."""
        return self._count >= count

    def wait_for_message(self, timeout: float) -> None:
        """Wait until another message has arrived, at most ``timeout`` seconds."""
        with self._news:
            before = self._count
            self._news.wait_for(lambda: self._count != before or not self.is_up(), timeout)


class BinaryStream(Messages):
    """The messages of one component on a binary connection.

    Attributes:
        name: name of the component.
        ending: the reason why no more messages will arrive, if there is one.
    """

    def __init__(self, name: str, connection: BinaryConnection) -> None:
        super().__init__()
        self.name = name
        self._up = True
        self.peer = f"{name} ({connection.peer})"
        self.poller = connection.poller
        self.latest: Callable[[], BinaryStream] | None = None
        self._connection = connection
        self._only_latest: BinaryStream | None = None
        self._opening = threading.Lock()

    def is_up(self) -> bool:
        """Whether messages may still arrive."""
        return self._up and self._connection.is_up()

    def decode(self, msg: bytes) -> Any:
        """The message in a frame; see `pymorse.frames.decode`."""
        return decode(msg)

    def publish(self, msg: Any) -> None:
        """Raise an error, because sensors accept no data."""
        raise AttributeError(f"{self.name} is a sensor and sends data: use get(), last() or subscribe()")

    def subscribe(self, callback: Callable[[Any], object], latest: bool = False) -> None:
        """Call ``callback(message)`` for every received message.

        Args:
            latest: whether to skip messages that the simulation creates while the callback runs. They are not even
                sent. Such callbacks run in a separate thread.
        """
        if not latest:
            super().subscribe(callback)
            return
        assert self.latest is not None
        with self._opening:
            if self._only_latest is None or not self._only_latest.is_up():
                self._only_latest = self.latest()
            self._only_latest._subscribers.append(callback)

    def unsubscribe(self, callback: Callable[[Any], object]) -> None:
        """Undo `subscribe`.

        Raises:
            ValueError: the callback was not subscribed.
        """
        with self._opening:
            other = self._only_latest
            if other is None or callback not in other._subscribers:
                super().unsubscribe(callback)
                return
            other._subscribers.remove(callback)
            if not other._subscribers:
                self._only_latest = None
                other.close()

    def keep(self, msg: bytes) -> None:
        """Store a received message."""
        super().keep(msg)
        self._connection.count()

    def tell(self, msg: bytes) -> None:
        """Call the subscribers, and request the next message."""
        super().tell(msg)
        if self._connection.latest and self.is_up():
            self._connection.request(f"next {self.name}")

    def end(self, reason: str) -> None:
        """Called when no more messages will arrive."""
        self.ending, self._up = reason, False
        self.ended()

    def drain(self, timeout: float) -> bool:
        """Return True, because no data are ever sent."""
        return True

    def close(self) -> None:
        """Unsubscribe."""
        if self._only_latest is not None:
            self._only_latest.close()
        self._connection.forget(self)
