"""The lowest point of a world."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import mujoco
import numpy as np

if TYPE_CHECKING:
    from morse.physics.state.engine_state import EngineState


def lowest_shape(state: EngineState) -> tuple[float, bool]:
    """Return the height of the lowest point of all collision shapes at their present poses, m.

    Infinity if there are none; an endless plane that is level has one height, another one minus infinity. The second
    value is whether any of the shapes stands still.
    """
    model, data = state.model, state.data
    solid = (model.geom_contype | model.geom_conaffinity) != 0
    # these planes represent the top faces of boxes, and end where the boxes end
    solid[list(state.planes.values())] = False
    if not solid.any():
        return math.inf, False
    rows = data.geom_xmat[solid].reshape(-1, 3, 3)[:, 2]
    centre, half = model.geom_aabb[solid, :3], model.geom_aabb[solid, 3:]
    heights = data.geom_xpos[solid, 2] + (rows * centre).sum(1) - (np.abs(rows) * half).sum(1)
    planes = model.geom_type[solid] == mujoco.mjtGeom.mjGEOM_PLANE
    level = np.abs(rows[:, 2]) > 1.0 - 1e-9
    heights[planes] = np.where(level, data.geom_xpos[solid, 2], -math.inf)[planes]
    return float(heights.min()), bool((model.body_weldid[model.geom_bodyid[solid]] == 0).any())
