"""The springs and dampers of constraints: joints that hold, contacts that bounce.

A contact is a spring and a damper that push, but do not pull. For a damping ratio z, the ratio of the speeds after and
before an impact is

    e = exp(-z / w (pi - atan2(2 z w, 1 - 2 z^2))),  w = sqrt(1 - z^2)    for z < 1
    e = exp(-z / w ln((z + w) / (z - w))),           w = sqrt(z^2 - 1)    for z > 1

(T. Schwager and T. Pöschel, "Coefficient of restitution and linear-dashpot model revisited", Granular Matter 9, 2007).
"""

from __future__ import annotations

import math
from functools import cache

#: time constant of the spring, steps of the engine: with fewer, the time of the impact within a step matters, and with
#: more, bodies at rest sink in deeper
_STEPS = 10.0
#: restitution of the largest damping
_LEAST = 0.005
#: what gravity and the steps of the engine take of the ratio of the speeds, of bodies that hardly bounce; measured with
#: steps of 1/1920 s at 3 m/s, after a fall of 0.46 m, for which the mean over all times within a step is then exact
_TAKEN = 0.043
#: constant stiffness of contacts from the first touch on
IMPEDANCE = (0.95, 0.95, 0.001, 0.5, 2.0)


def solver_of(restitution: float, step: float) -> tuple[float, float]:
    """Return ``solref`` of the shapes of a body, for a restitution from 0 to 1 and the time step of the engine, s."""
    rate = 1.0 / (_STEPS * step)
    restitution += _TAKEN * (1.0 - restitution) ** 2
    # more damping would reverse the velocity within a step
    damping = min(2.0 * _damping_ratio(max(restitution, _LEAST)) * rate, 1.0 / step)
    return -rate * rate, -damping


#: share of the acceleration of a constraint that the engine achieves: with the rest, 0.01 %, it remains solvable where
#: several constraints hold the same
_ACHIEVED = 0.9999


def stiff(step: float) -> tuple[tuple[float, float], tuple[float, ...]]:
    """Return ``solref`` and ``solimp`` of a constraint that holds as a joint does.

    Args:
        step: of the engine, s.
    """
    return (2.0 * step, 1.0), (_ACHIEVED, _ACHIEVED, 0.001, 0.5, 2.0)


def restitution_of(ratio: float) -> float:
    """Return the restitution for a damping ratio."""
    if ratio < 1.0:
        w = math.sqrt(1.0 - ratio * ratio)
        # the angle at which the spring has ceased to push
        return math.exp(-ratio / w * (math.pi - math.atan2(2.0 * ratio * w, 1.0 - 2.0 * ratio * ratio)))
    w = math.sqrt(max(ratio * ratio - 1.0, 1e-12))
    return math.exp(-ratio / w * math.log((ratio + w) / (ratio - w)))


@cache
def _damping_ratio(restitution: float) -> float:
    low, high = 0.0, 1e3
    for _ in range(60):
        middle = (low + high) / 2.0
        low, high = (middle, high) if restitution_of(middle) > restitution else (low, middle)
    return (low + high) / 2.0
