"""Streams of messages, one message per line.

`Stream` carries text, `StreamJSON` objects, `StreamB` bytes.
"""

from __future__ import annotations

import json
import logging
import socket as _socket
from typing import TYPE_CHECKING, Any

from pymorse.channel import Channel
from pymorse.messages import Messages
from pymorse.polling import PollThread, default_poller

if TYPE_CHECKING:
    from pymorse.poller import Poller

logger = logging.getLogger("pymorse")

MSG_SEPARATOR = b"\n"
MAX_LINE = 256 << 20
"""Maximum size of a message, bytes: a server that never ends a line would take all memory."""
TIMEOUT = 8
"""Timeout for connecting and for sending published messages, s."""


class StreamB(Channel, Messages):
    """A connection that carries lines of bytes.

    Args:
        host: name or address of the host of the simulation.
        port: TCP port of the stream.
        maxlen: maximum number of received messages that are kept for `last`.
        sock: connected socket to use instead of a new connection.
        poller: thread that serves the stream; by default the running `PollThread` or a new thread.

    Raises:
        ConnectionError: no server listens there.
    """

    def __init__(
        self,
        host: str = "localhost",
        port: int = 1234,
        maxlen: int = 100,
        sock: _socket.socket | None = None,
        *,
        poller: Poller | None = None,
    ) -> None:
        Messages.__init__(self, maxlen)
        self._partial: list[bytes] = []
        self._partial_bytes = 0
        if sock is None:
            sock = connect(host, port)
        Channel.__init__(self, sock, poller or default_poller())

    def encode(self, msg: Any) -> bytes:
        """Return the bytes of a message, without the separator."""
        return bytes(msg)

    def decode(self, msg: bytes) -> Any:
        """Return the message in a line of bytes."""
        return msg

    def publish(self, msg: Any) -> None:
        """Send a message; never waits.

        Raises:
            TypeError: the message cannot be encoded.
            ConnectionError: the simulation has closed the stream.
        """
        self.send(self.encode(msg) + MSG_SEPARATOR)

    def received(self, data: bytes) -> None:
        """Split received bytes into messages."""
        first, *others = data.split(MSG_SEPARATOR)
        self._partial.append(first)
        self._partial_bytes += len(first)
        if self._partial_bytes > MAX_LINE:
            logger.error("%s sent a line of more than %d bytes, the connection is closed", self.peer, MAX_LINE)
            self._partial, self._partial_bytes = [], 0
            self.close()
            return
        if others:
            self._handle_line(b"".join(self._partial))
            for line in others[:-1]:
                self._handle_line(line)
            self._partial, self._partial_bytes = [others[-1]], len(others[-1])

    def _handle_line(self, line: bytes) -> None:
        if line := line.removesuffix(b"\r"):
            self.handle_msg(line)

    def closed(self) -> None:
        """Wake up all waiting callers, because the connection has ended."""
        self.ended()


class Stream(StreamB):
    """A connection that carries lines of text."""

    def encode(self, msg: Any) -> bytes:
        """Return the bytes of a string."""
        return str(msg).encode()

    def decode(self, msg: bytes) -> Any:
        """Return the text in a line of bytes."""
        return msg.decode(errors="replace")


class StreamJSON(StreamB):
    """A connection that carries lines of JSON."""

    def encode(self, msg: Any) -> bytes:
        """Return the JSON of an object; numpy numbers and arrays are written as numbers and lists."""
        return to_json(msg).encode()

    def decode(self, msg: bytes) -> Any:
        """Return the object in a line of JSON."""
        try:
            return json.loads(msg)
        except (ValueError, RecursionError) as error:
            raise ValueError(f"this message is not JSON ({error}): {msg[:80]!r}") from None


def to_json(value: object) -> str:
    """Return a value as one line of JSON.

    Raises:
        TypeError: the value cannot be represented in JSON.
    """
    return _encode(value)


def _plain(value: object) -> Any:
    for conversion in ("tolist", "_asdict"):
        if hasattr(value, conversion):
            return getattr(value, conversion)()
    if isinstance(value, (set, frozenset, range)):
        return list(value)
    raise TypeError(f"{value!r} cannot be sent: JSON has numbers, strings, booleans, None, lists and dictionaries")


#: created once, because `json.dumps` with a default creates an encoder at each call
_encode = json.JSONEncoder(default=_plain).encode


def connect(host: str, port: int, timeout: float = TIMEOUT) -> _socket.socket:
    """Open a TCP connection.

    Raises:
        ConnectionError: the message contains the host, the port and the reason.
    """
    if not (str(port).isascii() and str(port).isdecimal() and 0 < int(port) < 65536):
        raise ConnectionError(f"there is no port {port!r}: expected a number from 1 to 65535")
    try:
        return _socket.create_connection((host, port), timeout=timeout)
    except _socket.gaierror as error:
        raise ConnectionError(f"the host '{host}' does not exist ({error.strerror}); check the name") from None
    except TimeoutError:
        raise ConnectionError(
            f"{host}:{port} did not answer in {timeout} s; check the address and the firewall"
        ) from None
    except ConnectionRefusedError:
        raise ConnectionRefusedError(f"no server listens on {host}:{port}") from None
    except OSError as error:
        raise ConnectionError(f"cannot connect to {host}:{port}: {error}") from None


def connect_locally(path: str, timeout: float = TIMEOUT) -> _socket.socket:
    """A connection to a Unix socket.

    Raises:
        ConnectionError: saying which path, and why.
    """
    if not hasattr(_socket, "AF_UNIX"):
        raise ConnectionError("this system has no Unix sockets: connect to the port of the simulation")
    made = _socket.socket(_socket.AF_UNIX, _socket.SOCK_STREAM)
    try:
        made.settimeout(timeout)
        made.connect(path)
    except OSError as error:
        made.close()
        raise ConnectionError(
            f"no simulation listens on {path} ({error.strerror or error}); set MORSE_SOCKET_PATH={path} for 'morse run'"
        ) from None
    return made


__all__ = ["MSG_SEPARATOR", "TIMEOUT", "PollThread", "Stream", "StreamB", "StreamJSON", "connect", "to_json"]
