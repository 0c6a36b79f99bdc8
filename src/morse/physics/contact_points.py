"""Contact points of bodies, for observers."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.mathutils.portable import matmul

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from morse.physics.gliding.gliding import Gliding
    from morse.physics.state.engine_state import EngineState

#: arrays that gliding changes so that the contacts of the feet need not be solved
_OF_GLIDING = ("geom_contype", "geom_conaffinity", "geom_gap", "body_margin", "body_gravcomp")


class ContactPoints:
    """Computes all contacts, including those that the engine skips for speed: of sleeping bodies and of driven feet.

    The class works on a copy of the state, so that observers do not affect the simulation.
    """

    def __init__(self, state: EngineState, gliding: Gliding) -> None:
        self._state = state
        self._gliding = gliding
        self._copy: mujoco.MjData | None = None

    def look(self) -> NDArray[np.float32]:
        """Return (N, 6) points (m) and forces (N) on the movable body, or on the second one; world axes."""
        with self.everything() as data:
            return np.empty((0, 6), dtype=np.float32) if data is None else self._rows(data)

    @contextmanager
    def everything(self) -> Iterator[mujoco.MjData | None]:
        """A copy of the state with all contacts and their forces; None if there are too many contacts."""
        model = self._state.model
        if self._copy is None:
            self._copy = mujoco.MjData(model)
        mujoco.mj_copyData(self._copy, model, self._state.data)
        with self._everything_awake():
            try:
                mujoco.mj_forward(model, self._copy)
            except mujoco.FatalError:  # the next tick excludes bodies
                self._copy = None
        yield self._copy

    def _rows(self, data: mujoco.MjData) -> NDArray[np.float32]:
        model = self._state.model
        rows = np.empty((data.ncon, 6), dtype=np.float32)
        wrench = np.zeros(6)
        for index, fixed in enumerate(self._second_is_fixed(data)):
            contact = data.contact[index]
            mujoco.mj_contactForce(model, data, index, wrench)
            force = matmul(contact.frame.reshape(3, 3).T, wrench[:3])
            rows[index, :3], rows[index, 3:] = contact.pos, -force if fixed else force
        return rows

    def _second_is_fixed(self, data: mujoco.MjData) -> NDArray[np.bool_]:
        model = self._state.model
        return np.asarray(model.body_weldid[model.geom_bodyid[data.contact.geom[: data.ncon, 1]]] == 0)

    @contextmanager
    def _everything_awake(self) -> Iterator[None]:
        model = self._state.model
        flags = model.opt.enableflags
        kept = {name: getattr(model, name).copy() for name in _OF_GLIDING}
        try:
            model.opt.enableflags = flags & ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
            self._gliding.all_stand()
            yield
        finally:
            model.opt.enableflags = flags
            for name, values in kept.items():
                getattr(model, name)[:] = values
