"""Sine, cosine and arcs by sums and products: the reference for ``c/turns.h``."""

from __future__ import annotations

import math
from functools import lru_cache

#: what has been done with a driven robot in a tick
GLIDES, TURNS, SHIFTS = 1, 2, 4
#: pi/2 in three parts; the product of the first part and a number below 2^20 is exact
_HALF_PI = tuple(map(float.fromhex, ("0x1.921fb544p+0", "0x1.0b4611a6p-34", "0x1.3198a2e037073p-69")))
_TWO_OVER_PI = 0.63661977236758134308


@lru_cache(maxsize=1024)  # commands are often equal for many ticks
def turn_by(angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle by sums and products only, bit-identical on all platforms."""
    if not math.isfinite(angle):
        return math.nan, math.nan
    angle += 0.0  # no negative zero
    quarters = float(round(angle * _TWO_OVER_PI))
    x = ((angle - quarters * _HALF_PI[0]) - quarters * _HALF_PI[1]) - quarters * _HALF_PI[2]
    z = x * x
    # Taylor series; within an eighth of a turn, the next terms are below the last bit
    s = 1.0 - z / 110.0 * (1.0 - z / 156.0 * (1.0 - z / 210.0 * (1.0 - z / 272.0)))
    s = 1.0 - z / 20.0 * (1.0 - z / 42.0 * (1.0 - z / 72.0 * s))
    s = x - x * (z / 6.0 * s)
    c = 1.0 - z / 132.0 * (1.0 - z / 182.0 * (1.0 - z / 240.0 * (1.0 - z / 306.0)))
    c = 1.0 - z / 12.0 * (1.0 - z / 30.0 * (1.0 - z / 56.0 * (1.0 - z / 90.0 * c)))
    c = 1.0 - z / 2.0 * c
    odd = quarters % 4.0
    if odd == 0.0:
        return c, s
    return (-s, c) if odd == 1.0 else (-c, -s) if odd == 2.0 else (s, -c)


def arc(x: float, y: float, half: float) -> tuple[float, float, float, float]:
    """The chord of an arc: the constant velocity that ends at the same position, in the initial axes.

    Args:
        x, y: velocity in the axes of the body.
        half: half the turning angle, rad.

    Returns:
        The velocity; cosine and sine of ``half``.
    """
    if not abs(half) > 1e-9:
        return x, y, 1.0, 0.0
    cosine, sine = turn_by(half)
    chord = sine / half
    return chord * (cosine * x - sine * y), chord * (sine * x + cosine * y), cosine, sine
