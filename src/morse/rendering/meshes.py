"""Meshes for the kernel, divided into clusters of neighbouring triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from morse.kernel.drawing.arrays import CLOSED, CLUSTER, MIXED, VERTEX
from morse.kernel.drawing.meshes import Simplification, closed_labels, simplify
from morse.mathutils.portable import norm

if TYPE_CHECKING:
    from numpy.typing import NDArray


# Finds the closed parts of meshes: from outside, only their front faces are visible.


class ClosedParts(NamedTuple):
    """The closed parts of a mesh.

    Attributes:
        part: (T,) the part of each triangle, -1 for none.
        kind: (T,) uint8, 0 for none, `CLOSED` for parts of one material slot, `MIXED` for parts of several slots.
        spheres: (N, 4) around the parts: centre and radius.
    """

    part: NDArray[np.intp]
    kind: NDArray[np.uint8]
    spheres: NDArray[np.float64]


def closed_parts(points: NDArray[np.float32], index: NDArray[np.integer], slot: NDArray[np.integer]) -> ClosedParts:
    """Find the closed parts of a mesh.

    A part is the triangles that share edges. It is closed if each of its edges belongs to two triangles, which face the
    same side. The triangles face outward: the volume is positive.

    Args:
        points: (V, 3) positions of the vertices.
        index: (T, 3) vertices of the triangles, counterclockwise seen from the front.
        slot: (T,) material slot of the triangles.
    """
    none = ClosedParts(np.full(len(index), -1), np.zeros(len(index), np.uint8), np.zeros((0, 4)))
    if not len(index):
        return none
    # the sum converts -0 to 0
    labels = closed_labels(points + np.float32(0.0), index.astype(np.int32))
    triangles = np.flatnonzero(labels >= 0)
    if not len(triangles):
        return none
    first, part = np.unique(labels[triangles], return_inverse=True)
    mixed = np.bincount(part, slot[triangles] != slot[first[part]], len(first)) > 0
    none.part[triangles], none.kind[triangles] = part, np.where(mixed[part], MIXED, CLOSED)
    return none._replace(spheres=_spheres_of_parts(points[index[triangles]].astype(np.float64), part, len(first)))


def _spheres_of_parts(corners: NDArray[np.float64], part: NDArray[np.intp], count: int) -> NDArray[np.float64]:
    order = np.argsort(part, kind="stable")
    firsts = np.searchsorted(part[order], np.arange(count))
    low = np.minimum.reduceat(corners[order].min(axis=1), firsts)
    high = np.maximum.reduceat(corners[order].max(axis=1), firsts)
    return np.column_stack([(low + high) / 2, np.linalg.norm(high - low, axis=1) / 2])


def different(
    rows: NDArray[np.float32], owner: NDArray[np.integer] | None = None
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """One of each group of equal rows (N, K), in the order of owners, and the index of the group of each row.

    Args:
        rows: finite numbers without -0; K is at most 9.
        owner: (N,) rows of different owners are different.
    """
    flat = np.ascontiguousarray(rows)
    # one number for each row, so that sorting is fast; rows with equal numbers are compared below
    words = flat.view(np.uint32).astype(np.uint64)
    factors = np.random.default_rng(1).integers(1, 2**63, size=9, dtype=np.uint64) | np.uint64(1)
    mixed = words * factors[: flat.shape[1]]
    mixed ^= mixed >> np.uint64(29)
    key = mixed.sum(axis=1, dtype=np.uint64)
    if owner is not None:
        key = (key & np.uint64(0xFFFFFFFF)) | (owner.astype(np.uint64) << np.uint64(32))
    first, inverse = _grouped(key)
    if len(flat) and not np.array_equal(flat[first][inverse], flat):
        first = inverse = np.arange(len(flat))  # hash collision of two rows, not expected
    return first, inverse


def _grouped(key: NDArray[np.uint64]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """One member of each group of equal keys, and the index of the group of each member.

    ``np.unique`` does the same with stable sorts, which take three times as long.
    """
    order = np.argsort(key)
    ordered = key[order]
    begins = np.ones(len(key), bool)
    np.not_equal(ordered[1:], ordered[:-1], out=begins[1:])
    group = np.empty(len(key), np.intp)
    group[order] = np.cumsum(begins) - 1
    return order[begins], group


#: smallest number of triangles of a mesh that is simplified
_FEWEST = 64
#: the errors of the levels are the size of the mesh divided by these numbers
_SHARES = (256, 128, 64, 32, 16, 8)
#: a level has at most this share of the triangles of the level before
_LESS = 0.7


class Level(NamedTuple):
    """A simplified copy of a mesh.

    Attributes:
        error: bound of the distance between the copy and the mesh, m.
        rows: (T, 3, 8) float32, position, normal and texture coordinates of the corners.
        origin: (T,) the triangle of the mesh that each triangle replaces.
    """

    error: float
    rows: NDArray[np.float32]
    origin: NDArray[np.intp]


def levels_of(rows: NDArray[np.float32], slot: NDArray[np.integer], *, textured: bool) -> list[Level]:
    """Simplify a mesh, the finest level first; empty if the mesh has too few triangles.

    Each point of a copy is at most its error away from the mesh, and the other way round. Edges, closed parts and
    borders between materials remain closed.

    Args:
        rows: (T, 3, 8) float32, position, normal and texture coordinates of the corners.
        slot: (T,) material slot.
        textured: whether the texture coordinates are used.
    """
    levels: list[Level] = []
    if len(rows) < _FEWEST:
        return levels
    corners = rows.reshape(-1, 8)
    size = float(norm(np.ptp(corners[:, :3], axis=0).astype(np.float64)))
    if not size > 0.0:
        return levels
    mesh, places, looks = _mesh(corners, slot, textured=textured)
    count = len(rows)
    for share in _SHARES:
        limit = size / share
        remaining = simplify(mesh, limit)
        if remaining > _LESS * count or not remaining:
            continue
        count = remaining
        triangles = np.flatnonzero(mesh.alive)
        picked = np.concatenate([places[mesh.vertices[triangles]], looks[mesh.look[triangles]]], axis=2)
        levels.append(Level(float(mesh.errors[triangles].max()), picked, triangles))
        if count < _FEWEST:
            break
    return levels


def _mesh(
    corners: NDArray[np.float32], slot: NDArray[np.integer], *, textured: bool
) -> tuple[Simplification, NDArray[np.float32], NDArray[np.float32]]:
    """The mesh, and its different positions and attributes."""
    slots = np.repeat(slot, 3).astype(np.float32)
    # equal rows first, because positions and attributes repeat among the different ones only
    first, row = different(np.column_stack([corners, slots]))
    rows, slots = corners[first], slots[first]
    first, vertices = different(rows[:, :3])
    places = rows[first, :3]
    vertices = vertices[row]
    first, look = different(np.column_stack([rows[:, 3:], slots]))
    look, looks, slots = look[row], rows[first, 3:], slots[first]
    units = looks.astype(np.float64)
    square = units[:, 0] * units[:, 0] + units[:, 1] * units[:, 1] + units[:, 2] * units[:, 2]
    units[:, :3] /= np.sqrt(np.maximum(square, 1e-30))[:, None]
    index = vertices.reshape(-1, 3).astype(np.int32)
    a, b, c = index.T
    mesh = Simplification(
        points=places.astype(np.float64),
        looks=units,
        slots=slots.astype(np.int32),
        vertices=index,
        look=look.reshape(-1, 3).astype(np.int32),
        errors=np.zeros(len(index)),
        alive=((a != b) & (b != c) & (c != a)).astype(np.uint8),
        textured=textured,
    )
    return mesh, places, looks


#: largest valid coordinate of a mesh, m
_FARTHEST = 1e7
#: largest texture coordinate, beyond which the fraction loses its precision
_FARTHEST_UV = 1e4
#: triangles that are processed at once; each takes 700 bytes while it is
_AT_ONCE = 1 << 17


class Clusters(NamedTuple):
    """A mesh divided into clusters; indices are relative to the mesh.

    Attributes:
        vertices: (V,) `VERTEX`.
        triangles: (T, 4) int32, three vertices, relative to the first of the cluster, and the material slot.
        clusters: (C, 4) int32, first vertex, number of vertices, first triangle, number of triangles.
        spheres: (C, 4) float32, centre and radius.
        closed: (T,) uint8, 0, `CLOSED` or `MIXED`; see `morse.kernel.drawing.arrays.Drawing`.
        guards: (C,) float32, radius of the sphere around the same centre that contains these parts.
        levels: (C, 6) float32, see `morse.kernel.drawing.arrays.Drawing`.
    """

    vertices: NDArray[np.void]
    triangles: NDArray[np.int32]
    clusters: NDArray[np.int32]
    spheres: NDArray[np.float32]
    closed: NDArray[np.uint8]
    guards: NDArray[np.float32]
    levels: NDArray[np.float32]


class Triangulated(Protocol):
    """What is read of a mesh; see `morse.scene.Mesh`."""

    @property
    def vertices(self) -> NDArray[np.float32]:
        """(V, 3) positions."""

    @property
    def triangles(self) -> NDArray[np.int32]:
        """(T, 3) vertices."""

    @property
    def material_index(self) -> NDArray[np.int32]:
        """(T,) material slots."""

    @property
    def uvs(self) -> NDArray[np.float32] | None:
        """(T, 3, 2) texture coordinates."""

    @property
    def normals(self) -> NDArray[np.float32] | None:
        """(T, 3, 3) unit normals."""


def clusters_of(
    mesh: Triangulated, slots: int, at_once: int = _AT_ONCE, *, textured: bool = True, simplified: bool = False
) -> Clusters:
    """Divide a mesh and its levels of detail into clusters, and merge equal corners.

    Triangles with corners that are not finite or do not exist are left out.

    Args:
        slots: number of material slots; triangles of other slots get the last one.
        at_once: number of triangles that are processed at once, a multiple of `CLUSTER`, which bounds the temporary
            memory. Larger meshes are not searched for closed parts, and have no other levels of detail; nothing else
            depends on it.
        textured: whether texture coordinates are used; otherwise they are 0.
        simplified: make levels of detail.
    """
    index = np.asarray(mesh.triangles).reshape(-1, 3)
    points = np.asarray(mesh.vertices, dtype=np.float32).reshape(-1, 3)
    usable = np.asarray((np.abs(points) <= _FARTHEST).all(axis=1))
    parts = _parts(len(index), at_once)
    triangles = np.concatenate([np.zeros(0, np.intp), *(part.start + _usable(index[part], usable) for part in parts)])
    centres = np.empty((len(triangles), 3))
    for part in _parts(len(triangles), at_once):
        centres[part] = points[index[triangles[part]]].mean(axis=1, dtype=np.float64)
    order = triangles[_along_curve(centres)] if len(triangles) else triangles
    del centres, triangles
    slot = np.clip(_column(mesh.material_index, len(index)), 0, slots - 1)
    ordered = [order[part] for part in _parts(len(order), at_once)] or [order]
    if len(order) > at_once:
        return _stacked([_joined(_rows(mesh, points, index, part, textured), slot[part]) for part in ordered])
    rows, slot = _rows(mesh, points, index, order, textured), slot[order]
    levels = levels_of(rows, slot, textured=textured) if simplified else []
    copies = [_joined(rows, slot), *(_joined(level.rows, slot[level.origin]) for level in levels)]
    errors = [0.0, *(level.error for level in levels), np.inf]
    if levels:
        # all clusters of a mesh show the same level
        whole = spheres_around(rows.reshape(-1, 8)[:, :3], np.zeros(1, np.intp))
        for number, copy in enumerate(copies):
            copy.levels[:, :4], copy.levels[:, 4:] = whole, errors[number : number + 2]
    origins = np.concatenate([np.arange(len(order)), *(level.origin for level in levels)])
    return _guarded(_stacked(copies), closed_parts(points, index[order], slot), origins)


def _parts(count: int, at_once: int) -> list[slice]:
    return [slice(first, min(first + at_once, count)) for first in range(0, count, at_once)]


def _usable(index: NDArray[np.integer], usable: NDArray[np.bool_]) -> NDArray[np.intp]:
    """The triangles (N, 3) whose corners exist and are usable."""
    fine = np.asarray(((index >= 0) & (index < len(usable))).all(axis=1))
    fine[fine] = usable[index[fine]].all(axis=1)
    return np.flatnonzero(fine)


def _rows(
    mesh: Triangulated,
    points: NDArray[np.float32],
    index: NDArray[np.integer],
    triangles: NDArray[np.intp],
    textured: bool,
) -> NDArray[np.float32]:
    """(N, 3, 8) position, normal and texture coordinates of the corners of some triangles."""
    corners = points[index[triangles]]
    rows = np.zeros((len(triangles), 3, 8), np.float32)
    rows[..., :3] = corners
    rows[..., 3:6] = _normals(mesh, triangles, len(index), corners)
    if textured and mesh.uvs is not None and len(mesh.uvs) == len(index):
        uvs = np.asarray(np.asarray(mesh.uvs)[triangles], dtype=np.float32).reshape(-1, 3, 2)
        rows[..., 6:] = np.clip(np.nan_to_num(uvs), -_FARTHEST_UV, _FARTHEST_UV)
    rows += np.float32(0.0)  # the sum converts -0 to 0
    return rows


def _stacked(parts: list[Clusters]) -> Clusters:
    """Return the clusters of all parts, with the numbers of their vertices and triangles counted through."""
    vertices = triangles = 0
    numbers = []
    for part in parts:
        numbers.append(part.clusters + np.array([vertices, 0, triangles, 0], np.int32))
        vertices, triangles = vertices + len(part.vertices), triangles + len(part.triangles)
    return Clusters(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.triangles for part in parts]),
        np.concatenate(numbers),
        np.concatenate([part.spheres for part in parts]),
        np.concatenate([part.closed for part in parts]),
        np.concatenate([part.guards for part in parts]),
        np.concatenate([part.levels for part in parts]),
    )


def _guarded(clusters: Clusters, solids: ClosedParts, origins: NDArray[np.intp]) -> Clusters:
    """Return the clusters of a mesh with its closed parts; `origins` (T,) are the triangles of the mesh."""
    part, kind, spheres = solids.part[origins], solids.kind[origins], solids.spheres
    guards = clusters.spheres[:, 3].copy()
    owner = np.repeat(np.arange(len(clusters.clusters)), clusters.clusters[:, 3])
    inside = part >= 0
    if inside.any():
        owner, own = owner[inside], spheres[part[inside]]
        apart = np.linalg.norm(own[:, :3] - clusters.spheres[owner, :3], axis=1) + own[:, 3]
        # slightly enlarged, because the kernel uses single precision
        np.maximum.at(guards, owner, (apart * 1.0001 + 1e-6).astype(np.float32))
    return clusters._replace(closed=kind, guards=guards)


def _column(values: NDArray[np.int32] | None, count: int) -> NDArray[np.int64]:
    column = np.zeros(count, np.int64)
    if values is not None and len(values) == count:
        column[:] = values
    return column


def _normals(
    mesh: Triangulated, triangles: NDArray[np.intp], count: int, corners: NDArray[np.float32]
) -> NDArray[np.float32]:
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).astype(np.float64)
    face /= np.maximum(np.linalg.norm(face, axis=1, keepdims=True), 1e-30)
    flat = np.repeat(face[:, None], 3, axis=1).astype(np.float32)
    if mesh.normals is None or len(mesh.normals) != count:
        return flat
    vectors = np.asarray(np.asarray(mesh.normals)[triangles], dtype=np.float32).reshape(-1, 3, 3)
    usable = (np.isfinite(vectors) & (np.abs(vectors) < 1e3)).all(axis=2, keepdims=True)
    return np.where(usable, vectors, flat)


def _joined(rows: NDArray[np.float32], slot: NDArray[np.int64]) -> Clusters:
    """Divide rows (T, 3, 8) into clusters of neighbours; equal corners in a cluster become one vertex."""
    count = len(rows)
    cluster = np.arange(count) // CLUSTER
    owner = np.repeat(cluster, 3)
    flat = np.ascontiguousarray(rows.reshape(-1, 8))
    first, inverse = different(flat, owner)
    firsts = np.searchsorted(owner[first], np.arange(cluster[-1] + 1 if count else 0))
    sizes = np.diff(np.append(firsts, len(first)))
    starts = np.arange(0, count, CLUSTER)
    triangles = np.empty((count, 4), np.int32)
    triangles[:, :3] = inverse.reshape(-1, 3) - firsts[cluster][:, None] if count else 0
    triangles[:, 3] = slot
    vertices = flat[first].view(VERTEX).reshape(-1)
    numbers = np.column_stack([firsts, sizes, starts, np.diff(np.append(starts, count))]).astype(np.int32)
    spheres = spheres_around(vertices["p"], firsts)
    levels = np.column_stack([spheres, np.zeros(len(spheres)), np.full(len(spheres), np.inf)]).astype(np.float32)
    return Clusters(
        vertices, triangles, numbers.reshape(-1, 4), spheres, np.zeros(count, np.uint8), spheres[:, 3].copy(), levels
    )


#: vertices are numbered by two texture coordinates
_NUMBERS = 4096


def numbers_as_uvs(triangles: NDArray[np.integer]) -> NDArray[np.float32]:
    """Return texture coordinates (T, 3, 2) of triangles (T, 3) whose vertices move: the numbers of the vertices.

    They survive `clusters_of`, which sorts and merges vertices; `numbers_in` reads them again.
    """
    return np.stack([triangles % _NUMBERS, triangles // _NUMBERS], axis=-1).astype(np.float32)


def numbers_in(uv: NDArray[np.float32]) -> NDArray[np.intp]:
    """Return the numbers (N,) of vertices with the texture coordinates (N, 2) of `numbers_as_uvs`."""
    return (uv[:, 0] + _NUMBERS * uv[:, 1]).astype(np.intp)


def spheres_around(points: NDArray[np.float32], firsts: NDArray[np.integer]) -> NDArray[np.float32]:
    """(C, 4) centres and radii of spheres around points (N, 3) that are grouped; `firsts` (C,) begin the groups."""
    if not len(firsts):
        return np.zeros((0, 4), np.float32)
    low, high = np.minimum.reduceat(points, firsts), np.maximum.reduceat(points, firsts)
    middle = (low + high) / 2
    apart = points - np.repeat(middle, np.diff(np.append(firsts, len(points))), axis=0)
    reach = np.maximum.reduceat(np.linalg.norm(apart, axis=1), firsts)
    # slightly enlarged, because the kernel uses single precision
    return np.column_stack([middle, reach * 1.0001 + 1e-6]).astype(np.float32)


def _along_curve(points: NDArray[np.float64]) -> NDArray[np.intp]:
    """The order of points along a Z-order curve (G. M. Morton, 1966)."""
    low, size = points.min(axis=0), max(float(np.ptp(points, axis=0).max()), 1e-9)
    cell = ((points - low) / size * 1023).astype(np.int64)
    key = np.zeros(len(points), np.int64)
    for bit in range(10):
        for axis in range(3):
            key |= ((cell[:, axis] >> bit) & 1) << (3 * bit + axis)
    return np.argsort(key, kind="stable")
