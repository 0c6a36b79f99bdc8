"""Casts rays at any model of MuJoCo, with the kernel of the lidars of scenes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from threading import Lock
from typing import TYPE_CHECKING, NamedTuple

import mujoco
import numpy as np

from morse.eyes.renderer import check_state
from morse.eyes.shapes import height_field
from morse.kernel.rays import (
    BOX,
    CAPSULE,
    CYLINDER,
    ELLIPSOID,
    MESH,
    SPHERE,
    Fan,
    Poses,
    SolidArrays,
    TriangleMesh,
    ray_caster,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_KINDS = {
    int(mujoco.mjtGeom.mjGEOM_SPHERE): SPHERE,
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): CAPSULE,
    int(mujoco.mjtGeom.mjGEOM_ELLIPSOID): ELLIPSOID,
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): CYLINDER,
    int(mujoco.mjtGeom.mjGEOM_BOX): BOX,
}
#: half the width of an infinite plane, m
_ENDLESS = 1e6
#: what rays pass through: nothing, or planes
_NOTHING, _PLANES = -1, 1


class RayHits(NamedTuple):
    """The first hits of rays.

    Attributes:
        distances: (N, R) in lengths of the directions, m for unit vectors; -1 without a hit, as `mujoco.mj_multiRay`.
        geoms: (N, R) int32, id of the geom, -1 without a hit.
        normals: (N, R, 3) unit normals of the surfaces, against the ray; 0 without a hit.
    """

    distances: NDArray[np.float64]
    geoms: NDArray[np.int32]
    normals: NDArray[np.float64]


class Rays:
    """Casts rays at the geoms of a model of MuJoCo; the model is not changed afterwards.

    Invisible geoms are left out, as in `mujoco.mj_multiRay`. Planes are hit from their front.

    Args:
        model: `mujoco.MjModel`.
        geomgroup: (6,) whether each group is hit; None for all.

    Raises:
        ValueError: not six groups.
    """

    def __init__(self, model: mujoco.MjModel, geomgroup: Sequence[bool] | None = None) -> None:
        self._model = model
        use = np.where(model.geom_matid >= 0, _alpha(model)[model.geom_matid], model.geom_rgba[:, 3]) > 0
        use |= (model.geom_matid >= 0) & (model.geom_rgba[:, 3] > 0) & ~_plain(model)
        if geomgroup is not None:
            if len(geomgroup) != mujoco.mjNGROUP:
                raise ValueError(f"There are {mujoco.mjNGROUP} groups of geoms, got {len(geomgroup)}.")
            use &= np.array(geomgroup, bool)[np.clip(model.geom_group, 0, mujoco.mjNGROUP - 1)]
        solids = [(int(geom), *_solid(model, int(geom))) for geom in np.flatnonzero(use)]
        solids = [row for row in solids if row[1] != MESH or row[3] is not None]
        self._geoms = np.array([row[0] for row in solids], np.intp)
        self._kinds = np.array([row[1] for row in solids], np.int32)
        self._is_plane = model.geom_type[self._geoms] == mujoco.mjtGeom.mjGEOM_PLANE
        meshes = [row[3] for row in solids]
        count = len(solids)
        of_faces = [np.zeros((0, 3)) if mesh is None else _normals_of(mesh) for mesh in meshes]
        self._face_normals = np.concatenate([np.zeros((0, 3)), *of_faces])
        self._first_faces = np.cumsum([0, *map(len, of_faces)])
        boxes = [_box(row[1], row[2], mesh) for row, mesh in zip(solids, meshes, strict=True)]
        self._sizes = np.array([row[2] for row in solids], np.float64).reshape(-1, 3)
        self._caster = ray_caster(
            SolidArrays(
                self._kinds,
                self._sizes,
                np.arange(count),
                np.zeros((count, 3)),
                np.tile(np.eye(3), (count, 1, 1)),
                np.array([box[0] for box in boxes]).reshape(-1, 3),
                np.array([box[1] for box in boxes]).reshape(-1, 3),
                meshes,
            )
        )
        self._caster.gather(np.zeros(0, np.int32), False)
        self._caster.gather(np.arange(count, dtype=np.int32), True)
        self._groups = np.where(self._is_plane, _PLANES, 0).astype(np.int64)
        #: the poses of the geoms are those of one state at a time
        self._lock = Lock()

    def cast(
        self,
        data: mujoco.MjData | Sequence[mujoco.MjData],
        points: ArrayLike,
        directions: ArrayLike,
        limit: float = math.inf,
    ) -> RayHits:
        """Return the first hits.

        Args:
            data: a state after `mujoco.mj_forward`, or N of them.
            points: (R, 3) or (N, R, 3), or (3,) for all rays, m.
            directions: (R, 3) or (N, R, 3); rays whose direction is 0 or not finite hit nothing.
            limit: largest distance, m.

        Returns:
            Arrays (N, R, ...); without N for a single state.

        Raises:
            ValueError: the shapes do not fit, the limit is not greater than 0, or a state is one of another model.
        """
        several = isinstance(data, Sequence)
        states = list(data) if isinstance(data, Sequence) else [data]
        for state in states:
            check_state(self._model, state)
        if not limit > 0:
            raise ValueError(f"The limit of rays is greater than 0 m, got {limit!r}.")
        ways = np.asarray(directions, np.float64)
        if ways.ndim not in (2, 3) or ways.shape[-1] != 3 or (ways.ndim == 3 and len(ways) != len(states)):
            raise ValueError(f"Directions have the shape (R, 3) or ({len(states)}, R, 3), got {ways.shape}.")
        shape = (len(states), ways.shape[-2], 3)
        ways = np.broadcast_to(ways, shape)
        try:
            starts = np.broadcast_to(np.asarray(points, np.float64), shape)
        except ValueError:
            raise ValueError(f"Points have the shape {shape}, {shape[1:]} or (3,), got {np.shape(points)}.") from None
        hits = RayHits(np.empty(shape[:2]), np.empty(shape[:2], np.int32), np.empty(shape))
        for n, state in enumerate(states):
            # rays without a direction have none that is finite
            with self._lock, np.errstate(all="ignore"):
                row = self._of(state, starts[n], ways[n], limit)
            hits.distances[n], hits.geoms[n], hits.normals[n] = row
        return hits if several else RayHits(*(part[0] for part in hits))

    def _of(self, data: mujoco.MjData, starts: NDArray[np.float64], ways: NDArray[np.float64], limit: float) -> RayHits:
        count, rays = len(self._geoms), len(ways)
        # squares of very long and very short directions are not finite, or 0
        longest = np.abs(ways).max(axis=1, initial=0.0)
        units = ways / longest[:, None]
        part = np.sqrt((units**2).sum(axis=1))
        units, lengths = units / part[:, None], longest * part
        if not count or not rays:
            return RayHits(np.full(rays, -1.0), np.full(rays, -1, np.int32), np.zeros((rays, 3)))
        # the last group is the world, in which the rays are
        positions = np.concatenate([data.geom_xpos[self._geoms], np.zeros((1, 3))])
        rotations = np.concatenate([data.geom_xmat[self._geoms].reshape(-1, 3, 3), np.eye(3)[None]])
        poses = Poses(positions, rotations, np.zeros(3))
        self._caster.place(poses, False)
        self._caster.place(poses, True)
        distances, solids, normals = self._cast(poses, starts, units, limit, _NOTHING)
        # the backs of planes are not hit
        behind = np.flatnonzero((solids >= 0) & self._is_plane[solids] & ((normals * units).sum(axis=1) > 0))
        if len(behind):
            distances[behind], solids[behind], normals[behind] = self._cast(
                poses, starts[behind], units[behind], limit, _PLANES
            )
        hit = solids >= 0
        normals[(normals * units).sum(axis=1) > 0] *= -1.0
        return RayHits(
            np.where(hit, distances / np.where(hit, lengths, 1.0), -1.0),
            np.where(hit, self._geoms[solids], -1).astype(np.int32),
            normals,
        )

    def _cast(
        self,
        poses: Poses,
        starts: NDArray[np.float64],
        units: NDArray[np.float64],
        limit: float,
        owner: int,
    ) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
        """Distances (R,), solids (R,) and outward normals (R, 3)."""
        fan = Fan([len(self._geoms)], np.zeros((1, 3)), np.eye(3)[None], units, starts, True, limit, [owner])
        hits = self._caster.cast(fan, poses, self._groups)
        distances, solids, faces = hits.distances[0], hits.solids[0], hits.faces[0]
        normals = np.zeros((len(units), 3))
        rows = np.flatnonzero(solids >= 0)
        hit = solids[rows]
        rotations = poses.rotations[hit]
        places = starts[rows] + units[rows] * distances[rows, None] - poses.positions[hit]
        local = (rotations * places[:, :, None]).sum(axis=1)
        kinds, own = self._kinds[hit], np.empty((len(rows), 3))
        for kind in np.unique(kinds).tolist():
            some = kinds == kind
            if kind == MESH:
                own[some] = self._face_normals[self._first_faces[hit[some]] + faces[rows[some]]]
            else:
                own[some] = _normals_at(kind, self._sizes[hit[some]], local[some])
        normals[rows] = (rotations * own[:, None, :]).sum(axis=2)
        return distances, solids, normals


def _alpha(model: mujoco.MjModel) -> NDArray[np.float64]:
    return np.append(model.mat_rgba[:, 3], 0.0) if model.nmat else np.zeros(1)


def _plain(model: mujoco.MjModel) -> NDArray[np.bool_]:
    """Whether geoms have the colour that geoms have by default: then that of the material counts."""
    return np.asarray((model.geom_rgba == np.array([0.5, 0.5, 0.5, 1.0], np.float32)).all(axis=1))


def _solid(model: mujoco.MjModel, geom: int) -> tuple[int, NDArray[np.float64], TriangleMesh | None]:
    """Kind, sizes (3,) and triangles of a geom."""
    kind, size = int(model.geom_type[geom]), np.array(model.geom_size[geom], np.float64)
    if kind in _KINDS:
        return _KINDS[kind], size, None
    number = int(model.geom_dataid[geom])
    if kind == mujoco.mjtGeom.mjGEOM_PLANE:
        x, y = (half if half > 0 else _ENDLESS for half in size[:2])
        corners = np.array([[-x, -y, 0.0], [x, -y, 0], [x, y, 0], [-x, y, 0]])
        return MESH, size, TriangleMesh(corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32))
    if kind == mujoco.mjtGeom.mjGEOM_HFIELD and number >= 0:
        shape = int(model.hfield_nrow[number]), int(model.hfield_ncol[number])
        first = int(model.hfield_adr[number])
        elevation = model.hfield_data[first : first + shape[0] * shape[1]].reshape(shape)
        mesh = height_field(elevation, model.hfield_size[number])
        return MESH, size, TriangleMesh(mesh.vertices.astype(np.float64), mesh.triangles)
    if number < 0:
        return MESH, size, None
    points = slice(model.mesh_vertadr[number], model.mesh_vertadr[number] + model.mesh_vertnum[number])
    faces = slice(model.mesh_faceadr[number], model.mesh_faceadr[number] + model.mesh_facenum[number])
    return MESH, size, TriangleMesh(model.mesh_vert[points].astype(np.float64), model.mesh_face[faces].copy())


def _normals_of(mesh: TriangleMesh) -> NDArray[np.float64]:
    a, b, c = (mesh.vertices[mesh.faces[:, n]] for n in range(3))
    normals = np.cross(b - a, c - a)
    return np.asarray(normals / np.maximum(np.sqrt((normals**2).sum(axis=1, keepdims=True)), 1e-300))


def _box(
    kind: int, size: NDArray[np.float64], mesh: TriangleMesh | None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Centre and half lengths of the box around a solid."""
    if mesh is not None:
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        return (low + high) / 2, (high - low) / 2
    halves = {
        SPHERE: (size[0],) * 3,
        CYLINDER: (size[0], size[0], size[1]),
        CAPSULE: (size[0], size[0], size[0] + size[1]),
    }
    return np.zeros(3), np.array(halves.get(kind, tuple(size)), np.float64)


def _normals_at(kind: int, size: NDArray[np.float64], places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Outward normals (R, 3) at places (R, 3) on primitives of sizes (R, 3), in their frames."""
    normals = places.copy()
    if kind == BOX:
        axis = (np.abs(places) / size).argmax(axis=1)
        normals[:] = 0.0
        normals[np.arange(len(places)), axis] = np.sign(places[np.arange(len(places)), axis])
    elif kind == ELLIPSOID:
        normals = places / size**2
    elif kind == CYLINDER:
        radius = np.sqrt(places[:, 0] ** 2 + places[:, 1] ** 2)
        cap = np.abs(places[:, 2]) - size[:, 1] > radius - size[:, 0]
        normals[:, 2] = 0.0
        normals[cap] = 0.0
        normals[cap, 2] = np.sign(places[cap, 2])
    elif kind == CAPSULE:
        normals[:, 2] = places[:, 2] - np.clip(places[:, 2], -size[:, 1], size[:, 1])
    return np.asarray(normals / np.maximum(np.sqrt((normals**2).sum(axis=1, keepdims=True)), 1e-300))
