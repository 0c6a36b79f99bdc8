"""The rays of a world: of bundles, and single ones for components."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from morse.physics.objects.object_world import ObjectWorld
from morse.physics.rays import Rays
from morse.physics.rays.solids import body_of, owner

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.mathutils import Vector
    from morse.physics.objects.gameobject import GameObject


class RayWorld(ObjectWorld):
    """A world in which rays are cast; see `morse.physics.world.World`."""

    @cached_property
    def rays(self) -> Rays:
        """The ray caster, created on demand."""
        return Rays(self)

    def cast(
        self,
        start: Sequence[float],
        target: Sequence[float],
        distance: float,
        prop: str,
        xray: bool,
        exclude: GameObject,
    ) -> tuple[GameObject | None, Vector | None, Vector | None]:
        """See `ObjectWorld.cast`."""
        reach = math.dist(start, target)
        if not 0.0 < reach < math.inf:
            return None, None, None
        direction = [(b - a) / reach for a, b in zip(start, target, strict=True)]
        ignored = self._without(prop) if prop and xray else None
        ray_hit = self.rays.first(start, direction, distance or reach, ignored, owner(self, exclude.slot))
        if ray_hit is None:
            return None, None, None
        part, point, normal = ray_hit
        body = body_of(self, part)
        if prop and prop not in part and prop not in body:
            return None, None, None
        return body, point, normal

    def _without(self, prop: str) -> NDArray[np.bool_]:
        """Return (S,) booleans: solids that do not have a property, and whose bodies do not have it either."""
        lacking = self.rays.without(prop)
        for solid in np.flatnonzero(lacking):
            lacking[solid] = prop not in body_of(self, self.rays.object_of(int(solid)))
        return lacking
