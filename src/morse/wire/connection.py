"""One TCP connection; all functions run in the network loop."""

from __future__ import annotations

import contextlib
import socket
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    import asyncio

    from morse.core.clients.network import Network

#: bytes that are read at once: large pieces only where many bytes arrive, because their memory has to be mapped
_CHUNK, _LARGE_CHUNK = 1 << 14, 1 << 16
#: default number of unsent bytes above which a peer counts as slow
_HIGH_WATER = 1 << 16


class Listening(Protocol):
    """The callbacks of a connection."""

    def data_received(self, data: bytes) -> None:
        """Bytes have arrived."""

    def eof_received(self) -> bool:
        """The peer has closed its sending side; True keeps the connection, to send the remaining bytes."""

    def connection_lost(self, error: OSError | None) -> None:
        """The connection has ended."""

    def pause_writing(self) -> None:
        """The number of unsent bytes exceeds the limit."""

    def resume_writing(self) -> None:
        """The peer has caught up."""


class Connection:
    """One TCP connection.

    Unlike an asyncio transport, it can be read at any time (`read`): bytes received on a connection must be read
    before a later request from another connection is executed.

    Args:
        sock: as `socket.socket.accept` returned it.
        comes_first: data of this connection are read before requests are processed (see `Network.when_read`).

    Attributes:
        high_water: the peer counts as slow if more bytes are unsent.
    """

    def __init__(self, network: Network, sock: socket.socket, *, comes_first: bool) -> None:
        self._network = network
        self._socket = sock
        self._comes_first = comes_first
        self._listener: Listening
        self._rest = bytearray()
        self._chunk = _CHUNK
        self._reading = self._writing = False
        #: whether bytes are wanted; they are not read while the peer rests
        self._is_watching = False
        self._sender = network.arrivals.sender()
        self._resting: asyncio.TimerHandle | None = None
        self._slow = self._closing = self._has_ended = False
        self.high_water = _HIGH_WATER
        sock.setblocking(False)
        with contextlib.suppress(OSError):  # the peer may have disconnected
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def start(self, listener: Listening) -> None:
        """Set the listener for later events."""
        self._listener = listener
        self.resume_reading()

    def get_write_buffer_size(self) -> int:
        """Number of unsent bytes."""
        return len(self._rest)

    def is_closing(self) -> bool:
        """Whether the connection is closed or closing."""
        return self._closing or self._has_ended

    # -- reading -----------------------------------------------------------------------------

    def pause_reading(self) -> None:
        """Stop reading for a while: the peer has to wait when the buffers of the system are full."""
        self._is_watching = False
        self._watch_readable()

    def resume_reading(self) -> None:
        """Continue reading."""
        self._is_watching = True
        self._watch_readable()

    def _watch_readable(self) -> None:
        reading = self._is_watching and self._resting is None and not self.is_closing()
        if reading == self._reading:
            return
        self._reading = reading
        if reading:
            self._network.on_readable(self._socket, self.read, comes_first=self._comes_first)
        else:
            self._network.ignore(self._socket)

    def read(self) -> None:
        """Read the received bytes."""
        if not self._reading:
            return
        try:
            data = self._socket.recv(self._chunk)
        except (BlockingIOError, InterruptedError):
            return
        except OSError as error:
            self._end(error)
            return
        is_flood = len(data) == self._chunk
        self._chunk = _LARGE_CHUNK if is_flood else _CHUNK
        if is_flood:
            with self._sender.measured():
                self._listener.data_received(data)
            # a simulation that waits for its clients does not wait for their rest
            if self._sender.must_rest and not self._network.is_awaited:
                self._begin_rest()
        elif data:
            self._listener.data_received(data)
        else:
            self.pause_reading()
            if not self._listener.eof_received():
                self.close()

    def _begin_rest(self) -> None:
        self._resting = self._network.loop.call_later(self._sender.begin_rest(), self._end_rest)
        self._watch_readable()

    def _end_rest(self) -> None:
        if self._resting is not None:
            self._resting.cancel()
            self._resting = None
            self._watch_readable()

    # -- writing -----------------------------------------------------------------------------

    def write(self, data: bytes) -> None:
        """Send the bytes that the system accepts now, and the rest as soon as it accepts more."""
        if self.is_closing():
            return
        if not self._rest:
            try:
                count = self._socket.send(data)
            except (BlockingIOError, InterruptedError):
                count = 0
            except OSError as error:
                self._end(error)
                return
            if count == len(data):
                return
            data = data[count:]
            self._watch_writable(True)
        self._rest += data
        if not self._slow and len(self._rest) > self.high_water:
            self._slow = True
            self._listener.pause_writing()

    def _writable(self) -> None:
        try:
            del self._rest[: self._socket.send(self._rest)]
        except (BlockingIOError, InterruptedError):
            return
        except OSError as error:
            self._end(error)
            return
        if not self._rest:
            self._watch_writable(False)
            if self._closing:
                self._end(None)
                return
        if self._slow and len(self._rest) <= self.high_water // 4:
            self._slow = False
            self._listener.resume_writing()

    def _watch_writable(self, on: bool) -> None:
        if on != self._writing:
            self._writing = on
            loop = self._network.loop
            if on:
                loop.add_writer(self._socket, self._writable)
            else:
                loop.remove_writer(self._socket)

    # -- the end -----------------------------------------------------------------------------

    def close(self) -> None:
        """Close when all bytes are sent."""
        if self.is_closing():
            return
        self._closing = True
        self.pause_reading()
        if not self._rest:
            self._end(None)

    def abort(self) -> None:
        """Close immediately; the peer is notified by a reset."""
        if not self._has_ended:
            with contextlib.suppress(OSError):
                self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _AT_ONCE)
        self._end(None)

    def _end(self, error: OSError | None) -> None:
        if self._has_ended:
            return
        self._has_ended = True
        self.pause_reading()
        self._end_rest()
        self._watch_writable(False)
        self._rest.clear()
        # called later: the set of clients must not change during a broadcast
        self._network.loop.call_soon(self._tell_end, error)

    def _tell_end(self, error: OSError | None) -> None:
        self._socket.close()
        self._listener.connection_lost(error)


def _at_once() -> Any:
    import struct
    import sys

    return struct.pack("hh" if sys.platform == "win32" else "ii", 1, 0)


#: the value of ``SO_LINGER`` that resets a connection on close
_AT_ONCE = _at_once()
