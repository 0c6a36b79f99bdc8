"""The polygons of a file, validated and divided into triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mapbox_earcut
import numpy as np

from morse.assets.polygons import Bools, Floats, Ints, Polygons
from morse.plugins.blend.container import Damage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.assets.polygons import Floats, Ints


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


#: limit of the time for ear clipping, which takes 10 ns times the square of the number of corners: 5 s for a mesh
_CLIP_BUDGET = 500_000_000


def triangulate(polygons: Polygons) -> tuple[Ints, Ints]:
    """Corners (T, 3) and polygon (T,) of the triangles, in the order of the polygons."""
    triangles: list[Ints] = [np.zeros((0, 3), np.int64)]
    owners: list[Ints] = [np.zeros(0, np.int64)]
    budget = _CLIP_BUDGET
    for size in np.unique(polygons.sizes).tolist():
        numbers = np.flatnonzero(polygons.sizes == size)
        corners = polygons.starts[numbers, None] + np.arange(size)
        fan = np.stack([np.zeros(size - 2, np.int64), np.arange(1, size - 1), np.arange(2, size)], axis=1)
        fans = corners[:, fan]
        simple = np.ones(len(numbers), np.bool_)
        for number, dent in _dents(polygons, numbers, corners):
            if size == 4:
                # a fan from the concave corner stays inside
                fans[number] = corners[number][(fan + dent) % 4]
            elif size * size <= budget:
                budget -= size * size
                ears = _clip(polygons.vertices[polygons.corners[corners[number]]], polygons.normals[numbers[number]])
                if ears is not None:
                    simple[number] = False
                    triangles.append(corners[number][ears])
                    owners.append(np.full(len(ears), numbers[number]))
        triangles.append(fans[simple].reshape(-1, 3))
        owners.append(np.repeat(numbers[simple], size - 2))
    owner = np.concatenate(owners)
    order = np.argsort(owner, kind="stable")
    return np.concatenate(triangles)[order], owner[order]


def _dents(polygons: Polygons, numbers: Ints, corners: Ints) -> list[tuple[int, int]]:
    """Return which of N polygons of equal size are concave, and the most concave corner of each.

    Args:
        polygons: the mesh.
        numbers: (N,) indices of polygons.
        corners: (N, size) their corners.
    """
    if corners.shape[1] == 3:
        return []
    points = polygons.vertices[polygons.corners[corners]]
    ahead = np.roll(points, -1, axis=1) - points
    turns = np.einsum("nkj,nj->nk", np.cross(np.roll(ahead, 1, axis=1), ahead), polygons.normals[numbers])
    # a small tolerance, because rounding bends straight sides in both directions
    concave = np.flatnonzero((turns < -1e-6 * np.abs(turns).max(axis=1, keepdims=True)).any(axis=1))
    return list(zip(concave.tolist(), turns[concave].argmin(axis=1).tolist(), strict=True))


def _clip(points: Floats, normal: Floats) -> Ints | None:
    """Return triangles (T, 3) of one polygon with its winding; None if it crosses itself.

    Corners on straight sides may be skipped.
    """
    drop = int(np.argmax(np.abs(normal)))
    plane_axes = [axis for axis in range(3) if axis != drop]
    flat = np.ascontiguousarray(points[:, plane_axes])
    ears = mapbox_earcut.triangulate_float64(flat, np.array([len(flat)], np.uint32)).astype(np.int64).reshape(-1, 3)
    areas = _cross(flat[ears[:, 1]] - flat[ears[:, 0]], flat[ears[:, 2]] - flat[ears[:, 0]])
    whole = _cross(flat - flat[0], np.roll(flat, -1, axis=0) - flat[0]).sum()
    if abs(np.abs(areas).sum() - abs(whole)) > 1e-3 * abs(whole):
        return None
    backward = areas * whole < 0.0
    ears[backward] = ears[backward][:, ::-1]
    return ears


def _cross(a: Floats, b: Floats) -> Floats:
    """(N,) cross products of vectors in the plane."""
    product: Floats = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return product
