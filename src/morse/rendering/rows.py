"""Equal rows of numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


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
