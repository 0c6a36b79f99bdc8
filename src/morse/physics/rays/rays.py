"""All rays of a world."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any
from weakref import WeakValueDictionary

import numpy as np

from morse.mathutils import Vector
from morse.physics.rays import embree
from morse.physics.rays.batch import Batch
from morse.physics.rays.bundle import RayBundle, Scan, farther
from morse.physics.rays.caster import Caster
from morse.physics.rays.solids import Solids, owner
from morse.physics.rays.without_embree import MujocoCaster

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from morse.physics.gameobject import GameObject
    from morse.physics.world import World


class Rays:
    """Casts rays at the solids of a world.

    Sensors ask for a `bundle` when they are made. All bundles that are due in a tick are cast in
    one call; that costs little more than one of them alone.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        self._solids = Solids(world)
        self._known: WeakValueDictionary[bytes, NDArray[np.float64]] = WeakValueDictionary()
        self._caster = (Caster if embree.AVAILABLE else MujocoCaster)(world, self._solids)

    @property
    def stamp(self) -> int:
        """Changes whenever anything has moved."""
        return self._world.stamp

    # -- bundles ---------------------------------------------------------------------------

    def bundle(
        self,
        obj: GameObject,
        directions: ArrayLike,
        reach: float,
        origins: ArrayLike | None = None,
        *,
        upright: bool = False,
    ) -> RayBundle:
        """The rays of a sensor.

        Args:
            obj: the object of the sensor.
            directions: (N, 3) vectors in its frame, of any length but zero.
            reach: metres; may be infinite.
            origins: (N, 3) metres in its frame; None if all rays start at its origin.
            upright: directions and origins are along the axes of the world, however the sensor is turned.

        Raises:
            ValueError: arrays of another shape, numbers that are not finite, no reach.
        """
        if not reach > 0.0:
            raise ValueError(f"a ray reaches farther than 0 m; given {reach!r}")
        checked = self.checked_directions(directions)
        starts = None if origins is None else self._kept(_rows_of_three(origins, "origins"))
        if starts is not None and len(starts) != len(checked):
            raise ValueError(f"there are {len(checked)} directions, but {len(starts)} origins")
        return RayBundle(self, obj, checked, float(reach), starts, owner(self._world, obj.slot), upright)

    def checked_directions(self, directions: ArrayLike) -> NDArray[np.float64]:
        """Directions (N, 3) as unit vectors; equal ones are one array, so that they can be turned together."""
        rows = _rows_of_three(directions, "directions")
        lengths = np.linalg.norm(rows, axis=1)
        if not (lengths > 0.0).all():
            raise ValueError(f"direction {int(np.argmin(lengths))} is [0, 0, 0]: a ray needs one to go to")
        return self._kept(rows / lengths[:, None])

    def _kept(self, rows: NDArray[np.float64]) -> NDArray[np.float64]:
        known = self._known.setdefault(rows.tobytes(), rows)
        known.flags.writeable = False
        return known

    # -- casting ---------------------------------------------------------------------------

    def cast(self, bundles: Sequence[RayBundle]) -> None:
        """Cast the rays of some sensors, from where these are now."""
        groups: dict[tuple[int, int, float, bool], list[RayBundle]] = {}
        for bundle in bundles:
            if len(bundle):
                groups.setdefault(bundle.shape, []).append(bundle)
        if not groups:
            return
        for bundle in bundles:
            bundle.mount(self._solids, self._caster.grain)
        parts = [_rays_of(group) for group in groups.values()]
        columns = parts[0] if len(parts) == 1 else [np.concatenate(column) for column in zip(*parts, strict=True)]
        viewpoints, counts, directions, distances, owners, starts, clearances = columns
        batch = Batch(
            viewpoints - self._caster.anchor,
            counts,
            directions,
            distances,
            owners,
            self._solids.owners,
            starts,
            clearances,
        )
        self._caster.cast(batch)
        nothing = batch.solids < 0
        batch.distances[nothing] = np.inf
        first, stamp = 0, self._world.stamp
        for group in groups.values():
            size = (len(group), len(group[0]))
            chosen = slice(first, first + size[0] * size[1])
            scan = Scan(
                group[0],
                batch.distances[chosen].reshape(size),
                batch.solids[chosen].reshape(size),
                batch.faces[chosen].reshape(size),
            )
            for row, bundle in enumerate(group):
                bundle.take(scan, row, stamp)
            first = chosen.stop

    def first(
        self,
        start: Sequence[float],
        direction: Sequence[float],
        reach: float,
        ignored: NDArray[np.bool_] | None = None,
        owned_by: int = -1,
    ) -> tuple[GameObject, Vector, Vector] | None:
        """What a single ray meets: object, point and unit normal that looks against the ray.

        Args:
            start: metres, world frame.
            direction: unit vector, world axes.
            reach: metres.
            ignored: (S,) solids to pass through.
            owned_by: slot whose solids to pass through.
        """
        groups = self._solids.owners
        if ignored is not None:
            groups = np.where(ignored | (groups == owned_by), -1, 0)
            owned_by = -1
        way = np.array([direction], dtype=np.float64)
        viewpoint = np.array([start], dtype=np.float64) - self._caster.anchor
        batch = Batch(
            viewpoint,
            np.ones(1, dtype=np.intp),
            way,
            np.array([farther(reach)]),
            np.array([owned_by], dtype=np.intp),
            groups,
        )
        self._caster.cast(batch)
        solid = int(batch.solids[0])
        if solid < 0:
            return None
        point = viewpoint[0] + way[0] * batch.distances[0]
        normal = self._caster.normal(solid, point, int(batch.faces[0]))
        if normal @ way[0] > 0.0:
            normal = -normal
        place = point + self._caster.anchor
        return self.object_of(solid), Vector(place.tolist()), Vector(normal.tolist())

    # -- what was met ----------------------------------------------------------------------

    def object_of(self, solid: int) -> GameObject:
        """The object that a solid belongs to."""
        return self._world.object_of(self._solids.nodes[solid])

    def without(self, prop: str) -> NDArray[np.bool_]:
        """(S,) the solids whose objects lack a property."""
        return np.array([prop not in self._world.object_of(node) for node in self._solids.nodes], dtype=bool)

    def remissions(self, solids: NDArray[np.intp], faces: NDArray[np.int32]) -> NDArray[np.float64]:
        """(N,) ``specular`` of the material that was met; 0 where nothing was."""
        return self._caster.remissions(solids, faces)


def _rows_of_three(values: ArrayLike, what: str) -> NDArray[np.float64]:
    rows = np.array(values, dtype=np.float64)
    if rows.size == 0:
        return np.empty((0, 3))
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise ValueError(f"{what} of rays have the shape (N, 3), given {rows.shape}")
    if not np.isfinite(rows).all():
        raise ValueError(
            f"{what} of rays are finite numbers; number {int(np.argmin(np.isfinite(rows).all(axis=1)))} is not"
        )
    return rows


def _rays_of(group: list[RayBundle]) -> tuple[Any, ...]:
    """The first columns of a `Batch`, for bundles of one shape; viewpoints in the world frame."""
    first, count = group[0], len(group[0])
    poses = [bundle.obj.world_pose() for bundle in group]
    positions = np.array([pose[0] for pose in poses], dtype=np.float64)
    if first.upright:
        rotations = np.tile(np.eye(3), (len(group), 1, 1))
    else:
        rotations = np.array([pose[1] for pose in poses], dtype=np.float64).reshape(-1, 3, 3)
    owners = np.array([bundle.owner for bundle in group], dtype=np.intp)
    directions = _turned(first.directions, rotations)
    distances = np.full(len(directions), first.limit)
    starts = np.concatenate([bundle.starts for bundle in group]) if len(group) > 1 else first.starts
    if first.origins is not None:
        viewpoints = _turned(first.origins, rotations) + positions.repeat(count, axis=0)
        owners, counts = owners.repeat(count), np.ones(len(viewpoints), dtype=np.intp)
        return viewpoints, counts, directions, distances, owners, starts, starts
    counts = np.full(len(group), count)
    clearances = np.array([bundle.clearance for bundle in group])
    return positions, counts, directions, distances, owners, starts, clearances


def _turned(vectors: NDArray[np.float64], rotations: NDArray[np.float64]) -> NDArray[np.float64]:
    """(B N, 3) vectors (N, 3) turned by each rotation (B, 3, 3)."""
    return (vectors @ rotations.transpose(0, 2, 1)).reshape(-1, 3)
