"""The clients of binary streams; all functions run in the network thread.

A client sends lines: ``subscribe NAME``, ``subscribe NAME latest``, ``next NAME``, ``unsubscribe NAME``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.reports.quoting import short
from morse.middleware.socket.frames import notice_frame
from morse.wire.lines import MAX_LINE, LineClient, beginning

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.middleware.socket.frame_channel import FrameChannel
    from morse.middleware.socket.frame_server import FrameServer
    from morse.wire.connection import Connection

MAX_NOTICES = 1 << 20
"""Number of unsent bytes above which a client that sends further requests is disconnected."""
#: maximum number of error messages with the most similar name, and of errors before a client is disconnected
_HINTS, _MOST_ERRORS = 8, 1000
#: maximum length of a request, bytes
_LONGEST = 4096
_EXPECTED = "expected: subscribe NAME [latest], next NAME, or unsubscribe NAME"


class FrameClient(LineClient):
    """A client of binary streams.

    If the client is slow, it gets only the last message of each stream, as soon as it can receive it.

    Attributes:
        every: the streams of which it gets every message.
        sent: number of messages passed to the connection.
    """

    server: FrameServer

    def __init__(self, server: FrameServer) -> None:
        super().__init__(server)
        self.every: frozenset[FrameChannel] = frozenset()
        self.sent = 0
        self._latest: set[FrameChannel] = set()
        self._waiting: dict[FrameChannel, bytes] = {}
        self._behind = False
        self._refusals = 0

    def connection_made(self, transport: Connection, peer: str) -> None:
        """A client has connected."""
        super().connection_made(transport, peer)
        transport.high_water = self.server.limits.high_water()

    def connection_lost(self, error: OSError | None) -> None:
        """The connection has ended."""
        for channel in (*self.every, *self._latest):
            self.unsubscribe(channel)
        super().connection_lost(error)

    def give_up(self) -> None:
        """See `LineClient.give_up`."""
        for channel in (*self.every, *self._latest):
            self.unsubscribe(channel)
        super().give_up()

    @property
    def keeps_place(self) -> bool:
        """Whether it has subscribed to a stream, and reads it."""
        return bool(self.every or self._latest) and not self.congested

    # -- messages ----------------------------------------------------------------------------

    def offer(self, frames: Sequence[tuple[FrameChannel, bytes]], data: bytes) -> None:
        """Send messages now, or only the last message of each stream if the client is slow.

        Args:
            frames: the messages.
            data: the concatenated messages.
        """
        if not self.congested:
            self.transport.write(data)
            self.sent += len(frames)
            return
        for channel, frame in frames:
            if self._waiting.pop(channel, None) is not None and not self._behind:
                self._behind = True
                self._complain("slow", f"the client {self.peer} reads too slowly, it misses messages")
            self._waiting[channel] = frame

    def resume_writing(self) -> None:
        """The client has caught up."""
        super().resume_writing()
        waiting, self._waiting = self._waiting, {}
        if waiting and not self.transport.is_closing():
            self.transport.write(b"".join(waiting.values()))
            self.sent += len(waiting)

    def notify(self, notice: bytes) -> None:
        """Send a notice; a client that does not read its notices is disconnected."""
        if self.transport.is_closing():
            return
        if self.transport.get_write_buffer_size() > max(MAX_NOTICES, 2 * self.transport.high_water):
            self._complain("unread", f"the client {self.peer} makes requests without reading: disconnected")
            self._shut_out = True
            self.transport.abort()
            return
        self.transport.write(notice)

    # -- requests ----------------------------------------------------------------------------

    def line(self, line: bytes) -> None:
        """A request has arrived."""
        if len(line) > _LONGEST:
            self._refuse(f"a request has at most {_LONGEST} bytes: {_EXPECTED}")
            return
        words = line.decode("utf-8", "replace").split()
        match words:
            case []:
                return
            case ["subscribe", name] | ["subscribe", name, "latest"]:
                self._subscribe(name, latest=len(words) == 3)
            case ["unsubscribe", name]:
                if (channel := self.server.channels.get(name)) is not None:
                    self.unsubscribe(channel)
            case ["next", name]:
                if (channel := self.server.channels.get(name)) in self._latest:
                    channel.add(self, latest=True)
            case _:
                self._refuse(f"'{beginning(line)}' is not a request: {_EXPECTED}")

    def _subscribe(self, name: str, *, latest: bool) -> None:
        channel = self.server.channels.get(name)
        if channel is None:
            # a client that sends further requests does not read them, and each takes time
            hint = self.server.hint(name) if self._refusals < _HINTS else ""
            self._refuse(f"no stream {short(name)}{hint}", name)
            return
        self.unsubscribe(channel)
        if latest:
            self._latest.add(channel)
        else:
            self.every |= {channel}
        self.notify(notice_frame({"subscribed": name, "stream": channel.number}))
        channel.add(self, latest=latest)

    def unsubscribe(self, channel: FrameChannel) -> bool:
        """End the subscription of a stream; True if there was one."""
        is_subscribed = channel in self.every or channel in self._latest
        self.every -= {channel}
        self._latest.discard(channel)
        self._waiting.pop(channel, None)
        channel.discard(self)
        return is_subscribed

    def _refuse(self, text: str, name: str | None = None) -> None:
        self._refusals += 1
        if self._refusals > _MOST_ERRORS:
            self._complain("errors", f"the client {self.peer} has sent {_MOST_ERRORS} wrong requests: disconnected")
            self._shut_out = True
            self.transport.abort()
            return
        self.notify(notice_frame({"error": text, "subject": name or ""}))

    def unfinished(self, rest: bytes) -> None:
        """The client disconnected in the middle of a request."""
        self._complain("unfinished", f"the client {self.peer} left in the middle of a request: {beginning(rest)}")

    def overlong(self) -> None:
        """A request without a line end."""
        text = f"the client {self.peer} sent more than {MAX_LINE} bytes without a line end: disconnected"
        self._complain("overlong", text)

    def _complain(self, kind: str, text: str) -> None:
        self.server.complaints.warn(kind, f"{self.server.name}: {text}")
