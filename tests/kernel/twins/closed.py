"""Finds the closed parts of a mesh in numpy; the twin of ``c/draw_closed.c``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def closed_labels(points: NDArray[np.float32], index: NDArray[np.int32]) -> NDArray[np.int32]:
    """See `morse.kernel.drawing.meshes.closed_labels`."""
    count = len(index)
    corners = points[index].astype(np.float64)
    beside, is_paired = _neighbours(_welded(points[index].reshape(-1, 3)).reshape(-1, 3))
    triangle = np.repeat(np.arange(count), 3)
    label = _labels(np.where(is_paired, beside // 3, triangle).reshape(-1, 3))
    # six times the volumes between the triangles and a point
    apart = corners - corners[0, 0]
    volume = _dot(apart[:, 0], np.cross(apart[:, 1], apart[:, 2]))
    is_closed = (np.bincount(label[triangle], ~is_paired, count) == 0) & (np.bincount(label, volume, count) > 0)
    return np.where(is_closed[label], label, -1).astype(np.int32)


def _dot(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N,) products of vectors (N, 3), term by term."""
    return np.asarray(a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2])


def _welded(rows: NDArray[np.float32]) -> NDArray[np.int64]:
    """The same number for rows (N, 3) with the same position."""
    words = np.ascontiguousarray(rows).view(np.uint32).astype(np.uint64)
    factors = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)
    mixed = words * factors
    mixed ^= mixed >> np.uint64(29)
    key = mixed.sum(axis=1, dtype=np.uint64)
    order = np.argsort(key)
    begins = np.ones(len(key), bool)
    np.not_equal(key[order[1:]], key[order[:-1]], out=begins[1:])
    number = np.empty(len(key), np.int64)
    number[order] = np.cumsum(begins) - 1
    return number


def _neighbours(index: NDArray[np.int64]) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """The edge of another triangle that each edge (3 T,) coincides with, in the opposite direction, if it is the only.

    Edge 3 t + i of triangle t is that from its vertex i to the next one. An edge without another one gets its own
    number.
    """
    start, end = index.ravel(), index[:, [1, 2, 0]].ravel()
    low, high = np.minimum(start, end), np.maximum(start, end)
    key = low * (int(high.max()) + 1) + high
    order = np.argsort(key)
    ordered = key[order]
    alike = np.concatenate([[False], ordered[1:] == ordered[:-1], [False]])
    # exactly two in a group: the first of them
    firsts = np.flatnonzero(~alike[:-2] & alike[1:-1] & ~alike[2:]) if len(key) > 1 else np.zeros(0, np.intp)
    one, other = order[firsts], order[firsts + 1]
    opposite = (start[one] == end[other]) & (start[one] != end[one])
    one, other = one[opposite], other[opposite]
    beside, is_paired = np.arange(len(key)), np.zeros(len(key), bool)
    beside[one], beside[other] = other, one
    is_paired[one] = is_paired[other] = True
    return beside, is_paired


def _labels(beside: NDArray[np.intp]) -> NDArray[np.intp]:
    """The lowest triangle of the part of each triangle, from its three neighbours (T, 3)."""
    label = np.arange(len(beside))
    while True:
        lower = np.minimum(label, label[beside].min(axis=1))
        lower = lower[lower]
        if np.array_equal(lower, label):
            return label
        label = lower
