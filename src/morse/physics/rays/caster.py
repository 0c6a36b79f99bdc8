"""Casts rays at the solids of a world as they are now."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.rays import Fan, Poses, SolidArrays, primitives, ray_caster

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.kernel.rays import Hits
    from morse.physics.object_world import ObjectWorld
    from morse.physics.rays.solids import Solids


class Caster:
    """Keeps the solids where the world has them, when rays are cast.

    Attributes:
        anchor: (3,) metres, in the middle of the world: rays are worked out relative to this place.
    """

    def __init__(self, world: ObjectWorld, solids: Solids) -> None:
        self._world = world
        self._solids = solids
        self._rays = ray_caster(
            SolidArrays(
                solids.kinds,
                solids.sizes,
                solids.slots,
                solids.places,
                solids.turns,
                solids.centres,
                solids.halves,
                solids.meshes,
            )
        )
        self.anchor = np.zeros(3)
        # where the scene has them, not where they are now: rays are the same to the bit whenever the first is cast
        places = np.array([world.slots[slot].pose.position for slot in solids.slots]).reshape(-1, 3)
        if len(places):
            # whole metres: the last bit of a number is not to decide where it is
            self.anchor = np.round((places.min(axis=0) + places.max(axis=0)) / 2.0)
        self._poses = self._poses_now()
        self._loose: set[int] | None = None
        self._stamp = -1
        self._none = np.zeros(0, dtype=np.int64)

    def cast(self, fan: Fan, groups: NDArray[np.int64] | None = None) -> Hits:
        """Find what each ray meets first. Rays whose origin or direction is NaN meet nothing.

        Args:
            groups: (S,) the group of each solid, if it is not that of its owner.
        """
        self._update()
        return self._rays.cast(fan, self._poses, self._solids.owners if groups is None else groups)

    def cast_one(
        self,
        start: NDArray[np.float64],
        direction: NDArray[np.float64],
        limit: float,
        owner: int,
        groups: NDArray[np.int64],
    ) -> Hits:
        """The same for a single ray from a place in the world."""
        self._update()
        fan = Fan([0], np.zeros((1, 3)), np.eye(3)[None], direction[None], None, True, limit, [owner])
        return self._rays.cast(fan, Poses(start[None], np.eye(3)[None], self.anchor), groups)

    # -- what there is now -----------------------------------------------------------------

    def _update(self) -> None:
        world, solids = self._world, self._solids
        if world.rearranged:
            solids.settle([index for index, node in enumerate(solids.nodes) if node in world.rearranged])
            world.rearranged.clear()
        if self._loose != world.loose:
            self._loose = set(world.loose)
            still = solids.fixed & ~np.isin(solids.slots, sorted(world.loose))
            self._rays.gather(np.flatnonzero(still), moving=False)
            self._rays.gather(np.flatnonzero(~still), moving=True)
            self._poses = self._poses_now()
            self._rays.place(self._poses, moving=False)
            self._stamp = -1
        if self._stamp != world.stamp:
            self._stamp = world.stamp
            self._poses = self._poses_now()
            self._rays.place(self._poses, moving=True)

    def _poses_now(self) -> Poses:
        return Poses(*self._world.slot_poses(), self.anchor)

    # -- what was met ----------------------------------------------------------------------

    def normal(self, solid: int, point: NDArray[np.float64], face: int) -> NDArray[np.float64]:
        """Unit normal (3,), world axes, of a solid at a point (3,), relative to the anchor, that a ray met."""
        rotation, mesh = self._rays.rotations[solid], self._solids.meshes[solid]
        if mesh is not None:
            local = mesh.normals[face]
        else:
            here = rotation.T @ (point - self._rays.positions[solid])
            local = primitives.normal(int(self._solids.kinds[solid]), here, self._solids.sizes[solid])
        return np.asarray(rotation @ local, dtype=np.float64)
