"""The two radars for obstacle avoidance."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection

    from morse.core.world import Body, World

#: metres
REACH = 3.0
#: positions of the radars: in front of, to either side of, and above the actuator, m
_AHEAD, _ASIDE, _ABOVE = 0.7, 0.4, 0.8
#: half opening angle of the cones, rad
_HALF_ANGLE = math.radians(5.0)
#: number of rays on the surface of a cone, in addition to the central ray
_ROUND = 8


class ObstacleRadars:
    """Two cones of 5 degrees with a range of 3 m, to the left and to the right of the centre of the robot.

    Rays are cast along the axis and along eight lines on the surface of each cone.

    Args:
        world: the world.
        obj: the object of the actuator.
    """

    def __init__(self, world: World, obj: Body) -> None:
        tangent = math.tan(_HALF_ANGLE)
        turns = [2.0 * math.pi * i / _ROUND for i in range(_ROUND)]
        cone = [(1.0, 0.0, 0.0), *((1.0, tangent * math.cos(a), tangent * math.sin(a)) for a in turns)]
        origins = [(_AHEAD, side * _ASIDE, _ABOVE) for side in (1.0, -1.0) for _ in cone]
        self._rays = world.rays.bundle(obj, cone * 2, REACH, origins)
        self._each = len(cone)

    def look(self, names: Collection[str]) -> tuple[float, float]:
        """Return the distances of the nearest obstacles to the left and to the right, m; infinite for none.

        Args:
            names: objects with one of these properties are ignored.
        """
        rays = self._rays
        rays.refresh()
        distances = rays.distances.tolist()
        if names:
            for i, distance in enumerate(distances):
                if distance < math.inf and self._is_ignored(i, names):
                    distances[i] = math.inf
        return min(distances[: self._each]), min(distances[self._each :])

    def _is_ignored(self, ray: int, names: Collection[str]) -> bool:
        obj = self._rays.object_of(ray)
        while obj is not None:
            if any(name in obj for name in names):
                return True
            obj = obj.parent
        return False
