"""Meshes of polygons, the normals of their corners, and texture coordinates of simple solids, for readers of files."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import cos
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from morse.mathutils import portable

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.scene import Mesh


Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


@dataclass(eq=False)
class Polygons:
    """Polygons with at least three corners, whose corners are concatenated in one array.

    Attributes:
        vertices: (V, 3) metres.
        corners: (C,) vertex of each corner.
        sizes: (P,) corners of each polygon.
        materials: (P,) material slot.
        smooth: (P,) whether the polygon is shaded smoothly.
        uvs: (C, 2) texture coordinates, or None.
        sharp: (E, 2) vertices of the sharp edges.
        pictures: (P,) address of the image that each polygon shows (until 2.79), 0 for none; or None.
    """

    vertices: Floats
    corners: Ints
    sizes: Ints
    materials: Ints
    smooth: Bools
    uvs: Floats | None
    sharp: Ints
    pictures: NDArray[np.uint64] | None = None

    @cached_property
    def starts(self) -> Ints:
        """(P,) first corner of each polygon."""
        return np.cumsum(self.sizes) - self.sizes

    @cached_property
    def polygon(self) -> Ints:
        """(C,) polygon of each corner."""
        return np.repeat(np.arange(len(self.sizes)), self.sizes)

    @cached_property
    def following(self) -> Ints:
        """(C,) the next corner of the same polygon."""
        following = np.arange(1, len(self.corners) + 1)
        following[self.starts + self.sizes - 1] = self.starts
        return following

    @cached_property
    def normals(self) -> Floats:
        """(P, 3) unit normals by Newell's method; zero for polygons without area."""
        if not len(self.sizes):
            return np.zeros((0, 3))
        # relative to the first corner, because products of large coordinates lose precision
        points = self.vertices[self.corners] - self.vertices[self.corners[self.starts]][self.polygon]
        return unit(np.add.reduceat(np.cross(points, points[self.following]), self.starts))


def unit(vectors: Floats) -> Floats:
    """Normalise vectors (N, 3); vectors of length 0 stay 0."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    result: Floats = np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 1e-20)
    return result


def corner_normals(polygons: Polygons, crease: float | None = None) -> Floats | None:
    """(C, 3) unit normals, or None if all polygons are flat.

    Each is the mean of the normals of the polygons around its vertex, weighted with the angles of the polygons at the
    vertex (Thürmer and Wüthrich 1998).

    Args:
        polygons: the mesh.
        crease: angle above which an edge is sharp, rad. Marked edges and edges of flat polygons are also sharp. Sharp
            edges separate the polygons around a vertex. None: no edge is sharp.
    """
    if not polygons.smooth.any():
        return None
    weights = polygons.normals[polygons.polygon] * _angles(polygons)[:, None]
    group = polygons.corners if crease is None else _fans(polygons, crease)
    count = int(group.max()) + 1
    sums: Floats = np.stack([np.bincount(group, weights[:, axis], count) for axis in range(3)], axis=1)
    result = unit(sums)[group]
    flat = ~polygons.smooth[polygons.polygon] | ~result.any(axis=1)
    result[flat] = polygons.normals[polygons.polygon[flat]]
    return result


def _angles(polygons: Polygons) -> Floats:
    """(C,) inner angle of each corner, rad."""
    points = polygons.vertices[polygons.corners]
    ahead = unit(points[polygons.following] - points)
    behind = np.empty_like(ahead)
    behind[polygons.following] = -ahead
    angles: Floats = portable.arccos(np.clip(np.einsum("nj,nj->n", ahead, behind), -1.0, 1.0))
    return angles


def _fans(polygons: Polygons, crease: float) -> Ints:
    """Return (C,) labels; corners have the same label if smooth edges connect them around their vertex."""
    first, second = _smooth_edges(polygons, crease)
    after_first, after_second = polygons.following[first], polygons.following[second]
    # neighbours traverse their common edge in opposite directions, unless one is flipped
    opposite = polygons.corners[first] != polygons.corners[second]
    one = np.concatenate([first, after_first])
    other = np.concatenate([np.where(opposite, after_second, second), np.where(opposite, second, after_second)])
    labels = np.arange(len(polygons.corners))
    while True:
        lowest = np.minimum(labels[one], labels[other])
        joined_labels = labels.copy()
        np.minimum.at(joined_labels, one, lowest)
        np.minimum.at(joined_labels, other, lowest)
        joined_labels = joined_labels[joined_labels]
        if np.array_equal(joined_labels, labels):
            return labels
        labels = joined_labels


def _smooth_edges(polygons: Polygons, crease: float) -> tuple[Ints, Ints]:
    """The corners at which the edges between two polygons start, one array for each of the two."""
    keys = _edge_keys(polygons.corners, polygons.corners[polygons.following], len(polygons.vertices))
    order = np.argsort(keys, kind="stable")
    _, begin, count = np.unique(keys[order], return_index=True, return_counts=True)
    begin = begin[count == 2]
    first, second = order[begin], order[begin + 1]
    keep = polygons.smooth[polygons.polygon[first]] & polygons.smooth[polygons.polygon[second]]
    a, b = (polygons.normals[polygons.polygon[side]] for side in (first, second))
    keep &= np.einsum("nj,nj->n", a, b) >= cos(crease) - 1e-6
    if len(polygons.sharp):
        sharp = _edge_keys(polygons.sharp[:, 0], polygons.sharp[:, 1], len(polygons.vertices))
        keep &= ~np.isin(keys[first], sharp)
    return first[keep], second[keep]


def _edge_keys(a: Ints, b: Ints, count: int) -> Ints:
    return np.minimum(a, b) * count + np.maximum(a, b)


def with_texture_coordinates(
    mesh: Mesh, repeat: tuple[float, float] = (1.0, 1.0), scale: Sequence[float] | None = None
) -> Mesh:
    """A mesh whose triangles show the picture as seen along the axis that is closest to their normal.

    The picture fills the bounding box of the mesh on each side.

    Args:
        repeat: how often the picture is repeated, horizontally and vertically.
        scale: with the scale (3,) of the node, the picture is repeated that often in each metre instead.
    """
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    side = np.abs(normals).argmax(axis=1)
    low = mesh.vertices.min(axis=0)
    size = np.maximum(mesh.vertices.max(axis=0) - low, 1e-9)
    shares = (corners - low) / size
    axes = np.array([[1, 2], [0, 2], [0, 1]])[side]
    uvs = np.take_along_axis(shares, axes[:, None, :].repeat(3, axis=1), axis=2)
    # seen from outside, the picture is not mirrored
    sign = np.take_along_axis(normals, side[:, None], axis=1)[:, 0] * np.array([1.0, -1.0, 1.0])[side]
    uvs[..., 0] = np.where(sign[:, None] < 0.0, 1.0 - uvs[..., 0], uvs[..., 0])
    uvs *= repeat
    if scale is not None:
        uvs *= (size * np.abs(scale))[axes][:, None, :]
    return replace(mesh, uvs=uvs.astype(np.float32))
