"""Angles."""

from __future__ import annotations

import math


def normalise_angle(angle: float) -> float:
    """Wrap an angle to the range -pi to pi, rad."""
    return math.remainder(angle, 2.0 * math.pi)
