"""Casts rays with MuJoCo, for platforms that Embree has no wheel for.

Slower on meshes, and a mesh that was cut into convex parts is seen as these.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.physics.rays.batch import Batch
    from morse.physics.rays.solids import Solids
    from morse.physics.world import World

#: groups of geoms: only the first one is seen
_SEEN, _OWN, _UNSEEN = 0, 1, 2
#: rays that run exactly within the plane of an edge slip through meshes; no edge lies askew like this
_ASIDE = np.array([0.5477, 0.2831, 0.7874]) * 3e-8


class MujocoCaster:
    """Stands in for `Caster`."""

    grain = 0.0

    def __init__(self, world: World, solids: Solids) -> None:
        self._world = world
        self._solids = solids
        self.anchor = np.zeros(3)
        self._solid_of = np.full(world.model.ngeom, -1, dtype=np.intp)
        members: dict[object, list[int]] = {}
        for solid, node in enumerate(solids.nodes):
            members.setdefault(node, []).append(solid)
        for slot in world.slots:
            for node, geoms in slot.geoms.items():
                own = members.get(node, [])
                for number, geom in enumerate(geoms):
                    if own:
                        self._solid_of[geom] = own[min(number, len(own) - 1)]
        world.model.geom_group[:] = np.where(self._solid_of >= 0, _SEEN, _UNSEEN)
        self._groups = np.array([1, 0, 0, 0, 0, 0], dtype=np.uint8)
        self._normal = np.zeros(3)

    def cast(self, batch: Batch) -> None:
        """Find what each ray meets first. Rays from or to places that are no numbers meet nothing."""
        world = self._world
        if world.is_stale:
            mujoco.mj_kinematics(world.model, world.data)
            world.rearranged.clear()
        batch.disarm()
        first = 0
        for viewpoint, count, owner in zip(batch.viewpoints, batch.counts.tolist(), batch.owners.tolist(), strict=True):
            chosen = slice(first, first + count)
            self._cast_from(viewpoint, owner, batch, chosen)
            first += count

    def _cast_from(self, viewpoint: NDArray[np.float64], owner: int, batch: Batch, chosen: slice) -> None:
        model, data = self._world.model, self._world.data
        seen = np.flatnonzero(self._solid_of >= 0)
        own = seen[batch.groups[self._solid_of[seen]] == owner]
        model.geom_group[own] = _OWN
        directions = np.ascontiguousarray(batch.directions[chosen])
        count = len(directions)
        geoms, distances = np.full(count, -1, dtype=np.int32), np.full(count, -1.0)
        normals = np.zeros((count, 3))
        farthest = float(batch.distances[chosen].max())
        if farthest > 0.0:
            mujoco.mj_multiRay(
                model,
                data,
                viewpoint + _ASIDE,
                directions.ravel(),
                self._groups,
                1,
                -1,
                geoms,
                distances,
                normals.ravel(),
                count,
                farthest,
            )
        model.geom_group[own] = _SEEN
        met = np.flatnonzero((geoms >= 0) & (distances >= 0.0) & (distances <= batch.distances[chosen]))
        rays = met + chosen.start
        batch.distances[rays] = distances[met]
        batch.solids[rays] = self._solid_of[geoms[met]]
        self._normal = normals[0]

    def normal(self, solid: int, point: NDArray[np.float64], face: int) -> NDArray[np.float64]:
        """Unit normal (3,), world axes, where the ray that was cast last met something."""
        return self._normal

    def remissions(self, solids: NDArray[np.intp], faces: NDArray[np.int32]) -> NDArray[np.float64]:
        """(N,) ``specular`` of the first material of what was met."""
        return np.append(self._solids.remissions, 0.0)[solids]
