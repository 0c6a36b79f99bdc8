"""Robots whose wheels are turned together, with one call per tick."""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.physics.state.engine_state import EngineState


class WheelFleet:
    """Robots on driven wheels; the speeds of the wheels of each robot last until `adopt` replaces them."""

    def __init__(self, state: EngineState, slots: Sequence[int]) -> None:
        motors = [[state.slots[wheel].actuator for wheel in state.wheels.get(slot, ())] for slot in slots]
        self._motors = np.array([motor for one in motors for motor in one], dtype=np.int64)
        self._ends = list(accumulate(map(len, motors), initial=0))
        self._controls = state.data.ctrl
        self._speeds = np.zeros(len(self._motors))

    def adopt(self, row: int) -> bool:
        """Make the present speeds of the wheels of a robot last; return False if it has no driven wheels."""
        part = slice(self._ends[row], self._ends[row + 1])
        self._speeds[part] = self._controls[self._motors[part]]
        return part.start < part.stop

    def drive(self) -> None:
        """Turn all wheels at their speeds in the next tick, also those that were set to other speeds since."""
        self._controls[self._motors] = self._speeds
