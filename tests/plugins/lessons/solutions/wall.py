"""Distance and direction of the wall at the right."""

import math


def step(ranges):
    right, ahead = min(ranges[:40]), min(ranges[60:120])
    slope = ranges[30] * math.cos(math.radians(30)) - ranges[0]
    if ahead < 1.4:
        return 0.15, 0.9
    w = 0.9 * (1.0 - right) - 0.6 * max(-1.0, min(1.0, slope))
    return 0.6, max(-0.8, min(0.8, w))
