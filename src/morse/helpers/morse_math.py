"""Angles."""

from __future__ import annotations

import math


def normalise_angle(angle: float) -> float:
    """The same direction between -pi and pi, radians."""
    return math.remainder(angle, 2.0 * math.pi)
