"""The lowest point of everything that stands still."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import mujoco
import numpy as np

if TYPE_CHECKING:
    from morse.physics.state.engine_state import EngineState


def lowest_fixed(state: EngineState) -> float:
    """Return the least height of the collision shapes that are part of the world, m.

    Infinity if there are none; minus infinity if one of them is an endless plane.
    """
    model, data = state.model, state.data
    fixed = model.body_weldid[model.geom_bodyid] == 0
    solid = fixed & ((model.geom_contype | model.geom_conaffinity) != 0)
    # these planes represent the top faces of boxes, and end where the boxes end
    solid[list(state.planes.values())] = False
    if not solid.any():
        return math.inf
    if (solid & (model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE)).any():
        return -math.inf
    rows = data.geom_xmat[solid].reshape(-1, 3, 3)[:, 2]
    centre, half = model.geom_aabb[solid, :3], model.geom_aabb[solid, 3:]
    heights = data.geom_xpos[solid, 2] + (rows * centre).sum(1) - (np.abs(rows) * half).sum(1)
    return float(heights.min())
