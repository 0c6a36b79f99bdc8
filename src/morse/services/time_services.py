"""The pseudo component ``time``."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from morse.core import status
from morse.core.abstractobject import AbstractObject
from morse.core.exceptions import MorseRPCInvokationError, MorseRPCTypeError
from morse.core.services import concurrent_service, service
from morse.scene import TimeStrategies

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.clock import Clock

_MAX_ALARMS = 10_000


def positive(value: Any, what: str) -> float:
    """A finite number above zero.

    Raises:
        MorseRPCTypeError: naming ``what`` was given.
    """
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value) or value <= 0:
        raise MorseRPCTypeError(f"{what} is a number greater than 0, not {value!r}")
    return float(value)


class TimeServices(AbstractObject):
    """Simulated time: ask it, wait for it, change its speed.

    Args:
        set_speed: tells the pacing of the simulation.
    """

    def __init__(self, clock: Clock, set_speed: Callable[[float], None]) -> None:
        super().__init__()
        self._clock = clock
        self._set_speed = set_speed
        self._alarms: list[tuple[float, Callable[[Any], None]]] = []

    def name(self) -> str:
        """``time``."""
        return "time"

    @service
    def now(self) -> float:
        """Simulated time, s."""
        return self._clock.time

    @service
    def mode(self) -> str:
        """``Best Effort`` or ``Fixed Simulation Step``."""
        return self._clock.strategy.human_repr

    @service
    def statistics(self) -> dict[str, float]:
        """Mean and variance of the wall-clock time of a tick, and of the tick rate."""
        result = self._clock.statistics()
        if self._clock.strategy is TimeStrategies.FixedSimulationStep:
            result["diff_real_time"] = self._clock.drift()
            del result["mean_frame_by_sec"], result["variance_frame_by_sec"]
        return result

    @service
    def set_time_scale(self, time_scale: float) -> bool:
        """Run ``time_scale`` times as fast as the wall clock; True if that is possible."""
        self._set_speed(positive(time_scale, "the time scale"))
        return True

    @concurrent_service
    def sleep(self, ended: Callable[[Any], None], seconds: float) -> None:
        """Answer after ``seconds`` of simulated time; any number of clients may sleep at the same time."""
        if isinstance(seconds, bool) or not isinstance(seconds, (int, float)) or not math.isfinite(seconds):
            raise MorseRPCTypeError(f"sleep takes a number of seconds, not {seconds!r}")
        if len(self._alarms) >= _MAX_ALARMS:
            raise MorseRPCInvokationError(f"{_MAX_ALARMS} clients sleep already: wake-up calls are used up")
        self._alarms.append((self._clock.time + seconds, ended))

    def restart(self) -> None:
        """Time starts anew: nobody would wake the sleepers at the right moment."""
        alarms, self._alarms = self._alarms, []
        for _, callback in alarms:
            callback((status.PREEMPTED, None))

    def action(self) -> None:
        """Ring the alarms that are due, the earliest first."""
        if not self._alarms:
            return
        # half a tick of tolerance: sums of periods are not exact
        now = self._clock.time + 0.5 * self._clock.period
        due = sorted((alarm for alarm in self._alarms if alarm[0] <= now), key=lambda alarm: alarm[0])
        self._alarms = [alarm for alarm in self._alarms if alarm[0] > now]
        for _, callback in due:
            callback((status.SUCCESS, None))
