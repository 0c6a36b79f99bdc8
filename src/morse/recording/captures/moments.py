"""The times of ticks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.core.clock import Clock


class Moments:
    """Computes the times of past ticks.

    Args:
        clock: the clock of the simulation.
        back: total time by which restarts have set the simulation back, ns.
    """

    def __init__(self, clock: Clock, back: int) -> None:
        self._clock, self._back = clock, back

    def of(self, ticks: Sequence[int]) -> NDArray[np.int64]:
        """Return the number of each tick (32 bits), its log time and its simulated time, ns: (R, 3)."""
        numbers = np.array(ticks, dtype=np.int64)
        stamps = self._clock.stamps_of(numbers)
        return np.stack((numbers & 0xFFFFFFFF, stamps + self._back, stamps), axis=1)
