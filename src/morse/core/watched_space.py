"""The space that a sensor without rays observes, for display in the live view."""

from __future__ import annotations

import math
from typing import NamedTuple


class WatchedSpace(NamedTuple):
    """A cone around the X axis of a sensor, or a sphere around the sensor.

    Attributes:
        reach: largest distance, metres.
        angle: full opening angle, radians; 2 pi for a sphere.
        seen: names of the objects that the sensor detects now.
    """

    reach: float
    angle: float = 2.0 * math.pi
    seen: tuple[str, ...] = ()
