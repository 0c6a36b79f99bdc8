"""The values of the engine that determine its future."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.physics import variations
from morse.physics.engine_functions import check_asleep, count_weightless, forward
from morse.physics.model.motors import ARRAYS
from morse.physics.poses.kinematics import contact_pairs

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.values import StateData
    from morse.physics.state.engine_state import EngineState
    from morse.physics.state.saved import SavedEngine

#: the arrays of the model that change while a simulation runs
CHANGED_WHILE_RUNNING = (
    "body_pos",
    "body_quat",
    "body_gravcomp",
    "dof_damping",
    *ARRAYS,
    "geom_pos",
    "geom_quat",
    "geom_condim",
    "geom_priority",
    "geom_solref",
    "geom_contype",
    "geom_conaffinity",
    *variations.ARRAYS,
)
#: the components of MuJoCo's state that a continuation needs
STATE = mujoco.mjtState.mjSTATE_INTEGRATION


def rewind(state: EngineState, numbers: NDArray[np.float64], asleep: NDArray[np.int32]) -> None:
    """Set another state of the same model; nothing of the present state remains.

    Args:
        numbers: MuJoCo's ``mjSTATE_INTEGRATION``.
        asleep: MuJoCo's ``tree_asleep``.
    """
    model, data = state.model, state.data
    mujoco.mj_resetData(model, data)
    # the poses of sleeping and static bodies are computed here, because steps do not compute them
    flags = model.opt.enableflags
    model.opt.enableflags = flags & ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    mujoco.mj_setState(model, data, numbers, STATE)
    forward(state, lambda: mujoco.mj_setState(model, data, numbers, STATE))
    model.opt.enableflags = flags
    mujoco.mj_setState(model, data, numbers, STATE)
    state.sleep.set(asleep)


def integration(state: EngineState) -> NDArray[np.float64]:
    """Return MuJoCo's ``mjSTATE_INTEGRATION``."""
    numbers = np.empty(mujoco.mj_stateSize(state.model, STATE))
    mujoco.mj_getState(state.model, state.data, numbers, STATE)
    return numbers


def get_state(state: EngineState) -> StateData:
    """See `morse.physics.state.saved.SavedEngine`."""
    model, data = state.model, state.data
    return {
        "integration": integration(state),
        "asleep": data.tree_asleep.copy(),
        "model": {name: getattr(model, name).copy() for name in CHANGED_WHILE_RUNNING},
        "contacts": contact_pairs(state).copy(),
        "forces": state.has_forces,
        "stirred": state.is_stirred,
    }


def check_state(state: EngineState, saved: SavedEngine) -> None:
    """Raise ValueError if the number of values differs from that of this scene, or a value is not valid."""
    model = state.model
    size = mujoco.mj_stateSize(model, STATE)
    if saved.integration.shape != (size,):
        raise ValueError(f"the engine has {size} numbers, but the state has {saved.integration.shape}")
    check_asleep(saved.asleep, model.ntree)
    if set(saved.model) != set(CHANGED_WHILE_RUNNING):
        raise ValueError(f"the state contains other arrays than {', '.join(CHANGED_WHILE_RUNNING)}")
    for name, values in saved.model.items():
        here = getattr(model, name)
        if values.shape != here.shape or values.dtype != here.dtype:
            raise ValueError(
                f"'{name}' is {here.dtype} {here.shape} in this scene, but {values.dtype} {values.shape} in the state"
            )
    if (saved.model["dof_armature"] < 0.0).any() or (saved.model["dof_M0"] < 0.0).any():
        raise ValueError("the inertia of a joint is negative")
    if (saved.model["body_mass"] < 0.0).any() or (saved.model["geom_friction"] < 0.0).any():
        raise ValueError("a mass or a friction is negative")
    if not np.isin(saved.model["geom_condim"], (1, 3, 4, 6)).all():
        raise ValueError("a contact has 1, 3, 4 or 6 dimensions")
    pairs = saved.contacts
    if pairs.ndim != 2 or pairs.shape[1] != 2 or pairs.dtype.kind not in "iu":
        raise ValueError(f"contacts are pairs of geoms, not {pairs.dtype} {pairs.shape}")
    if len(pairs) and not (pairs.min() >= 0 and pairs.max() < model.ngeom):
        raise ValueError(f"the state contains a geom that does not exist; this scene has {model.ngeom}")


def set_state(state: EngineState, saved: SavedEngine) -> None:
    """Restore validated values, and update all poses."""
    model = state.model
    for name, values in saved.model.items():
        getattr(model, name)[:] = values
    if model.body_gravcomp.any() and not model.ngravcomp:
        count_weightless(state)
    rewind(state, saved.integration, saved.asleep)
    state.known_contacts = saved.contacts.astype(np.int32)
    state.has_forces, state.is_stirred = saved.forces, saved.stirred
