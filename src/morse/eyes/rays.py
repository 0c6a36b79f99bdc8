"""Casts rays at any model of MuJoCo, with the kernel of the lidars of scenes."""

from __future__ import annotations

import math
import operator
import sys
import weakref
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import mujoco
import numpy as np

from morse.eyes.renderer import check_model, check_state
from morse.eyes.shapes import height_field
from morse.kernel.loading import library
from morse.kernel.rays import (
    BOX,
    CAPSULE,
    CYLINDER,
    ELLIPSOID,
    MESH,
    PLANE,
    SPHERE,
    GeomPoses,
    ModelTargets,
    TriangleMesh,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_KINDS = {
    int(mujoco.mjtGeom.mjGEOM_SPHERE): SPHERE,
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): CAPSULE,
    int(mujoco.mjtGeom.mjGEOM_ELLIPSOID): ELLIPSOID,
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): CYLINDER,
    int(mujoco.mjtGeom.mjGEOM_BOX): BOX,
    int(mujoco.mjtGeom.mjGEOM_PLANE): PLANE,
}


class RayHits(NamedTuple):
    """The first hits of rays.

    Attributes:
        distances: (N, R) in lengths of the directions, m for unit vectors; -1 without a hit, as `mujoco.mj_multiRay`.
        geoms: (N, R) int32, id of the geom, -1 without a hit.
        normals: (N, R, 3) unit normals of the surfaces, against the ray; 0 without a hit; (N, 0, 3) if not wanted.
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
        flg_static: whether geoms are hit that are fixed in the world.
        whole_trees: whether a body that `cast` leaves out stands for its kinematic tree, of which it is the first one.

    Raises:
        ValueError: not six groups.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        geomgroup: Sequence[bool] | None = None,
        *,
        flg_static: bool = True,
        whole_trees: bool = False,
    ) -> None:
        check_model(model)
        self._model = model
        bodies = (model.body_rootid if whole_trees else np.arange(model.nbody))[model.geom_bodyid]
        use = np.where(model.geom_matid >= 0, _alpha(model)[model.geom_matid], model.geom_rgba[:, 3]) > 0
        use |= (model.geom_matid >= 0) & (model.geom_rgba[:, 3] > 0) & ~_plain(model)
        if geomgroup is not None:
            groups = np.asarray(geomgroup)
            if groups.shape != (mujoco.mjNGROUP,) or groups.dtype.kind not in "biu":
                raise ValueError(f"There are {mujoco.mjNGROUP} groups of geoms, hit or not, got {geomgroup!r}.")
            use &= groups.astype(bool)[np.clip(model.geom_group, 0, mujoco.mjNGROUP - 1)]
        if not flg_static:
            use &= model.body_weldid[model.geom_bodyid] > 0
        solids = [(int(geom), *_solid(model, int(geom))) for geom in np.flatnonzero(use)]
        solids = [row for row in solids if row[1] != MESH or row[3] is not None]
        geoms = np.array([row[0] for row in solids], np.intp)
        meshes = [row[3] for row in solids]
        of_faces = [np.zeros((0, 3)) if mesh is None else _normals_of(mesh) for mesh in meshes]
        boxes = [_box(row[1], row[2], mesh) for row, mesh in zip(solids, meshes, strict=True)]
        #: the states of the last call, and where their poses are
        self._last: tuple[list[weakref.ref[mujoco.MjData]], GeomPoses] = [], GeomPoses([])
        self._targets = ModelTargets(
            library(),
            np.array([row[1] for row in solids], np.int32),
            geoms,
            bodies[geoms],
            np.array([row[2] for row in solids], np.float64).reshape(-1, 3),
            np.array([box[0] for box in boxes]).reshape(-1, 3),
            np.array([box[1] for box in boxes]).reshape(-1, 3),
            meshes,
            np.concatenate([np.zeros((0, 3)), *of_faces]),
            np.cumsum([0, *map(len, of_faces)]),
        )

    def cast(
        self,
        data: mujoco.MjData | Sequence[mujoco.MjData],
        points: ArrayLike,
        directions: ArrayLike,
        limit: float = math.inf,
        *,
        bodyexclude: int = -1,
        normals: bool = True,
    ) -> RayHits:
        """Return the first hits.

        Args:
            data: a state after `mujoco.mj_forward`, or N of them.
            points: (R, 3) or (N, R, 3), or (3,) for all rays, m.
            directions: (R, 3) or (N, R, 3); rays whose direction is 0 or not finite hit nothing.
            limit: largest distance, m.
            bodyexclude: body through whose geoms rays pass, -1 for none.
            normals: whether to compute the normals; without them, `RayHits.normals` has no rows.

        Returns:
            Arrays (N, R, ...); without N for a single state.

        Raises:
            ValueError: the shapes do not fit, the limit is not greater than 0, there is no such body, or a state is one
                of another model.
        """
        several = not isinstance(data, mujoco.MjData) and isinstance(data, Sequence)
        states = list(data) if several else [data]
        poses = self._poses(states)
        if isinstance(limit, bool) or not isinstance(limit, (int, float, np.integer, np.floating)):
            raise TypeError(f"The limit of rays is a number, m, got {limit!r}.")
        if not limit > 0:
            raise ValueError(f"The limit of rays is greater than 0 m, got {limit!r}.")
        if isinstance(bodyexclude, bool) or not isinstance(bodyexclude, (int, np.integer)):
            raise TypeError(f"A body is a number, got {bodyexclude!r}.")
        if not -1 <= bodyexclude < self._model.nbody:
            raise ValueError(f"The body {bodyexclude!r} is out of range [-1, {self._model.nbody}).")
        ways = np.ascontiguousarray(directions, np.float64)
        if ways.ndim not in (2, 3) or ways.shape[-1] != 3 or (ways.ndim == 3 and len(ways) != len(states)):
            raise ValueError(f"Directions have the shape (R, 3) or ({len(states)}, R, 3), got {ways.shape}.")
        shape = (len(states), ways.shape[-2], 3)
        starts = np.ascontiguousarray(points, np.float64)
        if starts.shape not in (shape, shape[1:], (3,)):
            try:
                starts = np.ascontiguousarray(np.broadcast_to(starts, shape))
            except ValueError:
                raise ValueError(
                    f"Points have the shape {shape}, {shape[1:]} or (3,), got {np.shape(points)}."
                ) from None
        # integers may be larger than any double
        most = float(min(limit, sys.float_info.max)) if limit < math.inf else math.inf
        hits = self._targets.cast(poses, starts, ways, most, int(bodyexclude), normals)
        return RayHits(*hits) if several else RayHits(*(part[0] for part in hits))

    def __reduce__(self) -> Any:
        raise TypeError("cannot pickle 'Rays' object: make one of the model in each process")

    def _poses(self, states: list[mujoco.MjData]) -> GeomPoses:
        """The poses of states, which are found once for several calls with the same states."""
        references, poses = self._last
        known = [reference() for reference in references]
        if len(known) == len(states) and None not in known and all(map(operator.is_, known, states)):
            return poses
        for state in states:
            check_state(self._model, state)
        poses = GeomPoses([(state.geom_xpos, state.geom_xmat) for state in states])
        self._last = [weakref.ref(state) for state in states], poses
        return poses


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
