"""Simulated time."""

from __future__ import annotations

import math
import time
from fractions import Fraction
from typing import TYPE_CHECKING

from morse.core.classes.fixed import ReadOnly

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from morse.scene import TimeStrategies


#: tolerance as a share of a tick; times since the epoch are doubles with a resolution of 2e-7 s
_SAME_TICK = 1e-2
#: largest numbers of ticks and nanoseconds, in 64 bits
_LARGEST_PRODUCT = 2**62

SLOWEST = 1e-3
"""The lowest speed of a simulation, simulated seconds per wall-clock second."""


class Clock:
    """Counts ticks of fixed length, independently of the wall clock.

    Attributes:
        tick: number of completed ticks; 0 before the first.
        time: simulated seconds; plus the time at the start, which is since the epoch if the scene asks for dates.
        frequency: ticks per simulated second.
        period: simulated seconds per tick.
    """

    tick: int
    time: float
    frequency: float
    period: float

    def __init__(self, frequency: float, strategy: TimeStrategies, *, start: float = 0.0) -> None:
        own = self._own = self.__dict__
        own["frequency"], own["period"] = frequency, 1.0 / frequency
        self._rate = Fraction(frequency).limit_denominator(10**6)
        self.strategy = strategy
        self._origin = start
        own["tick"], own["time"] = 0, self._origin
        self._last_stamp = (-1, 0)
        self._wall: float | None = None
        self._start: float | None = None
        self._samples = 0
        self._mean = 0.0
        self._square = 0.0

    def __repr__(self) -> str:
        return f"<Clock at tick {self.tick}, {self.time:.6g} s; {self.frequency:.6g} Hz>"

    def advance(self, ticks: int = 1) -> None:
        """Complete a tick, or several."""
        own = self._own
        own["tick"] = tick = self.tick + ticks
        own["time"] = self._origin + tick / self.frequency

    def stamp(self, seconds: float | None = None) -> int:
        """Return simulated time in whole nanoseconds, computed from the tick: the same value throughout a tick.

        Args:
            seconds: an earlier value of `time`; None for the present time.
        """
        tick = self.tick
        if seconds is None or seconds == self.time:
            # called by every component in every tick
            if self._last_stamp[0] != tick:
                self._last_stamp = (tick, self.stamp_of(tick))
            return self._last_stamp[1]
        return self.stamp_at(seconds, tick)

    def stamp_at(self, seconds: object, tick: int) -> int:
        """Return a value of `time` in whole nanoseconds.

        Args:
            seconds: the value; of anything but a number, the result is the time of the tick.
            tick: number of the tick.
        """
        if isinstance(seconds, (int, float)) and math.isfinite(seconds):
            ticks = (seconds - self._origin) * self.frequency
            tick = round(ticks)
            if abs(ticks - tick) > _SAME_TICK:  # the time is not a time of this clock
                return round(seconds * 1e9)
        return self.stamp_of(tick)

    def stamp_of(self, tick: int) -> int:
        """Return the simulated time of a tick in whole nanoseconds."""
        nanoseconds = tick * 10**9 * self._rate.denominator
        return round(self._origin * 1e9) + (nanoseconds + self._rate.numerator // 2) // self._rate.numerator

    def stamps_of(self, ticks: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the simulated times of ticks (N,) in whole nanoseconds."""
        import numpy as np

        factor = 10**9 * self._rate.denominator
        if len(ticks) and int(ticks.max()) * factor > _LARGEST_PRODUCT:
            return np.array([self.stamp_of(tick) for tick in ticks.tolist()], dtype=np.int64)
        nanoseconds = ticks * factor + self._rate.numerator // 2
        return nanoseconds // self._rate.numerator + round(self._origin * 1e9)

    @property
    def origin(self) -> float:
        """The time of tick 0: 0, or the start time since the epoch, s."""
        return self._origin

    def go_to(self, tick: int, origin: float | None = None) -> None:
        """Set the tick, and the time of tick 0 unless it is None, after another state was restored."""
        if origin is not None:
            self._origin, self._last_stamp = origin, (-1, 0)
        self._own.update(tick=tick, time=self._origin + tick / self.frequency)
        self._wall = self._start = None

    def restart(self) -> None:
        """Return to tick 0."""
        self.go_to(0)
        self._samples = 0
        self._mean = self._square = 0.0

    def observe(self) -> None:
        """Take a sample of the wall-clock time between two ticks, for `statistics`."""
        now = time.perf_counter()
        if self._start is None:
            self._start = now - self.tick / self.frequency
        if self._wall is not None:
            self._samples += 1
            delta = now - self._wall
            step = delta - self._mean
            self._mean += step / self._samples
            self._square += step * (delta - self._mean)
        self._wall = now

    def drift(self) -> float:
        """Wall-clock time since the start minus simulated time, s."""
        return time.perf_counter() - self._start - self.tick / self.frequency if self._start is not None else 0.0

    def statistics(self) -> dict[str, float]:
        """Mean and variance of the wall-clock time of a tick (s, s^2), and of the tick rate (Hz)."""
        variance = self._square / self._samples if self._samples else 0.0
        rate = 1.0 / self._mean if self._mean else 0.0
        # to first order, the variance of 1/x is variance(x) / mean(x)^4
        rate_variance = variance * rate**4
        return {
            "mean_time": self._mean,
            "variance_time": variance,
            "mean_frame_by_sec": rate,
            "variance_frame_by_sec": rate_variance if math.isfinite(rate_variance) else 0.0,
        }


for _name in ("tick", "time", "frequency", "period"):
    setattr(Clock, _name, ReadOnly(_name, "the clock belongs to the simulation"))
