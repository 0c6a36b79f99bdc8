"""Casts rays at the present solids of a world."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.rays import BOX, CAPSULE, CYLINDER, ELLIPSOID, Fan, NativeRays, Poses, SolidArrays, ray_caster
from morse.mathutils.portable import matmul, norm

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.kernel.batched import Lane
    from morse.kernel.rays import Hits
    from morse.physics.objects.object_world import ObjectWorld
    from morse.physics.rays.solids import Solids


class Caster:
    """Updates the poses of the solids from the world, and casts rays.

    Attributes:
        anchor: (3,) m, a point in the middle of the world; rays are computed relative to it.
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
        # computed from the poses in the scene, so that results do not depend on the time of the first cast
        places = np.array([world.slots[slot].pose.position for slot in solids.slots]).reshape(-1, 3)
        if len(places):
            # rounded to whole metres, so that the anchor does not depend on rounding errors
            self.anchor = np.round((places.min(axis=0) + places.max(axis=0)) / 2.0)
        self._poses: Poses | None = None
        self._loose: set[int] | None = None
        self._stamp = -1
        self._none = np.zeros(0, dtype=np.int64)

    def cast(self, fan: Fan, groups: NDArray[np.int64] | None = None) -> Hits:
        """Find the first hit of each ray. Rays whose origin or direction is NaN have no hit.

        Args:
            groups: (S,) the group of each solid; None for the groups of the owners.
        """
        return self._rays.cast(fan, self._update(), self._solids.owners if groups is None else groups)

    def lane(self, fan: Fan, positions: NDArray[np.float64], rotations: NDArray[np.float64], hits: Hits) -> Lane | None:
        """Return what casts a fan in several worlds at once, after a cast in this one; None without the kernel.

        Args:
            positions, rotations: (K, 3) m and (K, 9), the arrays that contain the poses of the groups at that time.
            hits: the arrays for the results.
        """
        if not isinstance(self._rays, NativeRays) or self._loose != self._world.loose or self._world.rearranged:
            return None
        return self._rays.lane(fan, Poses(positions, rotations, self.anchor), self._solids.owners, hits)

    def cast_one(
        self,
        start: NDArray[np.float64],
        direction: NDArray[np.float64],
        limit: float,
        owner: int,
        groups: NDArray[np.int64],
    ) -> Hits:
        """Cast a single ray from a position in the world."""
        self._update()
        fan = Fan([0], np.zeros((1, 3)), np.eye(3)[None], direction[None], None, True, limit, [owner])
        return self._rays.cast(fan, Poses(start[None], np.eye(3)[None], self.anchor), groups)

    # -- present poses ---------------------------------------------------------------------

    def _update(self) -> Poses:
        """Update the poses of solids that have moved since the last cast, and return the present poses."""
        world, solids = self._world, self._solids
        if world.rearranged:
            solids.settle([index for index, node in enumerate(solids.nodes) if node in world.rearranged])
            world.rearranged.clear()
        if self._loose != world.loose:
            self._loose = set(world.loose)
            still = solids.fixed & ~np.isin(solids.slots, sorted(world.loose))
            self._rays.gather(np.flatnonzero(still), moving=False)
            self._rays.gather(np.flatnonzero(~still), moving=True)
            self._rays.place(self._poses_now(), moving=False)
            self._stamp = -1
        if self._stamp != world.stamp:
            self._stamp, poses = world.stamp, self._poses_now()
            self._rays.place(poses, moving=True)
            return poses
        return self._poses_now()

    def _poses_now(self) -> Poses:
        """Return the present poses; the same object as long as the world writes them into the same arrays."""
        positions, rotations = self._world.slot_poses()
        poses = self._poses
        if poses is None or positions is not poses.positions or rotations.base is not poses.rotations.base:
            self._poses = poses = Poses(positions, rotations, self.anchor)
        return poses

    # -- hits ------------------------------------------------------------------------------

    def normal(self, solid: int, point: NDArray[np.float64], face: int) -> NDArray[np.float64]:
        """Return the unit normal (3,), world axes, of a solid at a hit point (3,) relative to the anchor."""
        rotation, mesh = self._rays.rotations[solid], self._solids.meshes[solid]
        if mesh is not None:
            local = mesh.normals[face]
        else:
            here = matmul(rotation.T, point - self._rays.positions[solid])
            local = _normal(int(self._solids.kinds[solid]), here, self._solids.sizes[solid])
        return np.asarray(matmul(rotation, local), dtype=np.float64)


def _normal(kind: int, point: NDArray[np.float64], size: NDArray[np.float64]) -> NDArray[np.float64]:
    """Outward unit normal (3,) of a primitive at a point (3,) of its surface."""
    if kind == BOX:
        axis = int(np.argmax(np.abs(point) / size))
        result = np.zeros(3)
        result[axis] = np.copysign(1.0, point[axis])
        return result
    if kind == ELLIPSOID:
        result = point / size**2
    elif kind == CYLINDER:
        on_end = abs(point[2]) / size[1] > np.hypot(point[0], point[1]) / size[0]
        result = np.array([0.0, 0.0, point[2]]) if on_end else np.array([point[0], point[1], 0.0])
    else:
        half = size[1] if kind == CAPSULE else 0.0
        result = point - np.array([0.0, 0.0, np.clip(point[2], -half, half)])
    return np.asarray(result / norm(result), dtype=np.float64)
