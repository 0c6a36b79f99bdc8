"""Received messages: the latest ones are stored, callers wait for the next one, callbacks get all.

The messages of one tick arrive on many connections, one after the other. They are shown together, so that a program
that has waited for a message of one sensor finds those of the others of the same tick (`Arrivals`).
"""

from __future__ import annotations

import logging
import threading
import time
from collections import deque
from typing import TYPE_CHECKING, Any, NamedTuple

from pymorse.failures import Failures

if TYPE_CHECKING:
    from collections.abc import Callable

    from pymorse.poller import Poller

logger = logging.getLogger("pymorse")

_MAX_KEPT = 16 << 20
#: separates a message from the number of its tick and the number of messages of that tick; JSON does not contain it
_MARK = b"\x1e"
#: wall-clock time for which messages wait for others of their tick, s: these were sent, but the connection may be slow
_PATIENCE = 0.25
_MOST_GIVEN_UP = 64


class Messages:
    """The messages of one stream; a base class.

    A subclass passes each message to `handle_msg`, and has the attributes ``peer``, a description of the sender, and
    ``poller``, which runs the callbacks.

    Args:
        maxlen: maximum number of received messages that are stored for `last`.

    Attributes:
        is_marked: whether the simulation marks messages that belong together.
    """

    peer: str
    poller: Poller
    is_marked = False
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
        arrivals = self.poller.arrivals
        if self.is_marked:
            msg, _, mark = msg.partition(_MARK)
            arrivals.add(self, msg, mark)
        else:
            arrivals.add(self, msg)
        if not self.poller.is_serving():
            arrivals.show(everything=True)

    def keep(self, msg: bytes) -> None:
        """Store a received message; `announce` follows."""
        with self._arrival:
            if len(self._kept) == self._kept.maxlen:
                self._kept_bytes -= len(self._kept.popleft())
            self._kept.append(msg)
            self._kept_bytes += len(msg)
            while self._kept_bytes > _MAX_KEPT and len(self._kept) > 1:
                self._kept_bytes -= len(self._kept.popleft())
            self._count += 1

    def announce(self) -> None:
        """Wake up waiting callers, after `keep`."""
        with self._arrival:
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


class Arrival(NamedTuple):
    """A message that is not shown yet.

    Attributes:
        messages: the stream.
        msg: its bytes.
        tick: number of the tick, or of several that were sent together; 0 if it waits for no others.
        time: of its arrival (`time.monotonic`).
    """

    messages: Messages
    msg: bytes
    tick: int
    time: float


class Arrivals:
    """Messages that have been received, in order, and are shown together with the others of their tick.

    All functions run in the serving thread of a `Poller`.
    """

    def __init__(self) -> None:
        self._held: list[Arrival] = []
        self._bytes = 0
        #: number of messages that are missing, by tick
        self._missing: dict[int, int] = {}
        #: ticks whose missing messages were given up; these may arrive later
        self._given_up: deque[int] = deque(maxlen=_MOST_GIVEN_UP)

    def __len__(self) -> int:
        return len(self._held)

    def add(self, messages: Messages, msg: bytes, mark: bytes = b"") -> None:
        """Add a message.

        Args:
            mark: ``b"TICK COUNT"``: there are ``COUNT`` messages with that number; empty: it waits for no others.
        """
        tick, count = _read_mark(mark)
        if tick in self._given_up:
            tick = 0
        if tick:
            self._missing[tick] = self._missing.get(tick, count) - 1
            if self._missing[tick] <= 0:
                del self._missing[tick]
        self._held.append(Arrival(messages, msg, tick, time.monotonic()))
        self._bytes += len(msg)
        if self._bytes > _MAX_KEPT:
            self.show(everything=True)

    @property
    def patience(self) -> float | None:
        """Seconds until `show` waits no longer; None if no message waits."""
        return max(0.0, self._held[0].time + _PATIENCE - time.monotonic()) if self._held else None

    def show(self, everything: bool = False) -> None:
        """Store all messages of the ticks that are complete, then wake up who waits for them, then call subscribers.

        Args:
            everything: also those of ticks that are not complete.
        """
        if not self._held:
            return
        if self._missing and (everything or not self.patience):
            self._given_up.extend(self._missing)
            self._missing.clear()
        shown, held = self._held, []
        if self._missing:
            late: set[int] = set()
            shown = []
            for arrival in self._held:
                # messages of a stream keep their order
                if arrival.tick in self._missing or id(arrival.messages) in late:
                    late.add(id(arrival.messages))
                    held.append(arrival)
                else:
                    shown.append(arrival)
        self._held = held
        self._bytes = sum(len(arrival.msg) for arrival in held)
        for arrival in shown:
            arrival.messages.keep(arrival.msg)
        for messages in {id(arrival.messages): arrival.messages for arrival in shown}.values():
            messages.announce()
        for arrival in shown:
            arrival.messages.tell(arrival.msg)


def _read_mark(mark: bytes) -> tuple[int, int]:
    tick, _, count = mark.partition(b" ")
    return (int(tick), int(count)) if tick.isdigit() and count.isdigit() and len(mark) < 40 else (0, 0)
