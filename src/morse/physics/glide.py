"""A robot that glides, and how one stood before."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.physics.compile import Slot
    from morse.physics.floors import Floor

#: ticks that a robot which was disturbed waits before it glides again: at first, and at most
FIRST_WAIT, LONGEST_WAIT = 4, 256
#: ticks that robots which have room around them drift after one look for contacts
FORESIGHT = 8


@dataclass(slots=True)
class Stand:
    """How a robot stood a tick ago, and what it has met.

    Attributes:
        tick: when.
        height: of its origin, m.
        up: the vertical in its own axes.
        wait: ticks until it may glide, if it is disturbed again.
        until: it may not glide before that tick.
    """

    tick: int = -1
    height: float = 0.0
    up: Sequence[float] = (0.0, 0.0, 1.0)
    wait: int = FIRST_WAIT
    until: int = 0


@dataclass(slots=True)
class Glide:
    """A robot that glides.

    Attributes:
        up: the vertical in its own axes.
        look: tick at which it could be near an edge.
        speed: m/s at which that was worked out.
        since: tick at which it began.
        margin: metres, at least twice as far as any part of it moves in a tick.
    """

    slot: Slot
    floor: Floor
    up: Sequence[float]
    look: int
    speed: float
    since: int
    margin: float = 0.0
