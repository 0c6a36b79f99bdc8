"""The share of the wall-clock time that the requests of clients may take."""

from __future__ import annotations

from time import perf_counter

#: share of the wall-clock time for services if clients request more
_SHARE = 1 / 3
#: wall-clock seconds after its last request for which a middleware counts when the share is divided
_ACTIVE = 0.5
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
            self._active = {one: last for one, last in self._active.items() if now - last < _ACTIVE}
        return _SHARE / len(self._active)


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
