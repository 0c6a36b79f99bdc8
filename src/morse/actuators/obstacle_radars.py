"""The two radars by which a robot sees what stands in its way."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Collection

#: metres
REACH = 3.0
#: where they sit: ahead, to either side, and above the actuator, m
_AHEAD, _ASIDE, _ABOVE = 0.7, 0.4, 0.8
#: half the angle of their cones, rad
_HALF_ANGLE = math.radians(5.0)
#: rays in the surface of a cone, beside the one in its middle
_ROUND = 8


class ObstacleRadars:
    """Two cones of 5 degrees that look 3 m ahead, to the left and to the right of the middle of the robot.

    A cone is looked through along its axis and along eight lines of its surface.

    Args:
        world: what they look into.
        obj: the actuator that carries them.
    """

    def __init__(self, world: Any, obj: Any) -> None:
        tangent = math.tan(_HALF_ANGLE)
        turns = [2.0 * math.pi * i / _ROUND for i in range(_ROUND)]
        cone = [(1.0, 0.0, 0.0), *((1.0, tangent * math.cos(a), tangent * math.sin(a)) for a in turns)]
        origins = [(_AHEAD, side * _ASIDE, _ABOVE) for side in (1.0, -1.0) for _ in cone]
        self._rays = world.rays.bundle(obj, cone * 2, REACH, origins)
        self._each = len(cone)

    def look(self, ignored: Collection[str]) -> tuple[float, float]:
        """Distance of the nearest thing to the left and to the right, m; infinite for none.

        Args:
            ignored: things that have one of these properties are not seen.
        """
        rays = self._rays
        rays.refresh()
        distances = rays.distances.tolist()
        if ignored:
            for i, distance in enumerate(distances):
                if distance < math.inf and self._is_ignored(i, ignored):
                    distances[i] = math.inf
        return min(distances[: self._each]), min(distances[self._each :])

    def _is_ignored(self, ray: int, ignored: Collection[str]) -> bool:
        obj = self._rays.object_of(ray)
        while obj is not None:
            if any(name in obj for name in ignored):
                return True
            obj = obj.parent
        return False
