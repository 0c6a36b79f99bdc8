"""Works out where everything is from the state of the engine."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.physics import rigid
from morse.physics.rows import Rows

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.physics.engine_state import EngineState


def place_as_compiled(state: EngineState) -> None:
    """Every slot where the scene has it."""
    count = len(state.slots)
    moving = state.moving
    state.positions, state.rotations = Rows(np.zeros((count, 3)), moving), Rows(np.zeros((count, 9)), moving)
    for index, slot in enumerate(state.slots):
        state.positions[index] = tuple(slot.pose.position)
        state.rotations[index] = tuple(v for row in slot.pose.rotation for v in row)
    state.quaternions = [rigid.quaternion(state.rotations[index]) for index in range(count)]


def sync(state: EngineState) -> None:
    """Work out where everything is, from the state as it is now."""
    mujoco.mj_kinematics(state.model, state.data)
    refresh(state)


def refresh(state: EngineState) -> None:
    """Take the poses of the moving bodies from the engine."""
    state.positions.take(state.engine_positions)
    state.rotations.take(state.engine_rotations)
    state.touched.clear()
    state.stamp += 1


def settle_fixed(state: EngineState) -> None:
    """Work out where the bodies are that stand still, after one of them was put elsewhere."""
    # what never moves is computed once while sleeping is allowed
    flag = int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    state.model.opt.enableflags &= ~flag
    mujoco.mj_kinematics(state.model, state.data)
    state.model.opt.enableflags |= flag


def contact_pairs(state: EngineState) -> NDArray[np.int32]:
    """(N, 2) geoms that touched when the engine looked last."""
    if state.known_contacts is not None:
        return state.known_contacts
    return np.asarray(state.data.contact.geom[: state.data.ncon])
