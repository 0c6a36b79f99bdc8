"""The main loop: ticks synchronized with the wall clock, until the end is requested."""

from __future__ import annotations

import logging
import math
import time
from typing import TYPE_CHECKING

from morse.core import status
from morse.core.observer import SHOWN
from morse.physics import UnstableError
from morse.simulation.ticks.pacing import Pacer
from morse.simulation.ticks.profile import Profile

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.context import Context
    from morse.simulation.ticks.stepping import Stepping
    from morse.simulation.ticks.ticking import Ticker

#: number of ticks that are measured for a diagnosis
TICKS = 60
#: share of one processor; if the simulation gets less, other programs use the machine
_ALONE = 0.75
#: share of their budget; if ticks take less, they are not the cause
_FITS = 0.8
#: share of the tick; a part that takes at least this share is a cause
_CAUSE = 0.3


class Diagnosis:
    """Measures some ticks of a simulation that falls behind.

    Args:
        profile: an existing profile of the simulation, or None.

    Attributes:
        profile: wall-clock time by phase and component.
    """

    def __init__(
        self,
        profile: Profile | None = None,
        wall: Callable[[], float] = time.perf_counter,
        processor: Callable[[], float] = time.process_time,
    ) -> None:
        self.profile = profile or Profile()
        self._clocks = (wall, processor)
        self._began = (wall(), processor())
        self._before = (self.profile.ticks, self.profile.total)

    @property
    def done(self) -> bool:
        """Whether enough ticks were measured."""
        return self.profile.ticks - self._before[0] >= TICKS

    def cause(self, budget: float) -> str:
        """Return the cause as text for the user; empty if there is no single cause.

        Args:
            budget: wall-clock seconds that a tick may take.
        """
        ticks, total = self._before
        tick = (self.profile.total - total) / max(self.profile.ticks - ticks, 1)
        of_budget = f"of the {budget * 1e3:.1f} ms that it may take"
        if tick < _FITS * budget:
            return f"the machine is busy with other work: a tick takes {tick * 1e3:.1f} ms {of_budget}"
        wall, processor = (clock() - began for clock, began in zip(self._clocks, self._began, strict=True))
        if processor < _ALONE * wall:
            return f"the machine is busy with other programs: MORSE gets {100 * processor / wall:.0f} % of a processor"
        name, cost = self.profile.costliest()
        if cost < _CAUSE * tick:
            return ""
        return f"most time goes to {name}: {cost * 1e3:.1f} ms per tick {of_budget}"


logger = logging.getLogger(__name__)


#: Robots that the script placed above the floor fall in the first ticks, half a second, which do not wait for the wall
#: clock: so that robots are at rest when clients get their first message, as in 1.4, which took longer to start.
_SETTLING = 30
#: vertical speed below which a robot is at rest, m/s
_STILL = 0.01


def _unpaced() -> bool:
    return False


class Loop:
    """Runs a simulation.

    Attributes:
        pacer: synchronizes simulated time with the wall clock.
        stopping: whether the simulation was asked to end.
    """

    def __init__(self, context: Context, ticker: Ticker, stepping: Stepping, speed: float) -> None:
        self._context, self._ticker, self._stepping = context, ticker, stepping
        network = context.network
        self.pacer = Pacer(context.clock.period, speed, *([network.give_back] if network is not None else []))
        self.pacer.while_waiting = self._look_around
        self.stopping = False
        self._diagnosis: Diagnosis | None = None
        self._slow = False

    def _is_paced(self) -> bool:
        return not self._stepping.paused and not math.isinf(self.pacer.speed)

    def stop(self) -> None:
        """End the run after this tick; may be called from signal handlers."""
        self.stopping = True
        self.pacer.stop()

    def go_on(self) -> None:
        """Allow another run, after the last one has stopped."""
        self.stopping = False
        self.pacer.start()

    def run(self, last: float = math.inf) -> None:
        """Run until `stop` is called, or until tick ``last``."""
        self.pacer.restart()
        clock, pacer, network, stepping = self._context.clock, self.pacer, self._context.network, self._stepping
        self._context.paced = self._is_paced
        self._context.settling = clock.tick == 0 and not stepping.paused and last > _SETTLING
        try:
            while not self.stopping:
                if stepping.paused and self._context.settling:
                    self._context.settling = False
                if stepping.halted:
                    self._wait_paused()
                    continue
                if not self._ticker.tick():
                    continue
                stepping.count()
                if clock.tick >= last:
                    break
                if network is not None:
                    network.tend()
                if not stepping.paused:
                    if self._context.settling:
                        self._context.settling = clock.tick < _SETTLING and self._falls()
                        pacer.restart()
                    else:
                        pacer.wait()
                    if pacer.lost:
                        self._diagnose()
                    elif self._slow and pacer.keeps_up:
                        self._recovered()
        except UnstableError as error:
            stepping.end(status.FAILED, str(error))
            raise
        finally:
            self._context.paced = _unpaced
            self._context.settling = False
            self.go_on()
            if network is not None:
                network.give_back()

    def _falls(self) -> bool:
        """Whether a robot still moves up or down, at the start of a run."""
        bodies = [robot.bge_object for robot in self._context.robots.values()]
        return any(body.is_dynamic and abs(body.velocity()[0][2]) > _STILL for body in bodies)

    def _wait_paused(self) -> None:
        """While paused, wait for requests of clients and pages, and process them."""
        if self._context.network is not None:
            self._context.services.answer()  # who has requested the last tick
            self._context.wait(self._context.clock.period)
            self.pacer.restart()
        self._ticker.look()
        if self._context.network is None and self._stepping.halted and not self.stopping:
            raise RuntimeError("the simulation is paused and has no clients that could resume it")

    def _look_around(self) -> bool:
        """Process requests between ticks if simulated time runs slowly; return False if a request has paused it."""
        self._ticker.look()
        return not self._stepping.paused

    # -- too slow --------------------------------------------------------------------------

    def restarted(self) -> None:
        """Withdraw a warning about the pace after a restart."""
        self.pacer.restart()
        self._recovered()

    def _diagnose(self) -> None:
        """Find the cause of a slow simulation, and log a warning from time to time."""
        if self._diagnosis is None:
            self._diagnosis = Diagnosis()
            self._ticker.profiles.append(self._diagnosis.profile)
            self._ticker.component_profiles.append(self._diagnosis.profile)
            return
        if not self._diagnosis.done:
            return
        delay = self.pacer.report_due()
        if not delay:
            return
        cause = self._diagnosis.cause(self._context.clock.period / self.pacer.speed)
        self._stop_measuring()
        factor, speed = self.pacer.real_time_factor, self.pacer.speed
        # it catches up after a pause: then its present speed would contradict what is said
        pace = f", running at {factor:.2f} times real time (requested: {speed:.2f})" if factor < speed else ""
        logger.warning(
            "the simulation cannot keep up: %.1f s lost%s%s",
            delay,
            pace,
            f"; {cause}" if cause else "",
            extra={SHOWN: True},
        )
        self._slow = True
        self._context.guard.tell(self._ticker.observers, lambda observer: observer.report_pace(delay, cause))

    def _stop_measuring(self) -> None:
        if self._diagnosis is not None:
            self._ticker.profiles.remove(self._diagnosis.profile)
            self._ticker.component_profiles.remove(self._diagnosis.profile)
            self._diagnosis = None

    def _recovered(self) -> None:
        """Withdraw a warning about the pace, because the simulation keeps up again or was restarted."""
        self._stop_measuring()
        if self._slow:
            self._context.guard.tell(self._ticker.observers, lambda observer: observer.report_pace(0.0))
        self._slow = False
