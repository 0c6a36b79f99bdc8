"""Cleaned triangle surfaces: finite, welded, with normals and neighbours, and their flat patches."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils.portable import matmul, norm

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]
    Ints = NDArray[np.int64]


_FARTHEST = 1e9  # metres; larger coordinates are treated as invalid
_WELD = 1e-6  # share of the diagonal: corners closer than this are merged
_SINGLE_PRECISION = 2.5e-7  # share of the coordinates: a few roundings of 32-bit floats
_NO_AREA = 1e-14  # share of the squared diagonal


@dataclass(eq=False, slots=True)
class Surface:
    """Triangles with shared vertices.

    Attributes:
        vertices: (V, 3) metres; each belongs to a triangle.
        triangles: (T, 3) indices, counter-clockwise seen from outside.
        normals: (T, 3) unit normals, zero for triangles without area.
        areas: (T,) m².
    """

    vertices: Floats
    triangles: Ints
    normals: Floats
    areas: Floats

    @property
    def diagonal(self) -> float:
        """Length of the diagonal of the bounding box."""
        return float(norm(np.ptp(self.vertices, axis=0))) if len(self.vertices) else 0.0

    @property
    def corners(self) -> Floats:
        """(T, 3, 3) corners of the triangles."""
        return self.vertices[self.triangles]

    @property
    def signed_volume(self) -> float:
        """Volume by the divergence theorem about the centre of the bounding box; negative if seen from inside."""
        centre = (self.vertices.max(axis=0) + self.vertices.min(axis=0)) / 2.0
        heights = np.einsum("ij,ij->i", self.normals, self.vertices[self.triangles[:, 0]] - centre)
        return float((heights * self.areas).sum() / 3.0)

    @property
    def is_closed(self) -> bool:
        """Whether every edge is traversed equally often in both directions."""
        starts, ends = half_edges(self.triangles)
        count = len(self.vertices)
        forward = np.sort(starts * count + ends)
        backward = np.sort(ends * count + starts)
        return bool(np.array_equal(forward, backward))

    def part(self, selection: Ints) -> Surface:
        """The surface of some of the triangles."""
        used_vertices, triangles = np.unique(self.triangles[selection], return_inverse=True)
        return Surface(
            self.vertices[used_vertices],
            triangles.reshape(-1, 3),
            self.normals[selection],
            self.areas[selection],
        )


def half_edges(triangles: Ints) -> tuple[Ints, Ints]:
    """First and last vertex of the (3 T,) directed edges: those of the first triangle, then of the second, …"""
    return triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()


def open_edges(triangles: Ints, count: int) -> tuple[Ints, Ints]:
    """Return the first and last vertices of the directed edges that no triangle traverses in the other direction.

    Args:
        triangles: (T, 3) indices.
        count: more than the largest index.
    """
    starts, ends = half_edges(triangles)
    edges, opposite = starts * count + ends, np.sort(ends * count + starts)
    if not len(edges):
        return starts, ends
    place = np.minimum(np.searchsorted(opposite, edges), len(edges) - 1)
    alone = opposite[place] != edges
    return starts[alone], ends[alone]


def clean_surface(vertices: ArrayLike, triangles: ArrayLike) -> Surface:
    """Create a surface from the valid triangles of a mesh.

    Triangles with missing, infinite or equal corners are left out, and all but one of equal triangles. Coincident
    corners are welded only at open edges, so that two closed solids that touch stay separate.

    Args:
        vertices: (V, 3) metres.
        triangles: (T, 3) indices.

    Raises:
        ValueError: an array has the wrong shape, or the indices are not integers.
    """
    points: Floats = rows_of_three(vertices, "vertices").astype(np.float64)
    indices = rows_of_three(triangles, "triangles")
    if indices.dtype.kind not in "iu":
        raise ValueError(f"the indices of triangles are integers, given {indices.dtype}")
    faces: Ints = indices.astype(np.int64)
    faces = faces[((faces >= 0) & (faces < len(points))).all(axis=1)]
    usable: NDArray[np.bool_] = np.all(np.abs(points) < _FARTHEST, axis=1)
    faces = with_three_corners(faces[usable[faces].all(axis=1)])
    used_vertices, faces = np.unique(faces, return_inverse=True)
    points, faces = points[used_vertices], faces.reshape(-1, 3)
    if len(faces):
        faces = with_three_corners(_weld_borders(points, faces)[faces])
        faces = without_equal_triangles(faces)
        used_vertices, faces = np.unique(faces, return_inverse=True)
        points, faces = points[used_vertices], faces.reshape(-1, 3)
    return measured(points, faces)


def without_equal_triangles(faces: NDArray[np.generic]) -> np.ndarray:
    """Triangles (T, 3), without those with the corners and the orientation of an earlier one."""
    first = faces.argmin(axis=1)[:, None]
    rows = np.take_along_axis(faces, (first + np.arange(3)) % 3, axis=1)
    order = np.lexsort(rows.T[::-1])
    sorted_rows = rows[order]
    again = (sorted_rows[1:] == sorted_rows[:-1]).all(axis=1)
    if not again.any():
        return faces
    # the sort is stable: the first of equal triangles stays
    return np.delete(faces, order[1:][again], axis=0)


def rows_of_three(values: ArrayLike, what: str) -> NDArray[np.generic]:
    """An array of shape (N, 3); empty arrays may have any shape.

    Raises:
        ValueError: the array has another shape.
    """
    array = np.asarray(values)
    if array.size == 0:
        return np.empty((0, 3), dtype=np.int64)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "iuf":
        raise ValueError(f"{what} are an array of numbers of shape (N, 3), given {array.dtype} of shape {array.shape}")
    return array


def with_three_corners(faces: Ints) -> Ints:
    """The triangles whose corners are three different vertices."""
    a, b, c = faces.T
    proper_faces: Ints = faces[(a != b) & (b != c) & (c != a)]
    return proper_faces


def measured(points: Floats, faces: Ints) -> Surface:
    """The surface of triangles (T, 3) between points (V, 3)."""
    corners = points[faces]
    crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(crosses, axis=1)
    surface = Surface(points, faces, crosses, lengths / 2.0)
    flat = surface.areas <= _NO_AREA * surface.diagonal**2
    surface.areas[flat] = 0.0
    lengths[flat] = 1.0
    surface.normals[flat] = 0.0
    surface.normals /= lengths[:, None]
    return surface


def _weld_borders(points: Floats, faces: Ints) -> Ints:
    """(V,) new index of each vertex: the same index for vertices of open edges at the same position."""
    is_open = np.zeros(len(points), dtype=bool)
    for ends in open_edges(faces, len(points)):
        is_open[ends] = True
    border = np.flatnonzero(is_open)
    numbers = np.arange(len(points))
    if len(border) == 0:
        return numbers
    low = points[border].min(axis=0)
    size = float(norm(np.ptp(points, axis=0)))
    cell = max(size * _WELD, float(np.abs(points).max()) * _SINGLE_PRECISION, 1e-12)
    # Coincident points can be in neighbouring cells; a second grid with an offset of half a cell merges most of them.
    for shift in (0.0, 0.5):
        x, y, z = np.floor((points[border] - low) / cell + shift).astype(np.int64).T
        _, first, group = np.unique((x << 42) + (y << 21) + z, return_index=True, return_inverse=True)
        numbers[border] = numbers[border[first]][group.ravel()]
        points = points[numbers]
    return numbers


def edge_neighbours(surface: Surface) -> Ints:
    """(T, 3) triangle across each edge, -1 at open edges; if more than two share an edge, the next one around it."""
    if len(surface.triangles) == 0:
        return np.empty((0, 3), dtype=np.int64)
    starts, ends = half_edges(surface.triangles)
    key = np.minimum(starts, ends) * len(surface.vertices) + np.maximum(starts, ends)
    order = np.argsort(key, kind="stable")
    sorted_key = key[order]
    size = len(key)
    is_first = np.ones(size, dtype=bool)
    is_first[1:] = sorted_key[1:] != sorted_key[:-1]
    group_start = np.flatnonzero(is_first)
    group_of = np.cumsum(is_first) - 1
    following = np.arange(1, size + 1)
    is_last = np.append(is_first[1:], True)
    following[is_last] = group_start[group_of[is_last]]
    across = np.empty(size, dtype=np.int64)
    across[order] = order[following] // 3
    across[order[is_first & is_last]] = -1
    return across.reshape(-1, 3)


def components(surface: Surface) -> list[Ints]:
    """Return the indices of the triangles of each connected piece, the largest bounding box first."""
    across = edge_neighbours(surface)
    count = len(across)
    label = np.arange(count)
    one, other = np.repeat(np.arange(count), 3), across.ravel()
    one, other = one[other >= 0], other[other >= 0]
    while True:
        low = np.minimum(label[one], label[other])
        high = np.maximum(label[one], label[other])
        if np.array_equal(low, high):
            break
        np.minimum.at(label, high, low)
        while not np.array_equal(label[label], label):
            label = label[label]
    order = np.argsort(label, kind="stable")
    cuts = np.flatnonzero(np.diff(label[order])) + 1
    pieces = np.split(order, cuts) if count else []
    if len(pieces) < 2:
        return list(pieces)
    starts = np.concatenate([[0], cuts])
    corners = surface.corners[order]
    low_corner = np.minimum.reduceat(corners.min(axis=1), starts, axis=0)
    high_corner = np.maximum.reduceat(corners.max(axis=1), starts, axis=0)
    extents = np.linalg.norm(high_corner - low_corner, axis=1)
    return [pieces[i] for i in np.argsort(-extents, kind="stable")]


#: number of triangles whose neighbours are examined together
_AHEAD = 1024


@dataclass(frozen=True, slots=True)
class Flatness:
    """The tolerances for triangles of a flat patch.

    Attributes:
        angle: largest angle between a triangle and the plane, rad.
        distance: largest distance of a corner from the plane, m.
    """

    angle: float
    distance: float


@dataclass(eq=False, slots=True)
class Patch:
    """Neighbouring triangles in one plane.

    Attributes:
        triangles: (N,) indices of the triangles.
        normal: (3,) normal of the plane.
        offset: metres from the origin to the plane along the normal.
        acute: (K, 4) planes (normal, offset) of patches that meet this one at an acute interior angle.
    """

    triangles: Ints
    normal: Floats
    offset: float
    acute: Floats


def flat_patches(surface: Surface, flatness: Flatness, limit: int) -> list[Patch] | None:
    """Divide a surface into flat patches, grown from its largest triangles; None if there are more than `limit`.

    Triangles are compared with the first triangle of a patch, so that a curved surface does not become one patch.
    """
    across = edge_neighbours(surface)
    label = np.where(surface.areas > 0.0, -1, -2)
    slope = math.cos(flatness.angle)
    seeds = np.argsort(-surface.areas, kind="stable")
    offsets = np.einsum("ij,ij->i", surface.normals, surface.vertices[surface.triangles[:, 0]])
    patch_numbers: list[int] = []
    grows = _Growing(surface, across, flatness, offsets)
    for place, seed in enumerate(seeds.tolist()):
        if place % _AHEAD == 0:
            grows.look(seeds[place : place + _AHEAD])
        if label[seed] != -1:
            continue
        if len(patch_numbers) == limit:
            return None
        normal, offset = surface.normals[seed], offsets[seed]
        number = len(patch_numbers)
        label[seed] = number
        patch_numbers.append(seed)
        # most patches of a surface that is nowhere flat have one triangle
        front = np.array([seed] if grows.seeds[place % _AHEAD] else [], dtype=np.int64)
        while front.size:
            near = across[front].ravel()
            near = np.unique(near[near >= 0])
            near = near[label[near] == -1]
            lies = matmul(surface.normals[near], normal) >= slope
            near = near[lies]
            heights = matmul(surface.vertices[surface.triangles[near]], normal) - offset
            front = near[(np.abs(heights) <= flatness.distance).all(axis=1)]
            label[front] = number
    order = np.argsort(label, kind="stable")
    order = order[label[order] >= 0]
    groups = np.split(order, np.flatnonzero(np.diff(label[order])) + 1) if patch_numbers else []
    acute = _acute_neighbours(surface, across, label, np.array(patch_numbers, dtype=np.int64), offsets)
    return [
        Patch(group, surface.normals[seed], float(offsets[seed]), planes)
        for group, seed, planes in zip(groups, patch_numbers, acute, strict=True)
    ]


class _Growing:
    """Finds out for many triangles at once whether one of their neighbours may belong to the same patch.

    Attributes:
        seeds: for each of the triangles that `look` was given.
    """

    def __init__(self, surface: Surface, across: Ints, flatness: Flatness, offsets: Floats) -> None:
        self._surface, self._across, self._offsets = surface, across, offsets
        # wider by the rounding of the sums: what belongs to the patch is decided when it grows
        self._slope = math.cos(flatness.angle) - 1e-9
        self._distance = flatness.distance + 1e-9 * (surface.diagonal + float(np.abs(offsets).max(initial=0.0)))
        self.seeds: list[bool] = []

    def look(self, seeds: Ints) -> None:
        surface, near = self._surface, self._across[seeds]
        normals = surface.normals[seeds]
        alike = np.einsum("sj,snj->sn", normals, surface.normals[near]) >= self._slope
        corners = surface.vertices[surface.triangles[near]]
        heights = np.einsum("sj,sncj->snc", normals, corners) - self._offsets[seeds][:, None, None]
        close = (np.abs(heights) <= self._distance).all(axis=2)
        self.seeds = ((near >= 0) & alike & close).any(axis=1).tolist()


def _acute_neighbours(surface: Surface, across: Ints, label: Ints, seeds: Ints, offsets: Floats) -> list[Floats]:
    """Return for each patch the planes of its neighbours at an acute interior angle."""
    one, other = np.repeat(np.arange(len(across)), 3), across.ravel()
    has_neighbour = other >= 0
    one, other = one[has_neighbour], other[has_neighbour]
    mine, theirs = label[one], label[other]
    has_neighbour = (mine >= 0) & (theirs >= 0) & (mine != theirs)
    one, other, mine, theirs = one[has_neighbour], other[has_neighbour], mine[has_neighbour], theirs[has_neighbour]
    leans_back = np.einsum("ij,ij->i", surface.normals[one], surface.normals[other]) < -1e-3
    centres = surface.corners[other].mean(axis=1)
    behind = np.einsum("ij,ij->i", surface.normals[one], centres) < offsets[one]
    has_neighbour = leans_back & behind
    pairs = (
        np.unique(mine[has_neighbour] * len(seeds) + theirs[has_neighbour])
        if len(seeds)
        else np.empty(0, dtype=np.int64)
    )
    planes = np.column_stack([surface.normals[seeds], offsets[seeds]])
    cuts = np.searchsorted(pairs // max(1, len(seeds)), np.arange(1, len(seeds)))
    return [planes[group % len(seeds)] for group in np.split(pairs, cuts)] if len(seeds) else []


def outline(surface: Surface, triangles: Ints) -> list[list[int]]:
    """The closed loops of vertices around some triangles: outer loops are counter-clockwise, holes clockwise."""
    starts, ends = open_edges(surface.triangles[triangles], len(surface.vertices))
    following: dict[int, list[int]] = {}
    for start, end in zip(starts.tolist(), ends.tolist(), strict=True):
        following.setdefault(start, []).append(end)
    loops = []
    while following:
        first = next(iter(following))
        loop = [first]
        here = first
        while here in following:
            after = following[here].pop()
            if not following[here]:
                del following[here]
            if after == first:
                break
            loop.append(after)
            here = after
        loops.append(loop)
    return loops
