"""Enables gravity compensation in the engine at run time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco

if TYPE_CHECKING:
    from morse.physics.state.engine_state import EngineState


def count_weightless(state: EngineState) -> None:
    """Count the weightless bodies, which the engine does at compile time only.

    The function of the engine for that modifies positions, and computes the collision masks of bodies from the present
    masks of their shapes. A robot that is gliding at that time would later fall through the floor.
    """
    model, data = state.model, state.data
    originals = data.qpos.copy(), model.body_contype.copy(), model.body_conaffinity.copy()
    mujoco.mj_setConst(model, data)
    data.qpos[:], model.body_contype[:], model.body_conaffinity[:] = originals
