"""One ray at a time, for components that ask for it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.mathutils import Vector

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.physics.gameobject import GameObject
    from morse.physics.world import World

#: a ray passes at most that many objects that it should see through
_MAX_PASSED = 64


def cast_ray(
    world: World,
    start: Sequence[float],
    target: Sequence[float],
    distance: float,
    prop: str,
    xray: bool,
    exclude: GameObject,
) -> tuple[GameObject | None, Vector | None, Vector | None]:
    """The first object that a ray meets; see `GameObject.rayCast`."""
    delta = np.subtract(target, start)
    reach = float(np.linalg.norm(delta))
    if reach == 0.0:
        return None, None, None
    direction = delta / reach
    limit = distance or reach
    origin = np.array(start, dtype=np.float64)
    own = max(world.slots[exclude.slot].body, 0) or -1
    geom, normal = np.full(1, -1, dtype=np.int32), np.zeros(3)
    travelled = 0.0
    for _ in range(_MAX_PASSED):
        found = mujoco.mj_ray(world.model, world.data, origin, direction, None, 1, own, geom, normal)
        travelled += found
        if found < 0 or travelled > limit + 1e-9 or geom[0] < 0:
            return None, None, None
        obj = world.geom_object(int(geom[0]))
        point = np.asarray(start) + direction * travelled
        if not prop or prop in obj:
            return obj, Vector(point.tolist()), Vector(normal.tolist())
        if not xray:
            return None, None, None
        step = math.nextafter(1e-6, 1.0)
        travelled += step
        origin = np.asarray(start) + direction * travelled
    return None, None, None
