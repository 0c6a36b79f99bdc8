"""Casts a batch of rays at the solids of a world with Embree."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.physics.rays.moving import MovingScene
from morse.physics.rays.narrow import Narrow
from morse.physics.rays.static import StaticScene

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.physics.rays.batch import Batch
    from morse.physics.rays.solids import Solids
    from morse.physics.world import World

#: share of the largest coordinate by which single precision may be wrong: four units in the last place
_GRAIN = 2.0**-22
#: bytes: a little less than the largest block whose release makes glibc raise its limits
_BLOCK = (32 << 20) - 8192


class Caster:
    """Keeps the triangles of what stands still, and makes those of what moves when they are needed.

    Attributes:
        anchor: (3,) metres, in the middle of the world: single precision is best around it.
        grain: metres by which single precision may be wrong within the bounds of the world.
    """

    def __init__(self, world: World, solids: Solids) -> None:
        self._world = world
        self._solids = solids
        self._narrow = Narrow(solids)
        self.anchor = np.zeros(3)
        self._place(np.arange(len(solids)))
        places = self._narrow.positions if len(solids) else np.zeros((1, 3))
        self.anchor = (places.min(axis=0) + places.max(axis=0)) / 2
        self.grain = float(np.abs(places - self.anchor).max() + solids.halves.max(initial=0.0)) * _GRAIN
        # glibc hands freed memory back to the system above a limit that it sets to the largest block freed so far
        # (mallopt(3), M_TRIM_THRESHOLD): else it would take it anew, page by page, in every cast. Nothing is touched.
        np.empty(_BLOCK, dtype=np.uint8)
        self._loose: set[int] | None = None
        self._stamp = -1

    def cast(self, batch: Batch) -> None:
        """Find what each ray meets first. Rays from or to places that are no numbers meet nothing."""
        self._update()
        batch.disarm()
        extent = max(self._static.extent, float(np.abs(batch.viewpoints).max()))
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            self._static.cast(batch, extent * _GRAIN)
            moving = self._moving_scene(batch, extent)
            if moving is not None:
                moving.cast(batch)

    # -- what there is now -----------------------------------------------------------------

    def _update(self) -> None:
        world, solids = self._world, self._solids
        if world.rearranged:
            solids.settle([index for index, node in enumerate(solids.nodes) if node in world.rearranged])
            world.rearranged.clear()
        if self._loose != world.loose:
            self._loose = set(world.loose)
            still = solids.fixed & ~np.isin(solids.slots, sorted(world.loose))
            self._movers = np.flatnonzero(~still)
            self._others: dict[int, NDArray[np.intp]] = {}
            self._place(np.flatnonzero(still))
            self._static = StaticScene(self._narrow, np.flatnonzero(still), _GRAIN)
            self._stamp = -1
        if self._stamp != world.stamp:
            self._stamp = world.stamp
            self._are_placed = False
            self._scenes: dict[int, MovingScene] = {}

    def _place(self, members: NDArray[np.intp]) -> None:
        """Take the poses of some solids from the world."""
        world, solids = self._world, self._solids
        positions, rotations = world.slot_poses()
        slots = solids.slots.take(members)
        turns = rotations.take(slots, axis=0)
        places = np.einsum("sij,sj->si", turns, solids.places.take(members, axis=0))
        places += positions.take(slots, axis=0) - self.anchor
        self._narrow.place(members, places, turns @ solids.turns.take(members, axis=0))

    def _moving_scene(self, batch: Batch, extent: float) -> MovingScene | None:
        """The moving solids that the rays can meet, if there are any."""
        owners = batch.owners.tolist()
        owner = owners[0] if owners.count(owners[0]) == len(owners) else -1
        if batch.groups is not self._solids.owners:
            members = self._movers[batch.groups[self._movers] != owner]
            return self._scene_of(members, extent) if len(members) else None
        members = self._others.get(owner)
        if members is None:
            members = self._others[owner] = self._movers[self._solids.owners[self._movers] != owner]
        if not len(members):
            return None
        if owner not in self._scenes:
            self._scenes[owner] = self._scene_of(members, extent)
        return self._scenes[owner]

    def _scene_of(self, members: NDArray[np.intp], extent: float) -> MovingScene:
        if not self._are_placed:
            self._place(self._movers)
            self._are_placed = True
        extent = max(extent, float(np.abs(self._narrow.positions[self._movers]).max()))
        return MovingScene(self._narrow, members, extent * _GRAIN)

    # -- what was met ----------------------------------------------------------------------

    def normal(self, solid: int, point: NDArray[np.float64], face: int) -> NDArray[np.float64]:
        """Unit normal (3,), world axes, of a solid at a point (3,), relative to the anchor, that a ray met."""
        normal = self._static.normal(solid, face)
        return self._narrow.normal(solid, point, face) if normal is None else normal

    def remissions(self, solids: NDArray[np.intp], faces: NDArray[np.int32]) -> NDArray[np.float64]:
        """(N,) ``specular`` of the materials of the solids and triangles that were met."""
        result = np.zeros(len(solids))
        for solid in np.unique(solids[solids >= 0]).tolist():
            met = np.flatnonzero(solids == solid)
            mesh, still = self._solids.meshes[solid], self._static.remissions(solid, faces[met])
            if still is not None:
                result[met] = still
            else:
                result[met] = self._solids.remissions[solid] if mesh is None else mesh.remissions[faces[met]]
        return result
