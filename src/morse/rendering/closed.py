"""Finds the closed parts of meshes: from outside, only their front faces are visible."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.kernel.drawing import closed_labels
from morse.kernel.drawing.arrays import CLOSED, MIXED

if TYPE_CHECKING:
    from numpy.typing import NDArray


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
    return none._replace(spheres=_spheres(points[index[triangles]].astype(np.float64), part, len(first)))


def _spheres(corners: NDArray[np.float64], part: NDArray[np.intp], count: int) -> NDArray[np.float64]:
    order = np.argsort(part, kind="stable")
    firsts = np.searchsorted(part[order], np.arange(count))
    low = np.minimum.reduceat(corners[order].min(axis=1), firsts)
    high = np.maximum.reduceat(corners[order].max(axis=1), firsts)
    return np.column_stack([(low + high) / 2, np.linalg.norm(high - low, axis=1) / 2])
