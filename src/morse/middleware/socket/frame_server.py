"""The port for binary streams, all streams of a client on one connection; all functions run in the network thread."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.reports.hints import nearest
from morse.middleware.socket.frame_channel import FrameChannel
from morse.middleware.socket.frame_client import FrameClient
from morse.middleware.socket.frames import notice_frame
from morse.wire.server import LineServer

if TYPE_CHECKING:
    import socket
    from collections.abc import Iterator, Sequence


#: approximate size to which frames are combined
_PIECE = 1 << 18
#: what a client is sent for whose connection there is no place
_NO_PLACE = notice_frame({"error": "the simulation has no place for one more connection", "subject": ""})


class FrameServer(LineServer):
    """The port for binary streams.

    Attributes:
        channels: the streams of sensors, by name.
    """

    def __init__(self, listener: socket.socket) -> None:
        super().__init__("binary streams", listener, lambda _: FrameClient(self), comes_first=True, refusal=_NO_PLACE)
        self.channels: dict[str, FrameChannel] = {}
        self._number = 0

    def open(self, name: str, readers: set[object]) -> FrameChannel:
        """Create the stream of a component; any thread may call it."""
        self._number += 1
        channel = self.channels[name] = FrameChannel(name, self._number, readers)
        return channel

    def end(self, channel: FrameChannel) -> None:
        """Close the stream of a deleted component, and notify its readers."""
        for client in self.clients:
            if client.unsubscribe(channel):
                client.notify(notice_frame({"closed": channel.name}))
        # a new component may have the same name
        if self.channels.get(channel.name) is channel:
            del self.channels[channel.name]

    def hint(self, name: str) -> str:
        """The most similar name of a stream."""
        return nearest(name, sorted([*self.channels]))

    def publish(self, frames: Sequence[tuple[FrameChannel, bytes]]) -> None:
        """Send frames to the subscribed clients."""
        pieces: dict[frozenset[FrameChannel], list[list[tuple[FrameChannel, bytes]]]] = {}
        for client in self.clients:
            if not (key := client.every):
                continue
            # clients with the same subscriptions get the same bytes
            if key not in pieces:
                pieces[key] = list(_pieces([(to, frame) for to, frame in frames if to in key]))
        blocks = {key: [b"".join(frame for _, frame in piece) for piece in parts] for key, parts in pieces.items()}
        for client in self.clients:
            if client.every in pieces:
                for piece, data in zip(pieces[client.every], blocks[client.every], strict=True):
                    client.offer(piece, data)
        newest = {channel: frame for channel, frame in frames if channel.ready}
        for channel, frame in newest.items():
            for client in list(channel.ready):
                channel.discard(client)
                client.offer([(channel, frame)], frame)


def _pieces(frames: Sequence[tuple[FrameChannel, bytes]]) -> Iterator[list[tuple[FrameChannel, bytes]]]:
    """Combine frames into a few pieces; no piece with more than one frame exceeds the limit for slow clients."""
    piece: list[tuple[FrameChannel, bytes]] = []
    size = 0
    for channel, frame in frames:
        if piece and size + len(frame) > _PIECE:
            yield piece
            piece, size = [], 0
        piece.append((channel, frame))
        size += len(frame)
    if piece:
        yield piece
