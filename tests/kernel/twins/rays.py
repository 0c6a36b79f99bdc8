"""Rays cast by numpy: the reference for the C functions, which are bit-identical.

A ray hits the nearest surface; of several at the same distance, that of the first solid, and of that solid the first
triangle. Results therefore do not depend on trees, threads or processors.
"""

from __future__ import annotations

from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from morse.kernel.rays import MESH, Hits
from tests.kernel.twins import primitives
from tests.kernel.twins.triangles import ReferenceMesh

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.kernel.rays import Fan, Poses, SolidArrays, TriangleMesh

    Floats = NDArray[np.float64]
    Numbers = NDArray[np.intp]

#: number of pairs of rays and solids that are processed together, to limit the memory
_MOST_PAIRS = 2_000_000


class ReferenceRays:
    """Casts rays at solids.

    Attributes:
        positions: (S, 3) metres, relative to the anchor.
        rotations: (S, 3, 3) from each solid to the world.
    """

    def __init__(self, solids: SolidArrays) -> None:
        self._solids = solids
        self.positions, self.rotations = np.zeros((len(solids), 3)), np.zeros((len(solids), 3, 3))
        self._members: dict[bool, Numbers] = {}
        self._radii = np.linalg.norm(solids.halves, axis=1)

    def gather(self, members: NDArray[np.integer], moving: bool) -> None:
        """Set the fixed or the moving solids; call `place` before rays are cast."""
        self._members[moving] = np.asarray(members, dtype=np.intp)

    def place(self, poses: Poses, moving: bool) -> None:
        """Place the fixed or the moving solids at the poses of their groups."""
        members, solids = self._members[moving], self._solids
        positions, rotations = poses.positions[solids.slots[members]], poses.rotations[solids.slots[members]]
        self.positions[members] = turned(rotations, solids.places[members]) + (positions - poses.anchor)
        self.rotations[members] = product(rotations, solids.turns[members])

    def cast(self, fan: Fan, poses: Poses, groups: NDArray[np.int64]) -> Hits:
        """The first hits of the rays; solids of the group (S,) of a sensor's owner are passed through."""
        with np.errstate(all="ignore"):
            origins, directions = _aimed(fan, poses)
            owners = fan.owners.repeat(fan.shape[1])
            hits = Hits.nothing(fan.shape)
            rays = np.flatnonzero(np.isfinite(origins).all(axis=1) & np.isfinite(directions).all(axis=1))
            for some in np.array_split(rays, len(rays) * len(self._solids) // _MOST_PAIRS + 1):
                self._cast(some, origins[some], directions[some], fan.limit, owners[some], groups, hits)
        return hits

    def _cast(
        self,
        rays: Numbers,
        origins: Floats,
        directions: Floats,
        limit: float,
        owners: NDArray[np.int64],
        groups: NDArray[np.int64],
        hits: Hits,
    ) -> None:
        ray_numbers, solids = self._pairs(origins, directions, limit)
        foreign = groups[solids] != owners[ray_numbers]
        ray_numbers, solids = ray_numbers[foreign], solids[foreign]
        distances, faces = self._surfaces(origins[ray_numbers], directions[ray_numbers], solids, limit)
        met = np.flatnonzero(distances < limit)
        ray_numbers, solids, distances, faces = ray_numbers[met], solids[met], distances[met], faces[met]
        order = np.lexsort((solids, distances, ray_numbers))
        hit_rays, first = np.unique(ray_numbers[order], return_index=True)
        nearest, where = order[first], rays[hit_rays]
        hits.distances.reshape(-1)[where] = distances[nearest]
        hits.solids.reshape(-1)[where] = solids[nearest]
        hits.faces.reshape(-1)[where] = faces[nearest]

    def _pairs(self, origins: Floats, directions: Floats, limit: float) -> tuple[Numbers, Numbers]:
        """The pairs of rays and solids whose slightly enlarged bounding spheres the rays hit."""
        members = np.concatenate([self._members[False], self._members[True]])
        members = members[np.isfinite(self.positions[members]).all(axis=1)]
        middles = self.positions[members] + turned(self.rotations[members], self._solids.centres[members])
        radii = self._radii[members] * 1.001 + 1e-6 * np.abs(middles).max(axis=1, initial=0.0) + 1e-6
        squares, along = np.zeros((len(origins), len(members))), np.zeros((len(origins), len(members)))
        for axis in range(3):
            apart = middles[:, axis] - origins[:, axis, None]
            squares += apart**2
            along += apart * directions[:, axis, None]
        beside = squares * (1.0 - 1e-12) - along**2 * (1.0 + 1e-12)
        near = (beside <= radii**2) & (along >= -radii) & (along <= limit + radii)
        rays, solids = near.nonzero()
        return rays, members[solids]

    def _surfaces(
        self, origins: Floats, directions: Floats, solids: Numbers, limit: float
    ) -> tuple[Floats, NDArray[np.int32]]:
        """Distance (K,), infinite for a miss, and triangle (K,) or -1, of each ray and its solid."""
        turns = self.rotations[solids].transpose(0, 2, 1)
        local = turned(turns, origins - self.positions[solids])
        ways = turned(turns, directions)
        distances, faces = np.full(len(solids), np.inf), np.full(len(solids), -1, dtype=np.int32)
        kinds = self._solids.kinds[solids]
        for kind in np.unique(kinds).tolist():
            some = np.flatnonzero(kinds == kind)
            if kind != MESH:
                sizes = self._solids.sizes[solids[some]]
                distances[some] = primitives.first_surface(kind, local[some].T, ways[some].T, sizes.T)
                continue
            meshes = [self._solids.meshes[solid] for solid in solids[some].tolist()]
            numbers = np.array([id(mesh) for mesh in meshes])
            for mesh in dict.fromkeys(meshes):
                assert mesh is not None
                own = some[numbers == id(mesh)]
                limits = np.full(len(own), limit)
                distances[own], faces[own] = _mesh_of(mesh).first(local[own], ways[own], limits)
        return distances, faces


_meshes: WeakKeyDictionary[TriangleMesh, ReferenceMesh] = WeakKeyDictionary()


def _mesh_of(mesh: TriangleMesh) -> ReferenceMesh:
    if mesh not in _meshes:
        _meshes[mesh] = ReferenceMesh(mesh)
    return _meshes[mesh]


def _aimed(fan: Fan, poses: Poses) -> tuple[Floats, Floats]:
    """Origins, relative to the anchor, and directions, world axes, of all rays (B N, 3)."""
    rotations = poses.rotations[fan.slots]
    positions = turned(rotations, fan.offsets) + (poses.positions[fan.slots] - poses.anchor)
    turns = np.tile(np.eye(3), (len(rotations), 1, 1)) if fan.upright else product(rotations, fan.turns)
    directions = turned(turns[:, None], fan.directions)
    if fan.origins is None:
        origins = np.broadcast_to(positions[:, None], directions.shape)
    else:
        origins = turned(turns[:, None], fan.origins) + positions[:, None]
    return origins.reshape(-1, 3), directions.reshape(-1, 3)


def turned(rotations: Floats, vectors: Floats) -> Floats:
    """``R v`` (..., 3), term by term: matrix products add in an undefined order."""
    x, y, z = vectors[..., 0, None], vectors[..., 1, None], vectors[..., 2, None]
    result: Floats = rotations[..., 0] * x + rotations[..., 1] * y + rotations[..., 2] * z
    return result


def product(one: Floats, other: Floats) -> Floats:
    """``A B`` (..., 3, 3), term by term."""
    a, b = one[..., :, :, None], other[..., None, :, :]
    result: Floats = a[..., 0, :] * b[..., 0, :] + a[..., 1, :] * b[..., 1, :] + a[..., 2, :] * b[..., 2, :]
    return result
