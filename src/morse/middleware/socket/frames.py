"""Messages as binary frames.

A frame is a header of 16 bytes, a text and arrays, all little-endian:

====== ===== ==================================================================
offset bytes
====== ===== ==================================================================
0      2     ``MF``
2      1     version, 1
3      1     kind: `NOTICE`, `DATA` or `LINE`
4      4     number of the stream, unsigned; 0 for a notice
8      4     bytes of the text, unsigned; a multiple of 8
12     4     bytes of numbers and arrays, unsigned; a multiple of 8
====== ===== ==================================================================

The text of `DATA` is JSON, padded with blanks: ``{"numbers": [name, ...], "arrays": [[name, type, shape], ...],
"fields": {...}}``. The floating-point numbers follow the text, 8 bytes each, then the arrays, row by row, each padded
with zeros to a multiple of 8 bytes. Types are those of `TYPES`, or ``bytes``. ``fields`` contains all other values.
"""

from __future__ import annotations

import functools
import json
import struct
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from morse.core.reports.quoting import nearest, short
from morse.core.streams.local_data import Later
from morse.wire.encoding import plain
from morse.wire.lines import MAX_LINE, LineClient, beginning
from morse.wire.server import LineServer

if TYPE_CHECKING:
    import socket
    from collections.abc import Iterator, Mapping, Sequence

    from morse.core.values import JsonObject
    from morse.wire.connection import Connection


VERSION = 1
NOTICE, DATA, LINE = 0, 1, 2
"""A notice about the connection; a message; a message of a publisher that writes its own lines."""
TYPES = frozenset(("|b1", "|i1", "|u1", "<i2", "<u2", "<i4", "<u4", "<i8", "<u8", "<f4", "<f8"))
"""Types of the elements of arrays, in the notation of numpy: boolean, integer, unsigned, floating-point, and bytes."""

_HEAD = struct.Struct("<2sBBIII")
_ALIGNMENT = 8
#: maximum size of the text and of the arrays of a frame, bytes
_MAX_SIZE = (1 << 32) - _ALIGNMENT
_FLOATS = {float}
_encoder = msgspec.json.Encoder(enc_hook=plain)


def data_frame(number: int, fields: JsonObject) -> bytes:
    """Encode a message as a frame; floats, numpy arrays and bytes are binary, all other values are JSON.

    Args:
        number: id of the stream.
        fields: data by name.

    Raises:
        TypeError: a value has neither a binary nor a JSON representation.
        ValueError: a value contains itself, or the message is too large.
    """
    # copying a LocalData by its own methods takes several times as long as the rest
    values: JsonObject = dict.copy(fields)
    if {*map(type, values.values())} == _FLOATS:
        beginning, fixed = _prepared(number, tuple(values))
        return beginning + fixed.pack(*values.values())
    return _mixed_frame(number, fields, values)


@functools.lru_cache(maxsize=4096)
def _prepared(number: int, names: tuple[str, ...]) -> tuple[bytes, struct.Struct]:
    """The beginning of frames that only have numbers, and the format of the numbers."""
    layout = struct.Struct(f"<{len(names)}d")
    return _beginning(number, _described(names, ()), layout.size), layout


@functools.lru_cache(maxsize=4096)
def _described(numbers: tuple[str, ...], arrays: tuple[object, ...]) -> bytes:
    """The text of messages without other fields."""
    return _compact({"numbers": numbers, "arrays": arrays, "fields": {}})


def _mixed_frame(number: int, fields: Mapping[str, object], values: JsonObject) -> bytes:
    numbers: list[float] = []
    names: list[str] = []
    arrays: list[tuple[str, str, tuple[int, ...]]] = []
    others: JsonObject = {}
    parts: list[bytes | memoryview] = []
    for name, value in values.items():
        if type(value) is Later:
            value = fields[name]  # which computes it
        if isinstance(value, float):
            names.append(name)
            numbers.append(value)
        elif isinstance(value, np.ndarray) and (kind := _type_of(value.dtype)):
            arrays.append((name, kind, value.shape))
            _append(parts, np.ascontiguousarray(value, kind).data.cast("B") if value.size else b"")
        elif isinstance(value, (bytes, bytearray, memoryview)):
            content = bytes(value)
            arrays.append((name, "bytes", (len(content),)))
            _append(parts, content)
        else:
            others[name] = value
    parts.insert(0, struct.pack(f"<{len(numbers)}d", *numbers))
    if others:
        text = _compact({"numbers": names, "arrays": arrays, "fields": others})
    else:
        text = _described(tuple(names), tuple(arrays))
    return b"".join((_beginning(number, text, sum(map(len, parts))), *parts))


@functools.lru_cache(maxsize=64)
def _type_of(dtype: Any) -> str:
    """The type of the elements of an array; empty if frames do not support it."""
    kind = str(dtype.newbyteorder("<").str)
    return kind if kind in TYPES else ""


def _append(parts: list[bytes | memoryview], content: bytes | memoryview) -> None:
    parts.append(content)
    if rest := -len(content) % _ALIGNMENT:
        parts.append(bytes(rest))


def line_frame(number: int, line: bytes) -> bytes:
    """The frame of a message that is already a line of text."""
    return _beginning(number, line, 0, LINE)


def notice_frame(notice: Mapping[str, object]) -> bytes:
    """The frame of a notice."""
    return _beginning(0, _compact(notice), 0, NOTICE)


def _beginning(number: int, text: bytes, size: int, kind: int = DATA) -> bytes:
    """Header and text of a frame with a number of bytes of numbers and arrays."""
    filling = b" " * (-len(text) % _ALIGNMENT)
    if max(size, len(text)) > _MAX_SIZE:
        raise ValueError(f"a message of {size + len(text)} bytes is too large for a frame")
    return b"".join((_HEAD.pack(b"MF", VERSION, kind, number, len(text) + len(filling), size), text, filling))


def _compact(value: Mapping[str, object]) -> bytes:
    try:
        text = _encoder.encode(value)
    except (TypeError, ValueError, OverflowError, RecursionError):
        return _slowly(value)
    # "null" may also be infinity or NaN
    return _slowly(value) if b"null" in text else text


def _slowly(value: Mapping[str, object]) -> bytes:
    try:
        return json.dumps(value, default=plain, separators=(",", ":")).encode("ascii")
    except RecursionError:
        raise ValueError("the value is nested too deeply, or contains itself") from None


class FrameChannel:
    """One stream; modified only in the network thread.

    Args:
        name: name of the component.
        number: id of the stream in its frames.
        readers: the clients that wait for a message of the component; the clients of the stream are added.

    Attributes:
        name: name of the component.
        number: id of the stream in its frames.
        every: clients that get every message.
        ready: clients that wait for one message; they request each further message.
    """

    def __init__(self, name: str, number: int, readers: set[object]) -> None:
        self.name = name
        self.number = number
        self.every: set[Any] = set()
        self.ready: set[Any] = set()
        self._readers = readers

    def add(self, client: object, *, latest: bool) -> None:
        """Add a client for every message, or for one message."""
        (self.ready if latest else self.every).add(client)
        self._readers.add(client)

    def discard(self, client: object) -> None:
        """Remove a client."""
        self.every.discard(client)
        self.ready.discard(client)
        self._readers.discard(client)


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
        # first: who reads the notice may expect the message of the tick that follows
        channel.add(self, latest=latest)
        self.notify(notice_frame({"subscribed": name, "stream": channel.number}))

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
