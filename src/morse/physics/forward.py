"""Forward dynamics if there may be more contacts than the memory of the engine holds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.physics.state.engine_state import EngineState


def without_contacts(state: EngineState) -> None:
    """Compute the forward kinematics and dynamics without contacts."""
    flags = state.model.opt.disableflags
    state.model.opt.disableflags = flags | int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    try:
        mujoco.mj_forward(state.model, state.data)
    finally:
        state.model.opt.disableflags = flags


def forward(state: EngineState, again: Callable[[], object]) -> None:
    """Compute the forward dynamics; without contacts if they exhaust the memory of the engine.

    Args:
        again: sets the state again, because the engine stops within its computations when memory runs out.
    """
    try:
        mujoco.mj_forward(state.model, state.data)
    except mujoco.FatalError:
        mujoco.mj_resetData(state.model, state.data)
        again()
        without_contacts(state)
