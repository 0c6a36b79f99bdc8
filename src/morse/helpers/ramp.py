"""A speed that follows a commanded speed within limits of speed, acceleration and jerk."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

Vector = list[float]


class Ramp:
    """The speed of one moving part, along one axis or several axes.

    A limit holds for the length of the vector. The acceleration is increased and decreased at the rate of the jerk, so
    that it is zero when the commanded speed is reached.

    Args:
        axes: number of components of the speed.

    Attributes:
        speed: speed in the last tick, m/s or rad/s.
        acceleration: acceleration in the last tick, m/s² or rad/s².
    """

    def __init__(self, axes: int = 1) -> None:
        self.speed: Vector = [0.0] * axes
        self.acceleration: Vector = [0.0] * axes

    def follow(self, target: Sequence[float], dt: float, limits: Sequence[float]) -> Vector:
        """Return the speed after a tick.

        Args:
            target: the commanded speed.
            dt: length of the tick, s.
            limits: largest speed, acceleration and jerk; 0 for no limit.
        """
        most_speed, most_acceleration, most_jerk = limits
        goal = _shortened(target, most_speed)
        differences = [there - here for there, here in zip(goal, self.speed, strict=True)]
        distance = math.hypot(*differences)
        size = distance / dt
        if most_jerk:
            # the largest acceleration that can still be reduced to 0, by one step of the jerk per tick, before the
            # commanded speed is reached: the speed changes by size * (1 + size / step) / 2 * dt in these ticks
            step = most_jerk * dt
            size = min(size, (math.sqrt(step * step + 8.0 * step * distance / dt) - step) / 2.0)
        if most_acceleration:
            size = min(size, most_acceleration)
        change = [part * size / distance if distance else 0.0 for part in differences]
        if most_jerk:
            turn = _shortened([a - b for a, b in zip(change, self.acceleration, strict=True)], most_jerk * dt)
            change = [a + b for a, b in zip(self.acceleration, turn, strict=True)]
        self.acceleration = change
        self.speed = _shortened([v + a * dt for v, a in zip(self.speed, change, strict=True)], most_speed)
        return self.speed


def _shortened(vector: Sequence[float], most: float) -> Vector:
    """Limit the length of a vector; a limit of 0 means no limit."""
    length = math.hypot(*vector)
    if not most or length <= most:
        return list(vector)
    return [part * (most / length) for part in vector]
