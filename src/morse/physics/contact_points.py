"""Where bodies touch, for those who watch."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

import mujoco
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from morse.physics.world import World

#: what gliding changes so that the contacts of the feet need not be solved
_OF_GLIDING = ("geom_contype", "geom_conaffinity", "geom_margin", "geom_gap", "body_margin", "body_gravcomp")


class ContactPoints:
    """Works out all contacts, those that the engine leaves out to be fast, too: of bodies at rest, and of driven feet.

    It does so on a copy of the state: whether somebody looks changes nothing.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        self._copy = mujoco.MjData(world.model)

    def look(self) -> NDArray[np.float32]:
        """(N, 6) point (m) and force (N) on the body that can move, or on the second one; world axes."""
        model, data = self._world.model, self._copy
        mujoco.mj_copyData(data, model, self._world.data)
        with self._everything_awake():
            mujoco.mj_forward(model, data)
        rows = np.empty((data.ncon, 6), dtype=np.float32)
        wrench = np.zeros(6)
        for index, fixed in enumerate(self._second_is_fixed()):
            contact = data.contact[index]
            mujoco.mj_contactForce(model, data, index, wrench)
            force = contact.frame.reshape(3, 3).T @ wrench[:3]
            rows[index, :3], rows[index, 3:] = contact.pos, -force if fixed else force
        return rows

    def _second_is_fixed(self) -> NDArray[np.bool_]:
        model, data = self._world.model, self._copy
        return np.asarray(model.body_weldid[model.geom_bodyid[data.contact.geom[: data.ncon, 1]]] == 0)

    @contextmanager
    def _everything_awake(self) -> Iterator[None]:
        model = self._world.model
        flags = model.opt.enableflags
        kept = {name: getattr(model, name).copy() for name in _OF_GLIDING}
        try:
            model.opt.enableflags = flags & ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
            self._world.gliding.all_stand()
            yield
        finally:
            model.opt.enableflags = flags
            for name, values in kept.items():
                getattr(model, name)[:] = values
