"""Received messages: the latest ones are stored, callers wait for the next one, callbacks get all."""

from __future__ import annotations

import logging
import threading
import time
from collections import deque
from typing import TYPE_CHECKING, Any

from pymorse.failures import Failures

if TYPE_CHECKING:
    from collections.abc import Callable

    from pymorse.poller import Poller

logger = logging.getLogger("pymorse")

_MAX_KEPT = 16 << 20


class Messages:
    """The messages of one stream; a base class.

    A subclass passes each message to `handle_msg`, and has the attributes ``peer``, a description of the sender, and
    ``poller``, which runs the callbacks.

    Args:
        maxlen: maximum number of received messages that are stored for `last`.
    """

    peer: str
    poller: Poller
    ending = "the simulation has ended, or closed the connection"

    def __init__(self, maxlen: int = 100) -> None:
        self._kept: deque[bytes] = deque(maxlen=maxlen)
        self._kept_bytes = 0
        self._count = 0
        self._arrival = threading.Condition()
        self._subscribers: list[Callable[[Any], object]] = []
        self._failures = Failures(lambda: self.peer)

    def is_up(self) -> bool:
        """Whether messages may still arrive."""
        raise NotImplementedError

    def decode(self, msg: bytes) -> Any:
        """Return the message in received bytes."""
        return msg

    def subscribe(self, callback: Callable[[Any], object], latest: bool = False) -> None:
        """Call ``callback(message)`` for every received message, in the poll thread.

        Args:
            latest: whether to skip messages that arrive while the callback runs; only for ``Morse(binary=True)``.

        Raises:
            ValueError: ``latest`` without a binary connection.
        """
        if latest:
            raise ValueError("subscribe(latest=True) needs binary streams: connect with Morse(binary=True)")
        self._subscribers.append(callback)

    def unsubscribe(self, callback: Callable[[Any], object]) -> None:
        """Undo `subscribe`.

        Raises:
            ValueError: the callback was not subscribed.
        """
        index = self._subscribers.index(callback)
        self._failures.forget(self._subscribers.pop(index))

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
            ConnectionError: the stream has ended, so that no message will arrive.
        """
        if self.poller.is_serving():
            raise RuntimeError(
                "get() waits for the thread that runs the callbacks of subscribe(), so that these callbacks cannot "
                "call it: use last(), or the argument of the callback"
            )
        deadline = None if timeout is None else time.monotonic() + timeout
        with self._arrival:
            before = self._count
            while self._count == before:
                if not self.is_up():
                    raise ConnectionError(f"{self.peer} closed the stream: {self.ending}")
                left = 0.5 if deadline is None else deadline - time.monotonic()
                if left <= 0:
                    return None
                self._arrival.wait(min(left, 0.5))  # with short waits, Ctrl+C is processed on every platform
            raw = self._kept[-1]
        return self.decode(raw)

    def has_received(self, count: int) -> bool:
        """Whether that number of messages has arrived since the connection was opened."""
        return self._count >= count

    def wait_for_message(self, timeout: float) -> None:
        """Wait until another message has arrived, at most ``timeout`` seconds."""
        with self._arrival:
            before = self._count
            self._arrival.wait_for(lambda: self._count != before or not self.is_up(), timeout)

    def handle_msg(self, msg: bytes) -> None:
        """Process a received message."""
        self.keep(msg)
        self.tell(msg)

    def keep(self, msg: bytes) -> None:
        """Store a received message, and wake up waiting callers."""
        with self._arrival:
            if len(self._kept) == self._kept.maxlen:
                self._kept_bytes -= len(self._kept.popleft())
            self._kept.append(msg)
            self._kept_bytes += len(msg)
            while self._kept_bytes > _MAX_KEPT and len(self._kept) > 1:
                self._kept_bytes -= len(self._kept.popleft())
            self._count += 1
            self._arrival.notify_all()

    def tell(self, msg: bytes) -> None:
        """Call the subscribers."""
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
            except Exception as error:
                self._failures.add(callback, error)

    def ended(self) -> None:
        """Wake up all waiting callers, because no more messages will arrive."""
        with self._arrival:
            self._arrival.notify_all()
