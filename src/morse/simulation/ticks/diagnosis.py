"""Determines why a simulation cannot keep up with the wall clock."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from morse.simulation.ticks.profile import Profile

if TYPE_CHECKING:
    from collections.abc import Callable

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
