"""One connected page: its send queue."""

from __future__ import annotations

import asyncio
import threading
import time
from typing import TYPE_CHECKING

import msgspec
from websockets.exceptions import ConnectionClosed

from morse.core.clients.budgets import Budget
from morse.viewer.page_messages import CancelService, ViewEvent
from morse.viewer.view_messages import Seat as SeatMessage

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from websockets.asyncio.server import ServerConnection

    from morse.viewer.page_messages import Watch
    from morse.viewer.view_messages import Answer, Subject


# Assigns requests to pages: every page numbers its own requests from one.

MOST_REQUESTS = 256
"""Maximum number of requests of one page that have no answer yet."""


class PageLeft(ViewEvent, frozen=True):
    """A page has disconnected; no page can send this message.

    Attributes:
        requests: its requests that have no answer yet.
    """

    requests: list[int]


class Requests:
    """Gives requests unique numbers, and restores the original numbers in answers."""

    def __init__(self) -> None:
        #: page, number of the page, size
        self._entries: dict[int, tuple[int, int, int]] = {}
        self._last = 0

    def number(self, page: int, event: ViewEvent, size: int = 0) -> ViewEvent:
        """The event for the simulation.

        Args:
            page: number of the page.
            event: as the page has sent it.
            size: bytes that `take` returns.
        """
        own = getattr(event, "request", None)
        if own is None:
            return event
        if isinstance(event, CancelService):
            number = next((number for number, request in self._entries.items() if request[:2] == (page, own)), 0)
        else:
            self._last = number = self._last + 1
            self._entries[number] = (page, own, size)
        return msgspec.structs.replace(event, request=number)

    def is_full(self, page: int, event: ViewEvent) -> bool:
        """Whether a page has too many requests without an answer to send another one."""
        if isinstance(event, CancelService) or getattr(event, "request", None) is None:
            return False
        return sum(request[0] == page for request in self._entries.values()) >= MOST_REQUESTS

    def take(self, answer: Answer) -> tuple[int, Answer, int]:
        """The page that sent the request (0: disconnected, or already answered), the answer for it, and the size."""
        page, own, size = self._entries.pop(answer.request, (0, 0, 0))
        return page, msgspec.structs.replace(answer, request=own), size

    def forget(self, page: int) -> list[int]:
        """Forget the requests of a page that has disconnected; returns those without an answer."""
        numbers = [number for number, request in self._entries.items() if request[0] == page]
        for number in numbers:
            del self._entries[number]
        return numbers


# Control of the simulation: any number of pages watch, one drives.

DEAD_MAN = 0.7
"""Seconds without a heartbeat from the driving page after which all keys count as released."""

_NOTHING: frozenset[str] = frozenset()


class ControlLock:
    """The page that drives, and its pressed keys.

    Modified in the network thread; the simulation thread reads the controls.

    Attributes:
        driver: number of the driving page, or None.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._lock = threading.Lock()
        self.driver: int | None = None
        self._asking: list[int] = []
        self._last_keys = 0.0
        self._keys = _NOTHING
        self._taps: set[str] = set()
        self._tick_taps = _NOTHING
        self._axes: tuple[float, ...] = ()
        self._buttons: tuple[bool, ...] = ()

    # the driving page ----------------------------------------------------------------------------------

    def enter(self, page: int) -> None:
        """Add a page; the page drives if no other page does."""
        if self.driver is None:
            self._give(page)

    def leave(self, page: int, pages: Sequence[int] = ()) -> None:
        """Remove a page. If it drove, the first page that has requested control gets it, or the only remaining page.

        Args:
            pages: the remaining pages.
        """
        self._asking = [other for other in self._asking if other != page]
        if self.driver == page:
            self._give(self._asking[0] if self._asking else None)
        if self.driver is None and len(pages) == 1:
            self._give(pages[0])

    def ask(self, page: int) -> None:
        """A page requests control: granted immediately if the driving page sends no heartbeat."""
        if page == self.driver:
            return
        if self.driver is None or not self.alive:
            self._give(page)
        elif page not in self._asking:
            self._asking.append(page)

    def hand_over(self, page: int, to: int, pages: Sequence[int]) -> bool:
        """The driver ``page`` hands over; False if it is not the driver, or the other page is not connected."""
        if page != self.driver or to not in pages:
            return False
        self._give(to)
        return True

    def keep(self, page: int) -> None:
        """The driver declines all requests."""
        if page == self.driver:
            self._asking.clear()

    def message(self, pages: int) -> SeatMessage:
        """The message to the pages."""
        return SeatMessage(self.driver, list(self._asking), pages)

    def _give(self, page: int | None) -> None:
        self.driver = page
        self._asking = [other for other in self._asking if other != page]
        self.release()
        self._last_keys = self._clock()

    # pressed keys --------------------------------------------------------------------------------

    @property
    def alive(self) -> bool:
        """Whether the driving page has sent a heartbeat recently."""
        return self.driver is not None and self._clock() - self._last_keys < DEAD_MAN

    def hear(self, page: int) -> None:
        """A heartbeat; after a timeout, keys must be pressed again."""
        if page != self.driver:
            return
        if not self.alive:
            self.release()
        self._last_keys = self._clock()

    def hold(self, page: int, keys: frozenset[str]) -> None:
        """The pressed keys of a page; only those of the driving page count."""
        if page != self.driver:
            return
        with self._lock:
            self._taps |= keys - (self._keys if self.alive else _NOTHING)
            self._keys = keys
            self._last_keys = self._clock()

    def steer(self, page: int, axes: tuple[float, ...], buttons: tuple[bool, ...]) -> None:
        """The gamepad of a page."""
        if page == self.driver:
            self._axes, self._buttons = axes, buttons
            self._last_keys = self._clock()

    def release(self) -> None:
        """Release all keys and the gamepad."""
        with self._lock:
            self._keys = _NOTHING
            self._taps.clear()
            self._axes, self._buttons = (), ()

    def begin_tick(self) -> None:
        """Keys that were pressed and released since the last call count as pressed until the next call."""
        if not self._taps and not self._tick_taps:
            return
        with self._lock:
            self._tick_taps = frozenset(self._taps)
            self._taps.clear()

    def held_keys(self) -> frozenset[str]:
        """The pressed keys of a driver with a heartbeat."""
        keys = self._keys if self._keys and self.alive else _NOTHING
        return keys | self._tick_taps if self._tick_taps else keys

    def gamepad(self) -> tuple[tuple[float, ...], tuple[bool, ...]]:
        """Axes (-1..1) and buttons of a driver with a heartbeat."""
        return (self._axes, self._buttons) if self._axes and self.alive else ((), ())


WINDOW = 15
"""Maximum number of pose frames in transit to a page: a quarter of a second."""

MOST_WAITING = 5000
"""Maximum number of messages that wait for a page, besides those that it began with; a slower page is disconnected."""


class Page:
    """A connected page.

    A newer message replaces an unsent older one on the same subject. A slow page gets fewer messages, but no late
    messages.

    Attributes:
        number: its id for other pages.
        watch: what it shows.
        drawn: whether it has drawn the world.
        memory: for its requests without an answer, and for unsent messages that no newer ones replace.
    """

    def __init__(self, number: int, connection: ServerConnection) -> None:
        self.number = number
        self.connection = connection
        self.watch: Watch | None = None
        self.drawn = False
        self.memory = Budget()
        self._waiting: dict[Subject | int, str | bytes] = {}
        self._unique = 0
        self._most_waiting = MOST_WAITING
        self._poses: bytes | None = None
        self._frame_count = 0
        self._receipts = 0
        self._wake = asyncio.Event()

    def tell(self, subject: Subject | None, frame: str | bytes) -> None:
        """Queue a message."""
        key: Subject | int
        if subject is None:
            self._unique += 1
            key = self._unique
            self.memory.force(len(frame))
        else:
            key = subject
            self._waiting.pop(key, None)
        self._waiting[key] = frame
        self._wake.set()

    def show(self, poses: bytes) -> bool:
        """Queue the newest poses; they replace older ones in the queue.

        Returns:
            Whether the page can take them now: then they count as sent, and the caller has to send them.
        """
        self._poses = poses
        if self._frame_count - self._receipts >= WINDOW:
            return False
        if self._waiting or self.connection.transport.get_write_buffer_size():
            self._wake.set()
            return False
        self._poses = None
        self._frame_count += 1
        return True

    def took(self, count: int) -> None:
        """Set the number of pose frames that the page has received."""
        self._receipts = min(count, self._frame_count)
        if self._poses is not None:
            self._wake.set()

    @property
    def hopeless(self) -> bool:
        """Whether it is so far behind that it cannot catch up."""
        return len(self._waiting) > self._most_waiting or self.memory.left < 0

    def begin(self, messages: Mapping[Subject, str | bytes]) -> None:
        """Queue the lasting messages, of which a scene with many components has thousands."""
        self._waiting.update(messages.items())
        self._most_waiting = MOST_WAITING + len(messages)
        self._wake.set()

    async def send_forever(self) -> None:
        """Send queued messages until the connection is closed."""
        try:
            while True:
                await self._wake.wait()
                self._wake.clear()
                # messages first: poses may belong to a world that one of them announces
                while self._waiting:
                    key = next(iter(self._waiting))
                    frame = self._waiting.pop(key)
                    if isinstance(key, int):
                        self.memory.give(len(frame))
                    await self.connection.send(frame)
                if self._poses is not None and self._frame_count - self._receipts < WINDOW:
                    poses, self._poses = self._poses, None
                    self._frame_count += 1
                    await self.connection.send(poses)
        except ConnectionClosed:
            pass  # the receiving task handles the end
