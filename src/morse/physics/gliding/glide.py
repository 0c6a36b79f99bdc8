"""Records of gliding robots."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.physics.gliding.floors import Floor
    from morse.physics.model.slot import Slot

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
