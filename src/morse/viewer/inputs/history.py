"""Saves states of the simulation, so that the driving page can restore them."""

from __future__ import annotations

import bisect
import logging
import math
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar

from morse.core.exceptions import MorseError
from morse.viewer.view_messages import History, Refused

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.viewer.server import ViewServer

_S = TypeVar("_S")

logger = logging.getLogger(__name__)

#: simulated seconds between two saved states while time runs; seconds for which they are kept, simulated and wall-clock
_EVERY, _SPAN = 0.5, 60.0
#: largest share of the time that is spent on saving states while time runs
_SHARE = 0.01
#: approximate size of all states together, bytes; of larger states fewer are kept
_MOST_BYTES = 64 * 1024 * 1024
#: simulated times that differ by less count as equal, s
_ROUNDING = 1e-9
#: approximate overhead of a value, bytes
_OVERHEAD = 64


class Restorable(Protocol[_S]):
    """The part of a simulation that the history uses."""

    def save(self) -> _S:
        """The state, as plain data."""

    def restore(self, state: _S) -> None:
        """Restore a state."""

    def pause(self) -> None:
        """Stop time."""


@dataclass(frozen=True, slots=True)
class _Kept(Generic[_S]):
    time: float
    state: _S
    size: int
    wall: float


def _time_of(entry: _Kept[_S]) -> float:
    return entry.time


class Rewinder(Generic[_S]):
    """A ring of states: every half second of the last minute, and every single tick.

    A simulation that runs much faster than real time is saved less often, so that its ticks are not slowed.

    Args:
        now: simulated seconds.
        wall: wall-clock seconds.
    """

    def __init__(
        self,
        simulation: Restorable[_S],
        now: Callable[[], float],
        server: ViewServer,
        wall: Callable[[], float] = time.monotonic,
    ) -> None:
        self._simulation = simulation
        self._now = now
        self._wall = wall
        self._rest_until = -math.inf
        self._is_warned = False
        self._server = server
        self._moments: list[_Kept[_S]] = []
        self._bytes = 0
        self._last_times: list[float] = []
        #: the time of the present state of the simulation
        self._at = -1.0

    def keep(self, *, paused: bool) -> None:
        """A tick has ended: save the state if it is time."""
        now = self._now()
        if now == self._at:
            return
        self._at = now
        if self._moments and self._moments[-1].time >= now:
            # time continues from an earlier state: the states after it are invalid
            self._cut(bisect.bisect_left(self._moments, now, key=_time_of))
            self.tell()
        if paused or not self._moments or (now - self._moments[-1].time >= _EVERY - _ROUNDING and self._may_save()):
            self._save(now)
            self.tell()

    def _may_save(self) -> bool:
        return self._wall() >= self._rest_until

    def _save(self, now: float) -> None:
        begin = self._wall()
        try:
            state = self._simulation.save()
        except MorseError as error:  # from ``get_state`` of a component of the user
            if not self._is_warned:
                self._is_warned = True
                logger.warning("the live view cannot return to this time: %s", error)
            self._rest_until = self._wall() + _EVERY
            return
        self._add(_Kept(now, state, size_of(state), begin))
        end = self._wall()
        self._rest_until = end + (end - begin) * (1.0 / _SHARE - 1.0)

    def _add(self, entry: _Kept[_S]) -> None:
        self._moments.append(entry)
        self._bytes += entry.size
        first = 0
        while first < len(self._moments) - 1 and (
            self._bytes > _MOST_BYTES or self._is_old(self._moments[first], entry)
        ):
            self._bytes -= self._moments[first].size
            first += 1
        del self._moments[:first]

    @staticmethod
    def _is_old(entry: _Kept[_S], newest: _Kept[_S]) -> bool:
        return entry.time < newest.time - _SPAN and entry.wall < newest.wall - _SPAN

    def _cut(self, length: int) -> None:
        del self._moments[length:]
        self._bytes = sum(entry.size for entry in self._moments)

    def rewind(self, time: float) -> None:
        """Restore the state saved for that time, or the last one before it, and pause."""
        if self._moments:
            self._go(max(bisect.bisect_right(self._moments, time + _ROUNDING, key=_time_of) - 1, 0))

    def step_back(self) -> None:
        """Restore the last state saved before the present time, and pause."""
        i = bisect.bisect_left(self._moments, self._now() - _ROUNDING, key=_time_of) - 1
        if i >= 0:
            self._go(i)

    def _go(self, index: int) -> None:
        self._simulation.pause()
        try:
            self._simulation.restore(self._moments[index].state)
        except MorseError as error:  # e.g. robots were added or removed since
            self._server.send(Refused("rewind", str(error)))
        self._at = self._now()

    def restarted(self) -> None:
        """Delete all states, because the simulation has restarted."""
        self._cut(0)
        self._at = -1.0
        self.tell()

    def tell(self) -> None:
        """Tell the pages the times of the saved states."""
        times = [entry.time for entry in self._moments]
        if times != self._last_times:
            self._last_times = times
            self._server.send(History(times))


def size_of(state: object) -> int:
    """Approximate size of plain data, bytes."""
    state = getattr(state, "parts", state)  # the parts of a `State`
    size = getattr(state, "nbytes", None)
    if isinstance(size, int):
        return size + _OVERHEAD
    if isinstance(state, (str, bytes)):
        return len(state) + _OVERHEAD
    if isinstance(state, dict):
        return _OVERHEAD + sum(size_of(value) + len(str(key)) for key, value in state.items())
    if isinstance(state, (list, tuple)):
        return _OVERHEAD + sum(size_of(value) for value in state)
    return 32
