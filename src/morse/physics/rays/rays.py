"""Ray casting in a world."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, cast
from weakref import WeakValueDictionary

import numpy as np

from morse.kernel.rays import Fan
from morse.mathutils import Vector
from morse.mathutils.portable import matmul
from morse.physics.rays.bundle import RayBundle, Scan, farther
from morse.physics.rays.caster import Caster
from morse.physics.rays.solids import Solids

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from morse.kernel.batched import Lane
    from morse.kernel.rays import Hits
    from morse.physics.objects.gameobject import GameObject
    from morse.physics.objects.object_world import ObjectWorld
    from morse.physics.objects.posed import Posed
    from morse.scene import Node


class _Group:
    """Bundles of one shape."""

    def __init__(self, bundles: list[RayBundle], solids: Solids) -> None:
        self._bundles, self._solids = bundles, solids
        self._first = first = bundles[0]
        self._mountings = [bundle.obj.offset for bundle in bundles]
        self._directions = first.directions
        self.fan = Fan(
            [bundle.obj.slot for bundle in bundles],
            np.array([position for position, _ in self._mountings]),
            np.array([rotation for _, rotation in self._mountings]).reshape(-1, 3, 3),
            first.directions,
            first.origins,
            first.upright,
            first.limit,
            [solids.owner_of(bundle.obj.slot) for bundle in bundles],
        )

    def holds(self) -> bool:
        """Whether the bundles are unchanged."""
        directions = self._directions
        for bundle, mounting in zip(self._bundles, self._mountings, strict=True):
            if bundle.directions is not directions or bundle.obj.invalid or bundle.obj.offset != mounting:
                return False
        return True

    def cast(self, caster: Caster, stamp: int) -> None:
        """Cast the rays, and store the results in the bundles."""
        scan = Scan(self._first, caster.cast(self.fan), self._solids)
        for row, bundle in enumerate(self._bundles):
            bundle.take(scan, row, stamp)


class Plan:
    """Some bundles, grouped by shape; each shape needs one call of the kernel."""

    def __init__(self, bundles: Sequence[RayBundle], solids: Solids) -> None:
        groups: dict[tuple[int, int, float, bool], list[RayBundle]] = {}
        for bundle in bundles:
            # a removed sensor has no results
            if len(bundle) and not bundle.obj.invalid:
                groups.setdefault(bundle.shape, []).append(bundle)
        self._groups = [_Group(group, solids) for group in groups.values()]

    def holds(self) -> bool:
        """Whether the plan is still valid: mountings and directions of the sensors are unchanged."""
        for group in self._groups:  # noqa: SIM110 (a loop takes half the time of a generator)
            if not group.holds():
                return False
        return True

    @property
    def fans(self) -> list[Fan]:
        """The rays of each shape."""
        return [group.fan for group in self._groups]

    def cast(self, caster: Caster, stamp: int) -> None:
        """Cast the rays of all bundles."""
        for group in self._groups:
            group.cast(caster, stamp)


#: maximum number of sets of bundles whose arrays are cached
_MOST_PLANS = 64


class Rays:
    """Casts rays at the solids of a world.

    Sensors create a `bundle` when they are created. All bundles of a tick are cast in one call, which costs little more
    than a single bundle.
    """

    def __init__(self, world: ObjectWorld) -> None:
        self._world = world
        self._known: WeakValueDictionary[bytes, NDArray[np.float64]] = WeakValueDictionary()
        self._plans: dict[tuple[RayBundle, ...], Plan] = {}

    def rebuild(self) -> None:
        """Read all solids of the world again, because some were added or removed. Bundles stay valid."""
        self._plans.clear()
        for name in ("_solids", "_caster"):
            self.__dict__.pop(name, None)

    @cached_property
    def _solids(self) -> Solids:
        return Solids(self._world)

    @cached_property
    def _caster(self) -> Caster:
        return Caster(self._world, self._solids)

    @property
    def stamp(self) -> int:
        """A value that changes whenever an object has moved."""
        return self._world.stamp

    # -- bundles ---------------------------------------------------------------------------

    def bundle(
        self,
        obj: Posed,
        directions: ArrayLike,
        reach: float,
        origins: ArrayLike | None = None,
        *,
        upright: bool = False,
    ) -> RayBundle:
        """See `morse.core.world.Rays.bundle`."""
        if not reach > 0.0:
            raise ValueError(f"the reach of a ray has to be greater than 0 m, given {reach!r}")
        unit_rows = self.checked_directions(directions)
        starts = None if origins is None else self._kept(_rows_of_three(origins, "origins"))
        if starts is not None and len(starts) != len(unit_rows):
            raise ValueError(f"there are {len(unit_rows)} directions, but {len(starts)} origins")
        return RayBundle(self, cast("GameObject", obj), unit_rows, float(reach), starts, upright)

    def checked_directions(self, directions: ArrayLike) -> NDArray[np.float64]:
        """Return directions (N, 3) as unit vectors; equal inputs share one array, so that they are rotated together."""
        rows = _rows_of_three(directions, "directions")
        lengths = np.linalg.norm(rows, axis=1)
        if not (lengths > 0.0).all():
            raise ValueError(f"direction {int(np.argmin(lengths))} is [0, 0, 0]: the direction of a ray cannot be 0")
        return self._kept(rows / lengths[:, None])

    def _kept(self, rows: NDArray[np.float64]) -> NDArray[np.float64]:
        shared_rows = self._known.setdefault(rows.tobytes(), rows)
        shared_rows.flags.writeable = False
        return shared_rows

    # -- casting ---------------------------------------------------------------------------

    def serve(self, requests: Sequence[RayBundle]) -> None:
        """Cast the bundles that components have requested for a tick."""
        self.cast(requests)

    def cast(self, bundles: Sequence[RayBundle]) -> None:
        """Cast the rays of some sensors, from their present poses."""
        key = tuple(bundles)
        plan = self._plans.get(key)
        if plan is None or not plan.holds():
            if len(self._plans) >= _MOST_PLANS:
                self._plans.clear()
            plan = self._plans[key] = Plan(key, self._solids)
        plan.cast(self._caster, self._world.stamp)

    def lane(
        self, bundle: RayBundle, positions: NDArray[np.float64], rotations: NDArray[np.float64], hits: Hits
    ) -> Lane | None:
        """Return what casts a bundle in several worlds at once; see `Caster.lane`."""
        fans = Plan([bundle], self._solids).fans
        return self._caster.lane(fans[0], positions, rotations, hits) if fans else None

    def first(
        self,
        start: Sequence[float],
        direction: Sequence[float],
        reach: float,
        ignored: NDArray[np.bool_] | None = None,
        owned_by: int = -1,
    ) -> tuple[GameObject, Vector, Vector] | None:
        """Return the first hit of a single ray: object, point, and unit normal that points against the ray.

        Args:
            start: start point in the world, m.
            direction: unit vector in world axes.
            reach: largest distance, m.
            ignored: (S,) solids that the ray ignores.
            owned_by: slot whose solids the ray ignores.
        """
        groups = self._solids.owners
        if ignored is not None:
            groups = np.where(ignored | (groups == owned_by), np.int64(-1), np.int64(0))
            owned_by = -1
        way, place = np.array(direction, dtype=np.float64), np.array(start, dtype=np.float64)
        distances, solids, faces = self._caster.cast_one(place, way, farther(reach), owned_by, groups)
        solid = int(solids[0, 0])
        if solid < 0:
            return None
        apart = way * distances[0, 0]
        normal = self._caster.normal(solid, place - self._caster.anchor + apart, int(faces[0, 0]))
        if matmul(normal, way) > 0.0:
            normal = -normal
        return self.object_of(solid), Vector((place + apart).tolist()), Vector(normal.tolist())

    # -- hits ------------------------------------------------------------------------------

    def object_of(self, solid: int) -> GameObject:
        """Return the object of a solid."""
        return self._world.object_of(self._solids.nodes[solid])

    def object_at(self, node: Node) -> GameObject | None:
        """The object of a node, if the node is still in the world."""
        return self._world.find_object(node)

    def without(self, prop: str) -> NDArray[np.bool_]:
        """Return (S,) booleans: solids whose objects do not have a property."""
        return np.array([prop not in self._world.object_of(node) for node in self._solids.nodes], dtype=bool)


def _rows_of_three(values: ArrayLike, what: str) -> NDArray[np.float64]:
    rows = np.array(values, dtype=np.float64)
    if rows.size == 0:
        return np.empty((0, 3))
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise ValueError(f"{what} of rays have to be of shape (N, 3), given {rows.shape}")
    if not np.isfinite(rows).all():
        raise ValueError(
            f"{what} of rays have to be finite numbers; number {int(np.argmin(np.isfinite(rows).all(axis=1)))} is not"
        )
    return rows
