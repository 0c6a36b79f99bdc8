"""Makes the engine obey weights that were cancelled while it runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco

if TYPE_CHECKING:
    from morse.physics.engine_state import EngineState


def count_weightless(state: EngineState) -> None:
    """Have the engine count the weightless bodies, which it does at compile time only.

    Its function for that spoils positions, and takes the masks of bodies from those that their shapes have at the
    moment: a robot that glides just then would fall through the floor later.
    """
    model, data = state.model, state.data
    kept = data.qpos.copy(), model.body_contype.copy(), model.body_conaffinity.copy()
    mujoco.mj_setConst(model, data)
    data.qpos[:], model.body_contype[:], model.body_conaffinity[:] = kept
