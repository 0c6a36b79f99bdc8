"""One share of the time for everything that clients send."""

from __future__ import annotations

import asyncio
import threading
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

#: share of the network thread for what all clients send, and share of the ticks for commands; the rest is for the data
#: of the sensors, and for the simulation
_SHARE = 0.25
#: processor time that a client may use at once, s: less than that of a tick
_TURN = 0.004
#: wall-clock seconds after its last message for which a client counts when the share is divided
_ACTIVE = 0.5


class Arrivals:
    """Divides the time between all clients of a simulation, whatever protocol they use; for any thread.

    While all clients together use less than the share, none of them rests. Otherwise each gets an equal part of it, and
    a client that uses less than its part does not rest, either.

    Args:
        processor: processor time of the calling thread, s.
        wall: wall-clock time, s.

    Attributes:
        newcomers: the account of all connections that are not open yet: they get the part of one client, because a
            client may connect again and again.
    """

    def __init__(
        self, processor: Callable[[], float] = time.thread_time, wall: Callable[[], float] = time.monotonic
    ) -> None:
        self.processor, self.wall = processor, wall
        self.lock = threading.Lock()
        self._debt = 0.0
        self._last = wall()
        self._active: dict[Sender, float] = {}
        self._threads = threading.local()
        self.newcomers = Sender(self)

    def spend(self, sender: Sender, seconds: float, now: float) -> bool:
        """Count processor time of a client; whether all of them together use more than the share. Under `lock`."""
        self._debt = max(0.0, self._debt - _SHARE * (now - self._last)) + seconds
        self._last = now
        self.expect(sender, now + _ACTIVE)
        return self._debt >= _TURN

    def expect(self, sender: Sender, until: float) -> None:
        """Let a client count at least until a time."""
        self._active[sender] = max(until, self._active.get(sender, 0.0))

    def part(self, now: float) -> float:
        """The part of one client. Under `lock`."""
        for sender in [sender for sender, until in self._active.items() if until < now]:
            del self._active[sender]
        return _SHARE / max(1, len(self._active))

    def sender(self) -> Sender:
        """The account of a new client."""
        return Sender(self)

    def received(self) -> None:
        """A message has arrived in a thread that only receives: the thread sleeps if it has used its time.

        The time of the thread since the last call counts: the library that calls has read and decoded the message.
        """
        if not hasattr(self._threads, "sender"):
            self._threads.sender, self._threads.last = self.sender(), self.processor()
        sender: Sender = self._threads.sender
        sender.spend(self.processor() - self._threads.last)
        if sender.must_rest:
            time.sleep(sender.begin_rest())
        self._threads.last = self.processor()


class Sender:
    """The account of one client: what it sends costs time, and time passes.

    Attributes:
        must_rest: whether the client has used its time.
        until: wall-clock time until which it rests; None if it does not.
    """

    def __init__(self, arrivals: Arrivals) -> None:
        self._arrivals = arrivals
        self._debt = 0.0
        self._last = arrivals.wall()
        self.until: float | None = None
        self.must_rest = False

    @contextmanager
    def measured(self) -> Iterator[None]:
        """Add the processor time of the block, which must not wait, to the account."""
        begin = self._arrivals.processor()
        try:
            yield
        finally:
            self.spend(self._arrivals.processor() - begin)

    def spend(self, seconds: float) -> None:
        """Add processor time to the account."""
        arrivals = self._arrivals
        with arrivals.lock:
            now = arrivals.wall()
            is_crowded = arrivals.spend(self, seconds, now)
            self._debt = max(0.0, self._debt - arrivals.part(now) * max(0.0, now - self._last)) + seconds
            self._last = now
            if not is_crowded:
                self._debt = min(self._debt, _TURN / 2)
            self.must_rest = self._debt >= _TURN

    def begin_rest(self) -> float:
        """Begin to rest; returns the duration, s."""
        arrivals = self._arrivals
        with arrivals.lock:
            now = arrivals.wall()
            duration = self._debt * (1.0 / arrivals.part(now) - 1.0)
            arrivals.expect(self, now + duration + _ACTIVE)
        self._debt = 0.0
        self.must_rest = False
        self._last = now + duration
        return duration

    async def rest(self) -> None:
        """Rest if the client has used its time; let others run in any case.

        To receive a message that has arrived does not wait. On a machine that gives the thread little time, a client
        may send messages all the time without having to rest.
        """
        await asyncio.sleep(self.begin_rest() if self.must_rest else 0.0)

    @property
    def rests(self) -> bool:
        """Whether a rest that `rest_if_due` has begun lasts."""
        return self.remaining > 0.0

    @property
    def remaining(self) -> float:
        """The rest that is left, s."""
        if self.until is None:
            return 0.0
        remaining = self.until - self._arrivals.wall()
        if remaining <= 0.0:
            self.until = None
        return max(0.0, remaining)

    def rest_if_due(self) -> None:
        """Begin a rest, which `rests` tells, if the client has used its time."""
        if self.must_rest:
            self.until = self._arrivals.wall() + self.begin_rest()
