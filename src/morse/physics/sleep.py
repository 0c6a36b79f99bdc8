"""Sets which trees of bodies sleep, because the engine has no function for that."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.physics.state.engine_state import EngineState

#: value of an awake tree, from which the engine counts up to -1, "ready to sleep"
WIDE_AWAKE = -(1 + mujoco.mjMINAWAKE)


def check_asleep(asleep: NDArray[np.int32], trees: int) -> None:
    """Raise ValueError unless each tree is awake or is part of a cycle of sleeping trees."""
    if asleep.shape != (trees,) or asleep.dtype.kind not in "iu":
        raise ValueError(f"the engine has {trees} trees of bodies, not {asleep.shape}")
    sleepers = np.flatnonzero(asleep >= 0)
    if asleep.min(initial=-1) < WIDE_AWAKE or not np.array_equal(np.sort(asleep[sleepers]), sleepers):
        raise ValueError("the sleeping bodies do not form cycles")


def set_asleep(state: EngineState, asleep: NDArray[np.int32]) -> None:
    """Set MuJoCo's ``tree_asleep`` and all values that the engine derives from it.

    All trees are awake in a model without sleep, for example after an object was added that does not support sleep.
    """
    model, data = state.model, state.data
    if not model.opt.enableflags & int(mujoco.mjtEnableBit.mjENBL_SLEEP):
        asleep = np.full_like(asleep, WIDE_AWAKE)
    data.tree_asleep[:] = asleep
    awake = np.asarray(asleep) < 0
    data.tree_awake[:] = awake
    trees = model.body_treeid
    # bodies without joints are static, except those moved by explicit calls, which count as awake
    bodies = np.where(model.body_mocapid >= 0, 1, -1)
    bodies[trees >= 0] = awake[trees[trees >= 0]]
    data.body_awake[:] = bodies
    data.ntree_awake = int(awake.sum())
    data.nbody_awake = _fill(data.body_awake_ind, np.flatnonzero(bodies != 0))
    parents = bodies[model.body_parentid] != 0
    parents[0] = False
    data.nparent_awake = _fill(data.parent_awake_ind, np.flatnonzero(parents))
    data.nv_awake = _fill(data.dof_awake_ind, np.flatnonzero(awake[model.dof_treeid]))


def wake(state: EngineState, body: int) -> None:
    """Wake the tree of a body, and all trees that sleep with it."""
    tree = int(state.model.body_treeid[body])
    asleep = state.data.tree_asleep
    if tree < 0 or asleep[tree] < 0:
        return
    waking = asleep.copy()
    while waking[tree] >= 0:
        following = int(waking[tree])
        waking[tree] = WIDE_AWAKE
        tree = following
    set_asleep(state, waking)


def _fill(target: NDArray[np.int32], values: NDArray[np.intp]) -> int:
    target[: len(values)] = values
    return len(values)
