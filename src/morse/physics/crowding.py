"""Keeps many bodies at one place from exhausting the memory and the time of the engine.

Bodies that are put inside each other, for example robots that are all spawned at one point, have a number of contacts
that grows with the square of their number. A few thousand contacts take longer than a tick, and some ten thousand
exhaust the memory of the engine, which would end the run. Bodies with the most contacts are therefore excluded: they
stop, float, and collide with nothing until the simulation is reset or they are deleted.
"""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.physics.poses.kinematics import IN_GAP
from morse.physics.weightless import count_weightless

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.physics.rescue import Rescue
    from morse.physics.state.engine_state import EngineState

#: largest number of contacts between moving bodies: a constant, and in addition a number for each moving body; heaps of
#: boxes have a fraction of them
_MOST, _MOST_EACH = 2000, 16


class Crowding:
    """Finds and excludes bodies that overlap too many other bodies.

    Args:
        free: the bodies of the engine that move freely, with their names.
        rescue: logs errors.
    """

    def __init__(self, state: EngineState, free: dict[int, str], rescue: Rescue) -> None:
        self._state = state
        self._rescue = rescue
        model = state.model
        self._names = free
        self._is_free = np.zeros(model.nbody, dtype=bool)
        self._is_free[list(free)] = True
        #: the body at the top of the tree to which a geom belongs
        self._root = model.body_rootid[model.geom_bodyid]
        self.most = _MOST + _MOST_EACH * len(free)

    def relieve(self) -> bool:
        """Exclude bodies if the last step found too many contacts; return whether any body was excluded."""
        return self._state.data.ncon > self.most and self._exclude(self._pairs(self._state.data))

    def relieve_at_once(self) -> bool:
        """Exclude bodies after the engine has run out of memory; return whether any body was excluded.

        The state of the engine is valid, but its contacts are unknown.
        """
        data = mujoco.MjData(self._state.model)
        data.qpos[:] = self._state.data.qpos
        data.mocap_pos[:], data.mocap_quat[:] = self._state.data.mocap_pos, self._state.data.mocap_quat
        mujoco.mj_kinematics(self._state.model, data)
        mujoco.mj_comPos(self._state.model, data)
        with suppress(mujoco.FatalError):  # the contacts that fit into the memory suffice
            mujoco.mj_collision(self._state.model, data)
        return self._exclude(self._pairs(data))

    def _pairs(self, data: mujoco.MjData) -> NDArray[np.int32]:
        """Return (N, 2) bodies for the contacts between two bodies that move freely."""
        # contacts within the gaps around gliding robots do not count
        geoms = data.contact.geom[data.contact.exclude != IN_GAP]
        pairs: NDArray[np.int32] = self._root[geoms]
        free = self._is_free[pairs].all(axis=1) & (pairs[:, 0] != pairs[:, 1])
        return np.asarray(pairs[free])

    def _exclude(self, pairs: NDArray[np.int32]) -> bool:
        excluded = 0
        while len(pairs) > self.most // 2:
            counts = np.bincount(pairs.ravel(), minlength=self._state.model.nbody)
            # of bodies with equal numbers of contacts the last one, which has probably come last
            body = len(counts) - 1 - int(np.argmax(counts[::-1]))
            self._set_aside(body)
            excluded += 1
            if excluded == 1:
                first = body
            pairs = pairs[(pairs != body).all(axis=1)]
        if excluded:
            count_weightless(self._state)
            others = f" and {excluded - 1} other bodies overlap" if excluded > 1 else " overlaps"
            self._rescue.report(
                f"'{self._names[first]}'{others} so many bodies that the contacts take longer than a tick: until the "
                "next reset, what overlaps floats at its place and collides with nothing. Put objects beside each "
                "other"
            )
        return excluded > 0

    def _set_aside(self, body: int) -> None:
        model, data = self._state.model, self._state.data
        geoms = self._root == body
        model.geom_contype[geoms] = model.geom_conaffinity[geoms] = 0
        model.body_gravcomp[model.body_rootid == body] = 1.0
        dofs = model.body_rootid[model.dof_bodyid] == body
        for values in (data.qvel, data.qacc_warmstart, data.qfrc_applied):
            values[dofs] = 0.0
