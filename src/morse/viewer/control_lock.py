"""Control of the simulation: any number of pages watch, one drives."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING

from morse.viewer.view_messages import Seat as SeatMessage

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

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
