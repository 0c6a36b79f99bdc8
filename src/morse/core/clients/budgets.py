"""The memory that a client may occupy, in bytes."""

from __future__ import annotations

import asyncio
import threading
import time
from contextlib import contextmanager
from time import perf_counter
from typing import TYPE_CHECKING, Protocol
from weakref import WeakKeyDictionary

from morse.core.exceptions import MorseRPCInvokationError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from morse.core.clock import Clock


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


CLIENT_BYTES = 14 << 20
"""Maximum size of everything that is kept for one client: what it has sent and asked for, and what it has not read."""
ENTRY = 512
"""Size of an entry of a table, or of a pending request, in addition to its texts."""
PARSED = 32
"""Maximum size of parsed JSON, or of a parsed bottle, as a multiple of its bytes: an empty object has three bytes."""


class OverBudget(ValueError):
    """A client wants to occupy more memory than it may."""


class Budget:
    """A number of bytes that a client, or several clients together, may occupy; for any thread.

    Attributes:
        left: bytes that are not occupied; negative if `force` has taken more.
    """

    def __init__(self, size: int = CLIENT_BYTES) -> None:
        self.size = self.left = size
        self._lock = threading.Lock()

    def take(self, count: int) -> bool:
        """Reserve bytes; False if fewer are left."""
        with self._lock:
            if count > self.left:
                return False
            self.left -= count
            return True

    def force(self, count: int) -> bool:
        """Reserve bytes in any case; returns whether that many were left."""
        with self._lock:
            self.left -= count
            return self.left >= 0

    def give(self, count: int) -> None:
        """Release reserved bytes."""
        with self._lock:
            self.left += count

    def charge(self, count: int, what: str) -> None:
        """Reserve bytes.

        Args:
            count: of bytes.
            what: for the message: what is refused.

        Raises:
            OverBudget: fewer are left.
        """
        if not self.take(count):
            raise OverBudget(
                f"{what} is refused: it takes {count} bytes, and {max(0, self.left)} of {self.size} bytes for one "
                "client are left"
            )


#: share of the wall-clock time for services if clients request more
_SERVICE_SHARE = 1 / 3
#: wall-clock seconds after its last request for which a middleware counts when the share is divided
_SERVICE_ACTIVE = 0.5
#: minimum and maximum time for services in each tick, s
_LEAST, _MOST = 0.0003, 0.05


class TimeShares:
    """The shares of the middlewares of a simulation: together they get as much as one alone."""

    def __init__(self) -> None:
        self._active: dict[TimeShare, float] = {}

    def part(self, share: TimeShare, now: float) -> float:
        """The part of a middleware that has requests."""
        self._active[share] = now
        if len(self._active) > 1:
            self._active = {one: last for one, last in self._active.items() if now - last < _SERVICE_ACTIVE}
        return _SERVICE_SHARE / len(self._active)


class TimeShare:
    """Limits the time that ticks spend on requests to a third of the other time.

    A tick serves requests until its share is used. A request is never interrupted; if it takes longer than the share,
    the next requests wait: after 20 ms for a request, for about 60 ms.

    Args:
        shares: those of all middlewares of the simulation.
    """

    def __init__(self, shares: TimeShares | None = None) -> None:
        self._shares = TimeShares() if shares is None else shares
        self._debt = 0.0
        self._last_end = self._limit = perf_counter()

    @property
    def is_owing(self) -> bool:
        """Whether the last requests took more than their share, so that the next requests wait."""
        return self._debt > 0.0

    def begin(self) -> bool:
        """Return whether requests may be served in this tick."""
        now = perf_counter()
        idle, self._last_end = now - self._last_end, now
        credit = self._shares.part(self, now) * idle - self._debt
        self._debt = max(0.0, -credit)
        if credit < 0.0:
            return False
        self._limit = now + max(_LEAST, min(_MOST, credit))
        return True

    def spend(self) -> float:
        """Return the time of a request that has just been served, s."""
        now = perf_counter()
        duration, self._last_end = now - self._last_end, now
        return duration

    def is_used(self) -> bool:
        """Return whether the share of this tick is used; called after `spend`."""
        self._debt = max(0.0, self._last_end - self._limit)
        return self._debt > 0.0

    def end_request(self) -> bool:
        """Count a request that has just been served; return whether the share of this tick is used."""
        self.spend()
        return self.is_used()


MOST_PIXELS = 8_000_000
"""The budget, pixels per simulated second."""

RAY = 16
"""Pixels that a ray counts as: a ray is cast, becomes a point, and is written in messages."""

#: Hz; a measurement is made within a tick, whatever its rate, and others wait for the tick: a rare one may not be large
LEAST_RATE = 10.0


class Sensing(Protocol):
    """A component that may take images or cast rays."""

    frequency: float
    clock: Clock

    def sensing_cost(self) -> float:
        """The pixels of a measurement."""


class SensingBudget:
    """The budget of one simulation.

    Args:
        components: returns the present sensors and actuators.
    """

    def __init__(self, components: Callable[[], Iterable[Sensing]]) -> None:
        self._components = components
        #: pixels per second of what a script or a program has created
        self._granted: WeakKeyDictionary[Sensing, float] = WeakKeyDictionary()

    def grant(self, components: Iterable[Sensing]) -> None:
        """Allow what a scene script or a program has created, as it is at present."""
        for component in components:
            if pixels := _rate(component):
                self._granted[component] = pixels

    def allowance(self, component: Sensing) -> float:
        """Pixels per second that are allowed for a component because of the script."""
        return self._granted.get(component, 0.0)

    def allow(self, component: Sensing, pixels: float) -> None:
        """Allow as much for a component that takes the place of one of the script."""
        self._granted[component] = pixels

    def replace(self, before: Sensing, after: Sensing) -> None:
        """A component takes the place of another one, because its class was edited."""
        if before in self._granted:
            self.grant([after])

    def check(self, who: str, changed: Iterable[Sensing]) -> None:
        """Check what clients have set and spawned.

        Args:
            who: what a client has just changed or spawned, for the message.
            changed: its components.

        Raises:
            MorseRPCInvokationError: all together is more than the budget, and ``changed`` is more than scripts allow.
        """
        asked = sum(map(self._extra, changed))
        if not asked:
            return
        total = sum(map(self._extra, self._components()))
        if total > MOST_PIXELS:
            left = max(MOST_PIXELS - (total - asked), 0.0)
            rule = f"a ray counts as {RAY} pixels, less than {LEAST_RATE:g} measurements per second as {LEAST_RATE:g}"
            raise MorseRPCInvokationError(
                f"{who}: the budget for what clients set is {MOST_PIXELS:,} pixels per simulated second ({rule}): "
                f"{asked:,.0f} are asked, {left:,.0f} are left; the scene script may set more"
            )

    def _extra(self, component: Sensing) -> float:
        """Pixels per second in addition to those that the script allows."""
        return max(_rate(component) - self._granted.get(component, 0.0), 0.0)


def _rate(component: Sensing) -> float:
    """Pixels per simulated second of a component while it measures."""
    try:
        pixels = component.sensing_cost()
        return pixels * min(max(component.frequency, LEAST_RATE), component.clock.frequency) if pixels else 0.0
    except Exception:  # code of a user, which cannot tell
        return 0.0
