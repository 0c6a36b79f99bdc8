"""Streams of messages, one message per line.

`Stream` carries text, `StreamJSON` objects, `StreamB` bytes.
"""

from __future__ import annotations

import json
import logging
import socket as _socket
import threading
import time
from collections import deque
from typing import TYPE_CHECKING, Any

from pymorse.channel import Channel
from pymorse.polling import PollThread, default_poller

if TYPE_CHECKING:
    from collections.abc import Callable

    from pymorse.poller import Poller

logger = logging.getLogger("pymorse")

MSG_SEPARATOR = b"\n"
TIMEOUT = 8
"""Timeout for connecting and for sending published messages, s."""
_MAX_KEPT = 16 << 20


class StreamB(Channel):
    """A connection that carries lines of bytes.

    Args:
        host: name or address of the machine of the simulation.
        port: TCP port of the stream.
        maxlen: maximum number of received messages that are kept for `last`.
        sock: a connected socket to use instead of a new connection.
        poller: the thread that serves the stream, if not the running `PollThread` or a new one.

    Raises:
        ConnectionError: nothing listens there.
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
        self._kept: deque[bytes] = deque(maxlen=maxlen)
        self._kept_bytes = 0
        self._count = 0
        self._arrival = threading.Condition()
        self._subscribers: list[Callable[[Any], object]] = []
        self._partial: list[bytes] = []
        if sock is None:
            sock = connect(host, port)
        super().__init__(sock, poller or default_poller())

    def encode(self, msg: Any) -> bytes:
        """The bytes of a message, without the separator."""
        return bytes(msg)

    def decode(self, msg: bytes) -> Any:
        """The message in a line of bytes."""
        return msg

    def publish(self, msg: Any) -> None:
        """Send a message; never waits.

        Raises:
            TypeError: the message cannot be encoded.
            ConnectionError: the simulation has closed the stream.
        """
        self.send(self.encode(msg) + MSG_SEPARATOR)

    def subscribe(self, callback: Callable[[Any], object]) -> None:
        """Call ``callback(message)`` for every received message, in the poll thread."""
        self._subscribers.append(callback)

    def unsubscribe(self, callback: Callable[[Any], object]) -> None:
        """Undo `subscribe`.

        Raises:
            ValueError: the callback was not subscribed.
        """
        self._subscribers.remove(callback)

    def last(self, n: int = 1) -> Any:
        """The most recent message, or the ``n``-th most recent; None if there is none. Never waits."""
        with self._arrival:
            raw = self._kept[-n] if 0 < n <= len(self._kept) else None
        return None if raw is None else self.decode(raw)

    def get(self, timeout: float | None = None) -> Any:
        """Wait for the next message.

        Args:
            timeout: timeout, s; None for no timeout.

        Returns:
            The message, or None if none arrived in time.

        Raises:
            ConnectionError: the stream ended, no message will arrive.
        """
        if self.poller.is_serving():
            raise RuntimeError(
                "get() waits for the thread that runs the callbacks of subscribe(), so they cannot call it: "
                "use last(), or the message that the callback got"
            )
        deadline = None if timeout is None else time.monotonic() + timeout
        with self._arrival:
            before = self._count
            while self._count == before:
                if not self._up:
                    raise ConnectionError(f"{self.peer} closed the stream: the simulation has ended, or left us behind")
                left = 0.5 if deadline is None else deadline - time.monotonic()
                if left <= 0:
                    return None
                self._arrival.wait(min(left, 0.5))  # short waits let Ctrl+C through on every platform
            raw = self._kept[-1]
        return self.decode(raw)

    def has_received(self, count: int) -> bool:
        """Whether that many messages have arrived since the connection was made."""
        return self._count >= count

    def wait_for_message(self, timeout: float) -> None:
        """Wait until another message has arrived, at most ``timeout`` seconds."""
        with self._arrival:
            before = self._count
            self._arrival.wait_for(lambda: self._count != before or not self._up, timeout)

    def received(self, data: bytes) -> None:
        """Split received bytes into messages."""
        first, *others = data.split(MSG_SEPARATOR)
        self._partial.append(first)
        if others:
            self._handle_line(b"".join(self._partial))
            for line in others[:-1]:
                self._handle_line(line)
            self._partial = [others[-1]]

    def _handle_line(self, line: bytes) -> None:
        if line := line.removesuffix(b"\r"):
            self.handle_msg(line)

    def handle_msg(self, msg: bytes) -> None:
        """Store a received line, wake up waiting callers, and call the subscribers."""
        with self._arrival:
            if len(self._kept) == self._kept.maxlen:
                self._kept_bytes -= len(self._kept.popleft())
            self._kept.append(msg)
            self._kept_bytes += len(msg)
            while self._kept_bytes > _MAX_KEPT and len(self._kept) > 1:
                self._kept_bytes -= len(self._kept.popleft())
            self._count += 1
            self._arrival.notify_all()
        if not self._subscribers:
            return
        try:
            decoded = self.decode(msg)
        except ValueError as error:
            logger.error("%s: %s", self.peer, error)
            return
        for callback in list(self._subscribers):
            try:
                callback(decoded)
            except Exception:
                logger.exception("a callback of subscribe() failed on a message of %s", self.peer)

    def closed(self) -> None:
        """Wake up all waiting callers, because the connection has ended."""
        with self._arrival:
            self._arrival.notify_all()


class Stream(StreamB):
    """A connection that carries lines of text."""

    def encode(self, msg: Any) -> bytes:
        """The bytes of a string."""
        return str(msg).encode()

    def decode(self, msg: bytes) -> Any:
        """The text in a line of bytes."""
        return msg.decode(errors="replace")


class StreamJSON(StreamB):
    """A connection that carries lines of JSON."""

    def encode(self, msg: Any) -> bytes:
        """The JSON of an object; numpy numbers and arrays are written as numbers and lists."""
        return to_json(msg).encode()

    def decode(self, msg: bytes) -> Any:
        """The object in a line of JSON."""
        try:
            return json.loads(msg)
        except (ValueError, RecursionError) as error:
            raise ValueError(f"this message is no JSON ({error}): {msg[:80]!r}") from None


def to_json(value: Any) -> str:
    """A value as one line of JSON.

    Raises:
        TypeError: the value cannot be represented in JSON.
    """
    return json.dumps(value, default=_plain)


def _plain(value: Any) -> Any:
    for conversion in ("tolist", "_asdict"):
        if hasattr(value, conversion):
            return getattr(value, conversion)()
    if isinstance(value, (set, frozenset, range)):
        return list(value)
    raise TypeError(f"{value!r} cannot be sent: JSON has numbers, strings, booleans, None, lists and dictionaries")


def connect(host: str, port: int, timeout: float = TIMEOUT) -> _socket.socket:
    """A TCP connection.

    Raises:
        ConnectionError: saying which host and port, and why.
    """
    try:
        return _socket.create_connection((host, port), timeout=timeout)
    except _socket.gaierror as error:
        raise ConnectionError(f"there is no host '{host}' ({error.strerror}); check the name") from None
    except TimeoutError:
        raise ConnectionError(
            f"{host}:{port} did not answer in {timeout} s; check the address and the firewall"
        ) from None
    except ConnectionRefusedError:
        raise ConnectionRefusedError(f"nothing listens on {host}:{port}") from None
    except OSError as error:
        raise ConnectionError(f"cannot connect to {host}:{port}: {error}") from None


__all__ = ["MSG_SEPARATOR", "TIMEOUT", "PollThread", "Stream", "StreamB", "StreamJSON", "connect", "to_json"]
