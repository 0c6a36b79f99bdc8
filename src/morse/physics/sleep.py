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
#: maximum number of sets of awake trees whose derived values are kept
_KEPT = 8


def check_asleep(asleep: NDArray[np.int32], trees: int) -> None:
    """Raise ValueError unless each tree is awake or is part of a cycle of sleeping trees."""
    if asleep.shape != (trees,) or asleep.dtype.kind not in "iu":
        raise ValueError(f"the engine has {trees} trees of bodies, not {asleep.shape}")
    sleepers = np.flatnonzero(asleep >= 0)
    if asleep.min(initial=-1) < WIDE_AWAKE or not np.array_equal(np.sort(asleep[sleepers]), sleepers):
        raise ValueError("the sleeping bodies do not form cycles")


class Sleep:
    """Sets which trees of bodies of a model sleep, and all values that the engine derives from that.

    The derived values of the last sets of awake trees are kept, because a set is often used in many ticks.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        self._model, self._data = model, data
        # views that are kept: the engine creates a new view at each access
        self._asleep, self._awake, self._bodies = data.tree_asleep, data.tree_awake, data.body_awake
        self._indices = data.body_awake_ind, data.parent_awake_ind, data.dof_awake_ind
        self._derived: dict[bytes, tuple[NDArray[np.intp], ...]] = {}

    def set(self, asleep: NDArray[np.int32]) -> None:
        """Set MuJoCo's ``tree_asleep``.

        All trees are awake in a model without sleep, for example after an object was added that does not support sleep.
        """
        data = self._data
        if not self._model.opt.enableflags & int(mujoco.mjtEnableBit.mjENBL_SLEEP):
            asleep = np.full_like(asleep, WIDE_AWAKE)
        awake = asleep < 0
        key = awake.tobytes()
        derived = self._derived.get(key)
        if derived is None:
            if len(self._derived) >= _KEPT:
                self._derived.clear()
            derived = self._derived[key] = self._derive(awake)
        self._asleep[:], self._awake[:] = asleep, awake
        self._bodies[:] = derived[0]
        for target, values in zip(self._indices, derived[1:], strict=True):
            target[: len(values)] = values
        data.ntree_awake = int(np.count_nonzero(awake))
        data.nbody_awake, data.nparent_awake, data.nv_awake = map(len, derived[1:])

    def _derive(self, awake: NDArray[np.bool_]) -> tuple[NDArray[np.intp], ...]:
        """Return the state of each body; and the awake bodies, the bodies with awake parents, the awake dofs."""
        model = self._model
        trees = model.body_treeid
        # bodies without joints are static, except those moved by explicit calls, which count as awake
        bodies = np.where(model.body_mocapid >= 0, 1, -1)
        bodies[trees >= 0] = awake[trees[trees >= 0]]
        parents = bodies[model.body_parentid] != 0
        parents[0] = False
        return bodies, np.flatnonzero(bodies), np.flatnonzero(parents), np.flatnonzero(awake[model.dof_treeid])


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
    state.sleep.set(waking)
