"""Intersections of rays with triangle meshes: the reference for ``c/mesh.h``.

Watertight, in double precision (Woop, Benthin and Wald 2013). Each operation is the same there, in
the same order, so that both give bit-identical results; the order of the tested triangles does not matter.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.kernel.rays import TriangleMesh

    Floats = NDArray[np.float64]
    Numbers = NDArray[np.intp]

#: triangles in a leaf
_LEAF = 8


class ReferenceMesh:
    """A mesh in a balanced tree of boxes, each level an array."""

    def __init__(self, mesh: TriangleMesh) -> None:
        self._corners = mesh.corners()
        count = len(self._corners)
        depth = max(0, math.ceil(math.log2(max(count, 1) / _LEAF)))
        order = np.minimum(np.arange(_LEAF << depth), max(count - 1, 0))[None, :]
        middles = self._corners.mean(axis=1) if count else np.zeros((1, 3))
        for _ in range(depth):
            here = middles[order]
            axis = np.argmax(np.ptp(here, axis=1), axis=1)
            places = np.take_along_axis(here, axis[:, None, None], axis=2)[:, :, 0]
            order = np.take_along_axis(order, np.argsort(places, axis=1, kind="stable"), axis=1)
            order = order.reshape(2 * len(order), -1)
        self._leaves = order
        corners = self._corners[order] if count else np.zeros((1, 1, 1, 3))
        boxes = np.stack([corners.min(axis=(1, 2)), corners.max(axis=(1, 2))], axis=1)
        self._levels = [boxes]
        while len(self._levels[0]) > 1:
            pairs = self._levels[0].reshape(-1, 2, 2, 3)
            self._levels.insert(0, np.stack([pairs[:, :, 0].min(axis=1), pairs[:, :, 1].max(axis=1)], axis=1))

    def first(self, origins: Floats, directions: Floats, limits: Floats) -> tuple[Floats, NDArray[np.int32]]:
        """Distance (N,), infinite without a hit, and triangle (N,), -1 without a hit, of the first hit of each ray."""
        distances, faces = np.full(len(origins), np.inf), np.full(len(origins), -1, dtype=np.int32)
        if not len(self._corners):
            return distances, faces
        rays, leaves = self._near(origins, directions, limits)
        rays, triangles = rays.repeat(_LEAF), self._leaves[leaves].ravel()
        nearest = triangle_distances(self._corners[triangles], origins[rays], directions[rays])
        met = np.flatnonzero(nearest <= limits[rays])
        rays, triangles, nearest = rays[met], triangles[met], nearest[met]
        order = np.lexsort((triangles, nearest, rays))
        rays, first = np.unique(rays[order], return_index=True)
        distances[rays], faces[rays] = nearest[order][first] + 0.0, triangles[order][first]
        return distances, faces

    def _near(self, origins: Floats, directions: Floats, limits: Floats) -> tuple[Numbers, Numbers]:
        """The pairs of rays and leaves whose boxes the rays hit."""
        steps = 1.0 / np.where(np.abs(directions) < 1e-30, np.copysign(1e-30, directions), directions)
        rays, nodes = np.arange(len(origins)), np.zeros(len(origins), dtype=np.intp)
        for level, boxes in enumerate(self._levels):
            if level:
                rays, nodes = rays.repeat(2), np.stack([2 * nodes, 2 * nodes + 1], axis=1).ravel()
            sides = boxes[nodes]
            slack = 1e-6 * np.abs(sides) + 1e-9
            away, ways = origins[rays], steps[rays]
            one, other = (sides[:, 0] - slack[:, 0] - away) * ways, (sides[:, 1] + slack[:, 1] - away) * ways
            enter, leave = np.minimum(one, other).max(axis=1), np.maximum(one, other).min(axis=1)
            met = np.maximum(enter, 0.0) <= np.minimum(leave, limits[rays]) * (1.0 + 1e-6)
            rays, nodes = rays[met], nodes[met]
        return rays, nodes


def triangle_distances(corners: Floats, origins: Floats, directions: Floats) -> Floats:
    """Distance (K,) of each ray to its triangle (K, corner, axis); infinite for a miss."""
    result = np.full(len(corners), np.inf)
    largest = np.argmax(np.abs(directions), axis=1)
    for z in range(3):
        x, y = (z + 1) % 3, (z + 2) % 3
        some = np.flatnonzero(largest == z)
        o, d, c = origins[some], directions[some], corners[some]
        shear_x, shear_y, shear_z = d[:, x] / d[:, z], d[:, y] / d[:, z], 1.0 / d[:, z]
        px, py, pz = [], [], []
        for k in range(3):
            away = c[:, k, z] - o[:, z]
            px.append((c[:, k, x] - o[:, x]) - shear_x * away)
            py.append((c[:, k, y] - o[:, y]) - shear_y * away)
            pz.append(shear_z * away)
        u = px[2] * py[1] - py[2] * px[1]
        v = px[0] * py[2] - py[0] * px[2]
        w = px[1] * py[0] - py[1] * px[0]
        total = u + v + w
        inside = ((u >= 0.0) & (v >= 0.0) & (w >= 0.0)) | ((u <= 0.0) & (v <= 0.0) & (w <= 0.0))
        inside &= total != 0.0
        distances = (u * pz[0] + v * pz[1] + w * pz[2]) / total
        result[some] = np.where(inside & (distances >= 0.0), distances, np.inf)
    return result
