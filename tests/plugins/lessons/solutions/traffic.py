"""Right before left: whoever has the other one at the right waits before the crossing."""

import math


def step(me, other):
    mine = me[0] * math.cos(me[2]) + me[1] * math.sin(me[2])
    theirs = other[0] * math.cos(other[2]) + other[1] * math.sin(other[2])
    from_right = math.sin(other[2] - me[2]) > 0
    if from_right and theirs < 2.5 and -3.5 < mine < -1.0:
        return 0.0
    return 1.0
