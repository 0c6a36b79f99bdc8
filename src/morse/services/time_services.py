"""The pseudo component ``time``."""

from __future__ import annotations

import heapq
from typing import TYPE_CHECKING, Annotated

from morse.core import status
from morse.core.abstractobject import AbstractObject
from morse.core.clock import SLOWEST
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.services import concurrent_service, service
from morse.core.validation.arguments import Range
from morse.scene import TimeStrategies

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.clock import Clock

#: maximum number of alarms of all clients; each client is limited to fewer calls at a time
_MAX_ALARMS = 100_000
#: maximum number of cancelled alarms that are kept until their time
_FEW = 64
#: s, 30 years
_LONGEST_SLEEP = 1e9
_FASTEST = 1e9

Duration = Annotated[float, Range(None, _LONGEST_SLEEP, "s")]
TimeScale = Annotated[float, Range(SLOWEST, _FASTEST)]


class TimeServices(AbstractObject):
    """Services to read simulated time, wait for it, and change its speed.

    Args:
        set_speed: function that sets the speed of the simulation.
        begins_late: whether sleeps begin with the next tick, as in MORSE 1.4 (`env.use_physics_of_1_4`).

    Attributes:
        waiting: the alarms, which an action may end; see `AbstractObject.waiting`.
    """

    def __init__(self, clock: Clock, set_speed: Callable[[float], None], *, begins_late: bool = False) -> None:
        super().__init__()
        self._delay = clock.period if begins_late else 0.0
        self._clock = clock
        self._set_speed = set_speed
        #: heap of alarms by time and number; a cancelled alarm stays until its time, or until there are too many
        self._order = self.waiting = list[tuple[float, int]]()
        self._alarms: dict[int, Callable[[tuple[str, object]], object]] = {}
        self._number = 0

    def name(self) -> str:
        """``time``."""
        return "time"

    @service(changes=False)
    def now(self) -> float:
        """Simulated time, s."""
        return self._clock.time

    @service(changes=False)
    def mode(self) -> str:
        """``Best Effort`` or ``Fixed Simulation Step``."""
        return self._clock.strategy.human_repr

    @service(changes=False)
    def statistics(self) -> dict[str, float]:
        """Return mean and variance of the wall-clock time of a tick, and of the tick rate."""
        result = self._clock.statistics()
        if self._clock.strategy is TimeStrategies.FixedSimulationStep:
            result["diff_real_time"] = self._clock.drift()
            del result["mean_frame_by_sec"], result["variance_frame_by_sec"]
        return result

    @service(changes=False)
    def set_time_scale(self, time_scale: TimeScale) -> bool:
        """Run ``time_scale`` times as fast as the wall clock; return True if that is possible."""
        self._set_speed(float(time_scale))
        return True

    @concurrent_service(changes=False)
    def sleep(self, ended: Callable[[tuple[str, object]], object], seconds: Duration) -> object:
        """Sleep for ``seconds`` of simulated time, then end; any number of clients may sleep at the same time."""
        if len(self._alarms) >= _MAX_ALARMS:
            raise MorseRPCInvokationError(f"{_MAX_ALARMS} clients are already sleeping, which is the maximum")
        self._number += 1
        number = self._number
        self._alarms[number] = ended
        heapq.heappush(self._order, (self._clock.time + self._delay + seconds, number))
        return lambda: self._cancel(number)

    def _cancel(self, number: int) -> None:
        callback = self._alarms.pop(number, None)
        if callback is None:
            return
        if len(self._order) > 2 * len(self._alarms) + _FEW:
            self._order[:] = [alarm for alarm in self._order if alarm[1] in self._alarms]
            heapq.heapify(self._order)
        callback((status.PREEMPTED, None))

    def restart(self) -> None:
        """End all alarms at a restart, because their times are no longer valid."""
        alarms, self._alarms = self._alarms, {}
        self._order.clear()
        for callback in alarms.values():
            callback((status.PREEMPTED, None))

    def action(self) -> None:
        """End the alarms that are due, the earliest first."""
        # half a tick of tolerance: sums of periods are not exact
        now = self._clock.time + 0.5 * self._clock.period
        while self._order and self._order[0][0] <= now:
            _, number = heapq.heappop(self._order)
            callback = self._alarms.pop(number, None)
            if callback is not None:
                callback((status.SUCCESS, None))
