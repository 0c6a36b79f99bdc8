"""The connection of a node to the server; no call waits."""

from __future__ import annotations

import contextlib
import errno
import os
import socket
import time
from typing import TYPE_CHECKING

from morse.core.exceptions import MorseMultinodeError
from morse.middleware.multinode.messages import MAX_LINE

if TYPE_CHECKING:
    from collections.abc import Callable

#: wall-clock seconds between two attempts to connect, and without an answer until the connection is given up
_PAUSE, _PATIENCE = 1.0, 10.0
#: bytes that one tick reads
_MOST_BYTES = 256 << 10
_UNDER_WAY = (errno.EINPROGRESS, errno.EALREADY, errno.EWOULDBLOCK, errno.EAGAIN, errno.EINTR, errno.ENOTCONN)


class ServerConnection:
    """Connects, and connects again; sends a line, and waits for its answer before the next one.

    Args:
        host: of the server.
        port: of the server.
        now: wall-clock time, s.

    Attributes:
        is_up: whether the server has answered since the connection was made.
        problem: why there is no connection; empty if there is one.

    Raises:
        MorseMultinodeError: the name of the host is unknown.
    """

    def __init__(self, host: str, port: int, now: Callable[[], float] = time.monotonic) -> None:
        try:
            address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        except (OSError, UnicodeError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise MorseMultinodeError(f"the multi-node server {host}:{port} cannot be found: {reason}") from None
        self._family, self._address = address[0], address[4]
        self._now = now
        self._socket: socket.socket | None = None
        self._unsent = b""
        self._buffer = bytearray()
        self._next_attempt = 0.0
        self._request_time: float | None = None
        self.is_up = False
        self.problem = ""

    def exchange(self, make: Callable[[], bytes]) -> bytes | None:
        """Return the newest answer that has arrived, or None; send the next line if the last one was answered.

        Args:
            make: returns the line to send; called only when it is sent.
        """
        if self._socket is None and not self._connect():
            return None
        try:
            answer = self._read()
            if self._request_time is None and self._socket is not None:
                self._unsent, self._request_time = make(), self._now()
            self._send()
        except OSError as error:
            self._end(error.strerror or type(error).__name__)
            return None
        if self._request_time is not None and self._now() - self._request_time > _PATIENCE:
            self._end("it does not answer")
        return answer

    def _connect(self) -> bool:
        if self._now() < self._next_attempt:
            return False
        self._next_attempt = self._now() + _PAUSE
        sock = socket.socket(self._family, socket.SOCK_STREAM)
        sock.setblocking(False)
        with contextlib.suppress(OSError):
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        result = sock.connect_ex(self._address)
        if result not in (0, *_UNDER_WAY):
            sock.close()
            self.problem = os.strerror(result)
            return False
        self._socket = sock
        return True

    def _read(self) -> bytes | None:
        assert self._socket is not None
        failure = self._socket.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
        if failure:
            raise OSError(failure, os.strerror(failure))
        try:
            data = self._socket.recv(_MOST_BYTES)
        except OSError as error:
            if error.errno in _UNDER_WAY:
                return None
            raise
        if not data:
            raise ConnectionError(errno.ECONNRESET, "it has closed the connection")
        self._buffer += data
        end = self._buffer.rfind(b"\n")
        if end < 0:
            if len(self._buffer) > MAX_LINE:
                raise ConnectionError(errno.EMSGSIZE, f"its answer is longer than {MAX_LINE} bytes")
            return None
        begin = self._buffer.rfind(b"\n", 0, end) + 1
        line = bytes(self._buffer[begin:end])
        del self._buffer[: end + 1]
        self._request_time = None
        self.is_up, self.problem = True, ""
        return line

    def _send(self) -> None:
        if self._unsent and self._socket is not None:
            try:
                self._unsent = self._unsent[self._socket.send(self._unsent) :]
            except OSError as error:
                if error.errno not in _UNDER_WAY:
                    raise

    def _end(self, problem: str) -> None:
        self.close()
        self.problem = problem

    def close(self) -> None:
        """Disconnect."""
        if self._socket is not None:
            self._socket.close()
        self._socket = None
        self._buffer.clear()
        self._unsent, self._request_time, self.is_up = b"", None, False
