"""Ray casting in a world."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING, cast
from weakref import WeakValueDictionary

import numpy as np

from morse.kernel.rays import BOX, CAPSULE, CYLINDER, ELLIPSOID, MESH, Fan, NativeRays, Poses, SolidArrays, ray_caster
from morse.mathutils import Vector
from morse.mathutils.portable import matmul
from morse.physics.objects.object_world import ObjectWorld
from morse.physics.rays.bundle import RayBundle, Scan, farther
from morse.physics.rays.solids import SoftTriangles, Solids, body_of, owner

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from morse.kernel.batched import Lane
    from morse.kernel.rays import Hits
    from morse.physics.objects.gameobject import GameObject
    from morse.physics.objects.object_world import Posed
    from morse.scene import Node


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
        if self._solids.soft:
            # their triangles are those of one world
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
            for number in solids.soft:
                mesh = solids.bend(number)
                self._rays.reshape(number, mesh, *mesh.box)
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

    def normals(
        self, solids: NDArray[np.int64], points: NDArray[np.float64], faces: NDArray[np.int32]
    ) -> NDArray[np.float64]:
        """Return the unit normals (N, 3), world axes, of solids (N,) at hit points (N, 3) relative to the anchor."""
        rotations = self._rays.rotations[solids]
        away = points - self._rays.positions[solids]
        here = np.stack([_sum_of_three(rotations[:, :, axis], away) for axis in range(3)], axis=1)
        local = np.zeros((len(solids), 3))
        kinds, sizes = self._solids.kinds[solids], self._solids.sizes[solids]
        for kind in np.unique(kinds).tolist():
            if kind != MESH:
                rows = kinds == kind
                local[rows] = _normals(kind, here[rows], sizes[rows])
        for solid in np.unique(solids[kinds == MESH]).tolist():
            mesh, rows = self._solids.meshes[solid], solids == solid
            if mesh is not None:
                local[rows] = mesh.normals[faces[rows]]
        return np.stack([_sum_of_three(rotations[:, axis], local) for axis in range(3)], axis=1)


def _sum_of_three(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the scalar products (N,) of two arrays (N, 3)."""
    return np.asarray(a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2])


def _normals(kind: int, points: NDArray[np.float64], sizes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Outward unit normals (N, 3) of primitives of one kind at points (N, 3) of their surfaces."""
    if kind == BOX:
        rows = np.arange(len(points))
        axes = np.argmax(np.abs(points) / sizes, axis=1)
        result = np.zeros((len(points), 3))
        result[rows, axes] = np.copysign(1.0, points[rows, axes])
        return result
    if kind == ELLIPSOID:
        result = points / sizes**2
    elif kind == CYLINDER:
        on_end = np.abs(points[:, 2]) / sizes[:, 1] > np.hypot(points[:, 0], points[:, 1]) / sizes[:, 0]
        result = np.where(on_end[:, None], points * (0.0, 0.0, 1.0), points * (1.0, 1.0, 0.0))
    else:
        half = sizes[:, 1] if kind == CAPSULE else np.zeros(len(points))
        result = points.copy()
        result[:, 2] -= np.clip(points[:, 2], -half, half)
    return np.asarray(result / np.sqrt(_sum_of_three(result, result))[:, None], dtype=np.float64)


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
        point = place - self._caster.anchor + apart
        normal = self._caster.normals(solids[0], point[None], faces[0])[0]
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

    def normals_of(self, bundle: RayBundle) -> NDArray[np.float64]:
        """Return the normals (N, 3) at the hits of a bundle in its frame, against the rays; zeros for no hit."""
        result = np.zeros((len(bundle), 3))
        seen = np.flatnonzero(bundle.hit >= 0)
        if len(seen) and bundle.sight.scan.known is self._solids:
            position, turn = bundle.frame()
            points = _turned(bundle.points[seen], turn) + (np.array(position) - self._caster.anchor)
            found = self._caster.normals(bundle.hit[seen], points, bundle.sight.faces[seen])
            inside = _turned(found, turn.T)
            ahead = _sum_of_three(inside, bundle.directions[seen]) > 0.0
            result[seen] = np.where(ahead[:, None], -inside, inside) + 0.0
        return result

    def velocities_of(self, bundle: RayBundle) -> NDArray[np.float64]:
        """Return the velocities (N, 3) of the surfaces at the hits of a bundle, over the ground, in its frame, m/s."""
        result = np.zeros((len(bundle), 3))
        hit = bundle.hit
        if bundle.sight.scan.known is not self._solids:
            return result
        position, turn = bundle.frame()
        for solid in np.unique(hit[hit >= 0]).tolist():
            obj = self.object_at(self._solids.nodes[solid])
            if obj is None:
                continue
            mesh = self._solids.meshes[solid]
            if isinstance(mesh, SoftTriangles):
                speeds = {slot: self._world.bodies.velocity(slot)[0] for slot in np.unique(mesh.followed).tolist()}
                for ray in np.flatnonzero(hit == solid).tolist():
                    own = [speeds[slot] for slot in mesh.corners_of(int(bundle.sight.faces[ray]))]
                    result[ray] = _turned(np.mean(own, axis=0), turn.T)
                continue
            linear, angular = obj.velocity()
            if not (any(linear) or any(angular)):
                continue
            rows = hit == solid
            arms = _turned(bundle.points[rows], turn) + (np.array(position) - np.array(obj.world_pose()[0]))
            result[rows] = _turned(np.array(linear) + np.cross(np.array(angular), arms), turn.T)
        return result

    def without(self, prop: str) -> NDArray[np.bool_]:
        """Return (S,) booleans: solids whose objects do not have a property."""
        return np.array([prop not in self._world.object_of(node) for node in self._solids.nodes], dtype=bool)


def _turned(rows: NDArray[np.float64], turn: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return vectors (N, 3) rotated by a matrix (3, 3)."""
    return np.asarray(matmul(rows, turn.T))


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
