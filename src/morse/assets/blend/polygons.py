"""The faces of a mesh, independent of the version of the file format."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from morse.assets.blend.errors import Damage

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


def gather(
    vertices: Floats,
    corners: Ints,
    starts: Ints,
    sizes: Ints,
    *,
    materials: Ints | None = None,
    smooth: Bools | None = None,
    uvs: Floats | None = None,
    sharp: Ints | None = None,
    pictures: NDArray[np.uint64] | None = None,
) -> Polygons:
    """Validate the arrays of a file and concatenate the corners of all polygons.

    Polygons with fewer than three corners, or with a vertex that is not finite, are left out.

    Raises:
        Damage: an index points outside of its array, or polygons overlap.
    """
    if len(sizes) and (sizes.min() < 0 or starts.min() < 0 or (starts + sizes).max() > len(corners)):
        raise Damage("its polygons point outside of their corners")
    if sizes.sum() > len(corners):
        raise Damage("its polygons overlap")
    keep = sizes >= 3
    starts, sizes = starts[keep], sizes[keep]
    order = np.arange(sizes.sum()) + np.repeat(starts - np.cumsum(sizes) + sizes, sizes)
    corner_vertices = corners[order]
    if len(corner_vertices) and (corner_vertices.min() < 0 or corner_vertices.max() >= len(vertices)):
        raise Damage("its polygons point outside of their vertices")
    polygons = Polygons(
        vertices,
        corner_vertices,
        sizes,
        np.zeros(len(sizes), np.int64) if materials is None else materials[keep],
        np.zeros(len(sizes), np.bool_) if smooth is None else smooth[keep],
        None if uvs is None else np.where(np.abs(uvs[order]) < 1e6, uvs[order], 0.0),
        np.zeros((0, 2), np.int64) if sharp is None else sharp,
        None if pictures is None else pictures[keep],
    )
    invalid_vertices: Bools = np.logical_not((np.abs(vertices) < 1e9).all(axis=1))
    return _without(polygons, invalid_vertices) if invalid_vertices.any() else polygons


def _without(polygons: Polygons, invalid_vertices: Bools) -> Polygons:
    """Remove the polygons with one of the lost vertices (V,)."""
    bad = np.zeros(len(polygons.sizes), np.bool_)
    bad[polygons.polygon[invalid_vertices[polygons.corners]]] = True
    stays = ~bad[polygons.polygon]
    return Polygons(
        np.where(invalid_vertices[:, None], 0.0, polygons.vertices),
        polygons.corners[stays],
        polygons.sizes[~bad],
        polygons.materials[~bad],
        polygons.smooth[~bad],
        None if polygons.uvs is None else polygons.uvs[stays],
        polygons.sharp,
        None if polygons.pictures is None else polygons.pictures[~bad],
    )


def unit(vectors: Floats) -> Floats:
    """Normalise vectors (N, 3); vectors of length 0 stay 0."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    result: Floats = np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 1e-20)
    return result
