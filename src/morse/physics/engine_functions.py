"""Functions that the engine lacks: sleep, gravity compensation, dynamics with many contacts, bodies near shapes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

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


#: distance below which shapes may touch, m
_NEAR = 0.02


def boxes_of(state: EngineState, geoms: Sequence[int] | NDArray[np.intp]) -> NDArray[np.float64]:
    """Return (N, 2, 3) lower and upper corners of the axis-aligned bounding boxes of some geoms, m."""
    numbers = np.asarray(geoms, dtype=np.intp)
    local = state.model.geom_aabb[numbers].reshape(-1, 2, 3)
    turns = state.data.geom_xmat[numbers].reshape(-1, 3, 3)
    centres = state.data.geom_xpos[numbers] + np.einsum("nij,nj->ni", turns, local[:, 0])
    halves = np.einsum("nij,nj->ni", np.abs(turns), local[:, 1])
    return np.stack([centres - halves, centres + halves], axis=1)


def trees_near(state: EngineState, boxes: NDArray[np.float64]) -> set[int]:
    """Return the trees of bodies that could touch one of some boxes (N, 2, 3)."""
    model = state.model
    trees = model.body_treeid[model.geom_bodyid]
    geoms = np.flatnonzero(trees >= 0)
    if not len(geoms) or not len(boxes):
        return set()
    own = boxes_of(state, geoms)
    meets = np.ones((len(geoms), len(boxes)), dtype=bool)
    for axis in range(3):
        meets &= own[:, None, 0, axis] <= boxes[None, :, 1, axis] + _NEAR
        meets &= own[:, None, 1, axis] >= boxes[None, :, 0, axis] - _NEAR
    return set(trees[geoms[meets.any(axis=1)]].tolist())
