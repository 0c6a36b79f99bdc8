"""Joint values that bring a point of an armature to a pose, or the nearest ones."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from morse.helpers.inverse_kinematics import Target, improve, kicked, placed
from morse.mathutils.rotations import rotation_vector

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.helpers.chain import Chain

#: number of searches from other joint values, and of iterations of each
_ATTEMPTS, _ITERATIONS = 24, 60
#: weight of an error of one radian, m
LEVER = 0.3
#: errors of a solution: m, rad
NEAR, ALIGNED = 1e-5, 1e-4


class Reached(NamedTuple):
    """The nearest joint values.

    Attributes:
        values: of all joints.
        distance: distance from the position of the target, m.
        angle: angle from its orientation, rad; 0 if any orientation will do.
    """

    values: list[float]
    distance: float
    angle: float

    @property
    def is_there(self) -> bool:
        """Whether the target is reached."""
        return self.distance <= NEAR and self.angle <= ALIGNED


def off(chain: Chain, target: Target, values: Sequence[float]) -> tuple[float, float]:
    """The distance (m) and the angle (rad; 0 if any orientation will do) from a target."""
    position, rotation = placed(chain, target, chain.frames(values))
    angle = math.hypot(*rotation_vector(rotation, target.pose[1])) if target.lever else 0.0
    return math.dist(position, target.pose[0]), angle


def reach(chain: Chain, target: Target, values: Sequence[float]) -> Reached:
    """Search the joint values for a target, near the present ones first, then all over the ranges of the joints."""
    best = improve(chain, [target], values, _ITERATIONS)
    for attempt in range(_ATTEMPTS):
        if Reached(best.values, *off(chain, target, best.values)).is_there:
            break
        trial = improve(chain, [target], kicked(chain, best.values, attempt), _ITERATIONS)
        if trial.error < best.error:
            best = trial
    return Reached(best.values, *off(chain, target, best.values))
