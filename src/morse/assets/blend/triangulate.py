"""Polygons to triangles, concave ones too."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mapbox_earcut
import numpy as np

if TYPE_CHECKING:
    from morse.assets.blend.polygons import Floats, Ints, Polygons

#: clipping the ears of a polygon takes up to 10 ns times the square of its corners; a mesh gets 5 s
_CLIP_BUDGET = 500_000_000


def triangulate(polygons: Polygons) -> tuple[Ints, Ints]:
    """Corners (T, 3) and polygon (T,) of the triangles, in the order of the polygons."""
    triangles: list[Ints] = []
    owners: list[Ints] = []
    budget = _CLIP_BUDGET
    for size in np.unique(polygons.sizes).tolist():
        chosen = np.flatnonzero(polygons.sizes == size)
        pieces, spent = _split(polygons, chosen, size, budget)
        budget -= spent
        triangles.append(pieces.reshape(-1, 3))
        owners.append(np.repeat(chosen, size - 2))
    if not triangles:
        return np.zeros((0, 3), np.int64), np.zeros(0, np.int64)
    owner = np.concatenate(owners)
    order = np.argsort(owner, kind="stable")
    return np.concatenate(triangles)[order], owner[order]


def _split(polygons: Polygons, chosen: Ints, size: int, budget: int) -> tuple[Ints, int]:
    """Corners (N, size - 2, 3) of the triangles of N polygons of equal size, and what they cost of the budget."""
    spent = 0
    corners = polygons.starts[chosen, None] + np.arange(size)
    fan = np.stack([np.zeros(size - 2, np.int64), np.arange(1, size - 1), np.arange(2, size)], axis=1)
    result = corners[:, fan]
    if size == 3:
        return result, spent
    points = polygons.vertices[polygons.corners[corners]]
    normals = polygons.normals[chosen]
    ahead = np.roll(points, -1, axis=1) - points
    turns = np.einsum("nkj,nj->nk", np.cross(np.roll(ahead, 1, axis=1), ahead), normals)
    # a little slack: rounding bends the straight sides of flat polygons both ways
    concave = np.flatnonzero((turns < -1e-6 * np.abs(turns).max(axis=1, keepdims=True)).any(axis=1))
    for polygon in concave:
        if size == 4:
            dent = int(np.argmin(turns[polygon]))
            result[polygon] = corners[polygon][(fan + dent) % 4]
        elif spent + size * size <= budget:
            spent += size * size
            ears = _clip(points[polygon], normals[polygon])
            if len(ears) == size - 2:
                result[polygon] = corners[polygon][ears]
    return result, spent


def _clip(points: Floats, normal: Floats) -> Ints:
    """(T, 3) indices of the triangles of one polygon, wound as it is."""
    drop = int(np.argmax(np.abs(normal)))
    kept = [axis for axis in range(3) if axis != drop]
    flat = np.ascontiguousarray(points[:, kept])
    ears = mapbox_earcut.triangulate_float64(flat, np.array([len(flat)], np.uint32)).astype(np.int64).reshape(-1, 3)
    a, b, c = (points[ears[:, i]] for i in range(3))
    backward = np.einsum("nj,j->n", np.cross(b - a, c - a), normal) < 0.0
    ears[backward] = ears[backward][:, ::-1]
    return ears
