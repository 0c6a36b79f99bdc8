"""Finds bodies near some shapes by their axis-aligned bounding boxes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.physics.state.engine_state import EngineState

#: distance below which shapes may touch, m
_NEAR = 0.02


def boxes_of(state: EngineState, geoms: Sequence[int] | NDArray[np.intp]) -> NDArray[np.float64]:
    """Return (N, 2, 3) lower and upper corners of the axis-aligned bounding boxes of some geoms, m."""
    numbers = np.asarray(geoms, dtype=np.intp)
    local = state.model.geom_aabb[numbers].reshape(-1, 2, 3)
    turns = state.data.geom_xmat[numbers].reshape(-1, 3, 3)
    centres = state.data.geom_xpos[numbers] + np.einsum("nij,nj->ni", turns, local[:, 0])
    halves = np.einsum("nij,nj->ni", np.abs(turns), local[:, 1])
    return np.stack([centres - halves, centres + halves], axis=1)


def trees_near(state: EngineState, boxes: NDArray[np.float64]) -> set[int]:
    """Return the trees of bodies that could touch one of some boxes (N, 2, 3)."""
    model = state.model
    trees = model.body_treeid[model.geom_bodyid]
    geoms = np.flatnonzero(trees >= 0)
    if not len(geoms) or not len(boxes):
        return set()
    own = boxes_of(state, geoms)
    meets = np.ones((len(geoms), len(boxes)), dtype=bool)
    for axis in range(3):
        meets &= own[:, None, 0, axis] <= boxes[None, :, 1, axis] + _NEAR
        meets &= own[:, None, 1, axis] >= boxes[None, :, 0, axis] - _NEAR
    return set(trees[geoms[meets.any(axis=1)]].tolist())
