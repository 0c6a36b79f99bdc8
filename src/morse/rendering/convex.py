"""Finds the closed convex parts of meshes: from outside, only their front faces are visible."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.kernel.drawing import convex_labels

if TYPE_CHECKING:
    from numpy.typing import NDArray


class ConvexParts(NamedTuple):
    """The closed convex parts of a mesh.

    Attributes:
        part: (T,) the part of each triangle, -1 for none.
        spheres: (N, 4) around the parts: centre and radius.
    """

    part: NDArray[np.intp]
    spheres: NDArray[np.float64]


def convex_parts(points: NDArray[np.float32], index: NDArray[np.integer], slot: NDArray[np.integer]) -> ConvexParts:
    """Find the closed convex parts of a mesh.

    A part is the triangles that share edges. It is closed if each of its edges belongs to two triangles, which face the
    same side. It is convex if no triangle is in front of the plane of a neighbour. The triangles face outward.

    Args:
        points: (V, 3) positions of the vertices.
        index: (T, 3) vertices of the triangles, counterclockwise seen from the front.
        slot: (T,) material of the triangles; a part has only one.
    """
    none = ConvexParts(np.full(len(index), -1), np.zeros((0, 4)))
    if not len(index):
        return none
    # the sum converts -0 to 0
    labels = convex_labels(points + np.float32(0.0), index.astype(np.int32), slot.astype(np.int32))
    chosen = np.flatnonzero(labels >= 0)
    if not len(chosen):
        return none
    first, none.part[chosen] = np.unique(labels[chosen], return_inverse=True)
    return ConvexParts(none.part, _spheres(points[index[chosen]].astype(np.float64), none.part[chosen], len(first)))


def _spheres(corners: NDArray[np.float64], part: NDArray[np.intp], count: int) -> NDArray[np.float64]:
    order = np.argsort(part, kind="stable")
    firsts = np.searchsorted(part[order], np.arange(count))
    low = np.minimum.reduceat(corners[order].min(axis=1), firsts)
    high = np.maximum.reduceat(corners[order].max(axis=1), firsts)
    return np.column_stack([(low + high) / 2, np.linalg.norm(high - low, axis=1) / 2])
