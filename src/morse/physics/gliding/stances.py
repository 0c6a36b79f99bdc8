"""Robots that glide, and how robots that may glide stand on their feet, and when they may glide again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.kernel.driving import StanceArrays

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Sequence

    from morse.physics.gliding.floors import Floor
    from morse.physics.model.layout import Slot
    from morse.physics.state.saved import SavedStand

#: number of ticks before a disturbed robot may glide again: initial and maximum
FIRST_WAIT, LONGEST_WAIT = 4, 256
#: number of ticks without contact detection if there is free space around all robots
FORESIGHT = 8


@dataclass(slots=True)
class Glide:
    """A gliding robot.

    Attributes:
        up: vertical direction in the axes of the robot.
        look: first tick in which the robot could be near an edge.
        speed: speed for which ``look`` was computed, m/s.
        since: tick in which gliding began.
        margin: distance, m, at least twice as far as any part of the robot moves in a tick.
    """

    slot: Slot
    floor: Floor
    up: Sequence[float]
    look: int
    speed: float
    since: int
    margin: float = 0.0


#: changes of height (m) and tilt per tick below which a robot has settled
_SETTLED = 1e-9


class Stances:
    """The stances of the robots of a world with K slots in the last tick, and their disturbances.

    Attributes:
        arrays: the stances, which the kernel writes.
    """

    def __init__(self, able: Collection[int], count: int) -> None:
        self.arrays = StanceArrays(
            able=np.zeros(count, dtype=np.uint8),
            ticks=np.zeros(count, dtype=np.int64),
            heights=np.zeros(count),
            ups=np.zeros((count, 3)),
            until=np.zeros(count, dtype=np.int64),
        )
        self.arrays.able[list(able)] = 1
        #: number of ticks to wait after the next disturbance, by slot
        self._waits: dict[int, int] = {}
        self.reset()

    def reset(self) -> None:
        """Reset, because no robot has been on its feet yet."""
        arrays = self.arrays
        arrays.ticks[:] = -1
        arrays.heights[:] = 0.0
        arrays.ups[:] = (0.0, 0.0, 1.0)
        arrays.until[:] = 0
        self._waits.clear()

    def record(self, index: int, tick: int, height: float, up: Sequence[float]) -> bool:
        """Record the stance of a robot; return whether it has settled since the last tick and may glide."""
        return stands_still(self.arrays, index, tick, height, up)

    def unsettle(self, index: int) -> None:
        """Let a robot settle before it glides again."""
        self.arrays.views[0][index] = -1

    def disturb(self, index: int, tick: int, since: int) -> None:
        """A robot that has glided since some tick was disturbed: it waits before it glides again."""
        wait = FIRST_WAIT if tick - since > LONGEST_WAIT else self._waits.get(index, FIRST_WAIT)
        self.arrays.until[index] = tick + wait
        self._waits[index] = min(2 * wait, LONGEST_WAIT)

    def get_state(self, names: Sequence[str]) -> list[dict[str, Any]]:
        """See `morse.physics.state.saved.SavedStand`."""
        arrays = self.arrays
        return [
            {
                "slot": names[index],
                "tick": int(arrays.ticks[index]),
                "height": float(arrays.heights[index]),
                "up": tuple(arrays.ups[index].tolist()),
                "wait": self._waits.get(index, FIRST_WAIT),
                "until": int(arrays.until[index]),
            }
            for index in np.flatnonzero(arrays.able).tolist()
        ]

    def set_state(self, state: Iterable[SavedStand], slots_by_name: dict[str, int]) -> None:
        """Restore a validated state."""
        self.reset()
        arrays = self.arrays
        for stand in state:
            index = slots_by_name[stand.slot]
            arrays.ticks[index], arrays.heights[index] = stand.tick, stand.height
            arrays.ups[index], arrays.until[index] = stand.up, stand.until
            self._waits[index] = stand.wait


def stands_still(stances: StanceArrays, slot: int, tick: int, height: float, up: Sequence[float]) -> bool:
    """Record the stance of a robot; return whether it has settled since the last tick and may glide."""
    ticks, heights, ups, until = stances.views
    first, (x, y, z) = 3 * slot, up
    still = (
        ticks[slot] == tick - 1
        and abs(height - heights[slot]) < _SETTLED
        and abs(x - ups[first]) < _SETTLED
        and abs(y - ups[first + 1]) < _SETTLED
        and abs(z - ups[first + 2]) < _SETTLED
    )
    ticks[slot], heights[slot] = tick, height
    ups[first], ups[first + 1], ups[first + 2] = x, y, z
    return bool(still and tick >= until[slot])
