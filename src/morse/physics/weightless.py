"""Enables gravity compensation in the engine at run time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco

if TYPE_CHECKING:
    from morse.physics.state.engine_state import EngineState


def count_weightless(state: EngineState) -> None:
    """Count the weightless bodies, which the engine does at compile time only.

    The function of the engine for that modifies positions; it computes the collision masks of bodies from the present
    masks of their shapes, and the bounding boxes from their present poses. A robot that is gliding at that time would
    later fall through the floor, and a wall that moves later would be missed.
    """
    model, data = state.model, state.data
    changed = data.qpos, model.body_contype, model.body_conaffinity, model.bvh_aabb
    originals = [values.copy() for values in changed]
    mujoco.mj_setConst(model, data)
    for values, original in zip(changed, originals, strict=True):
        values[:] = original
