"""A TCP connection that is served by a `Poller`."""

from __future__ import annotations

import contextlib
import socket
import threading
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pymorse.poller import Poller

#: bytes that are read at once: large buffers are only used if many bytes arrive, because their memory has to be mapped
_CHUNK, _LARGE_CHUNK = 1 << 14, 1 << 18
#: time for which one connection is read before the others have their turn, wall-clock seconds
_SHARE = 0.05
MAX_UNSENT = 64 << 20
"""Maximum number of unsent bytes for a simulation that does not read."""


#: the system tells what has arrived, and leaves it there
_LOOK = socket.MSG_PEEK


class Channel:
    """One TCP connection.

    Args:
        sock: connected socket, which the channel owns from now on.
        poller: thread that serves it.
    """

    def __init__(self, sock: socket.socket, poller: Poller) -> None:
        self.socket = sock
        self.poller = poller
        self.peer = _peer(sock)
        self.connection = _connection(sock)
        self._unsent = bytearray()
        self._state = threading.Condition()
        self._up = True
        sock.setblocking(False)
        with contextlib.suppress(OSError):  # the socket may not be a TCP socket
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        poller.add(self)

    def is_up(self) -> bool:
        """Whether the connection is open."""
        return self._up

    def received(self, data: bytes) -> None:
        """Called in the poll thread when bytes have arrived."""

    def closed(self) -> None:
        """Called once when the connection has ended, usually in the poll thread."""

    def send(self, data: bytes) -> None:
        """Send as much as possible now, and the rest from the poll thread; never blocks.

        Raises:
            ConnectionError: the connection has ended.
            BufferError: the other side does not read.
        """
        with self._state:
            if not self._up or self._has_ended():
                raise ConnectionError(f"the connection to {self.peer} is closed: is the simulation still running?")
            if not self._unsent:
                data = data[self._push(data) :]
                if not data:
                    return
            elif len(self._unsent) + len(data) > MAX_UNSENT:
                raise BufferError(f"{self.peer} has not read {len(self._unsent)} bytes: has the simulation stopped?")
            self._unsent += data
        self.poller.command(lambda: self.poller.watch_writable(self, True))

    def _has_ended(self) -> bool:
        """Whether the other side has closed the connection, which the poll thread may not know yet."""
        try:
            return not self.socket.recv(1, _LOOK)
        except (BlockingIOError, InterruptedError):
            return False
        except OSError:
            return True

    def _push(self, data: bytes | bytearray) -> int:
        try:
            return self.socket.send(data)
        except (BlockingIOError, InterruptedError):
            return 0
        except OSError:
            # the poll thread gets the same error and closes the connection
            return 0

    def drain(self, timeout: float) -> bool:
        """Wait until everything has been sent; return False if this takes longer than ``timeout`` seconds."""
        deadline = time.monotonic() + timeout
        with self._state:
            while self._unsent and self._up:
                left = deadline - time.monotonic()
                if left <= 0:
                    return False
                self._state.wait(min(left, 0.5))
            return not self._unsent

    def writable(self) -> None:
        """Called in the poll thread when the socket is writable again."""
        with self._state:
            del self._unsent[: self._push(self._unsent)]
            if not self._unsent:
                self.poller.watch_writable(self, False)
                self._state.notify_all()

    def readable(self) -> None:
        """Read available bytes, or the end of the connection; called in the poll thread.

        A server that sends without end would otherwise keep the thread from its commands and timeouts.
        """
        more, chunk, until = True, _CHUNK, time.monotonic() + _SHARE
        while more and self._up and time.monotonic() < until:
            try:
                data = self.socket.recv(chunk)
            except (BlockingIOError, InterruptedError):
                return
            except OSError:
                data = b""
            if not data:
                self.close()
                return
            begin = time.monotonic()
            self.received(data)
            # a large chunk of tiny messages would take the time of the other sockets
            is_quick = (time.monotonic() - begin) * _LARGE_CHUNK < _SHARE * chunk
            more, chunk = len(data) == chunk, _LARGE_CHUNK if is_quick else _CHUNK

    def close(self) -> None:
        """Close the connection; bytes that were passed to the operating system are still sent."""
        self.poller.call(self._close)

    def _close(self) -> None:
        with self._state:
            if not self._up:
                return
            self._up = False
            self._state.notify_all()
        self.poller.remove(self)
        with contextlib.suppress(OSError):
            self.socket.shutdown(socket.SHUT_WR)
        self.socket.close()
        self.closed()


def _peer(sock: socket.socket) -> str:
    try:
        address = sock.getpeername()
    except OSError:
        return "the other side"
    return f"{address[0]}:{address[1]}" if isinstance(address, tuple) else "the other side"


def _connection(sock: socket.socket) -> str:
    """Address and port of this end, and port of the other end, as seen from there if no router translates addresses.

    All three are needed, because the operating system uses the same port for several connections to different ports.
    """
    try:
        name, port = sock.getsockname(), sock.getpeername()[1]
        return f"{name[0]}:{name[1]} {port}"
    except (OSError, IndexError, TypeError):  # the socket may not be a TCP socket
        return ""
