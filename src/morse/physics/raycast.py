"""One ray at a time, for components that ask for it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.physics.rays.solids import owner

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.mathutils import Vector
    from morse.physics.gameobject import GameObject
    from morse.physics.world import World


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
    reach = math.dist(start, target)
    if not 0.0 < reach < math.inf:
        return None, None, None
    direction = [(b - a) / reach for a, b in zip(start, target, strict=True)]
    ignored = world.rays.without(prop) if prop and xray else None
    found = world.rays.first(start, direction, distance or reach, ignored, owner(world, exclude.slot))
    if found is None or (prop and prop not in found[0]):
        return None, None, None
    return found
