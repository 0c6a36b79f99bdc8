"""Objects that slide fast stay on the ground.

The friction of the engine is convex: it would like to stop all of the slip of a contact within its time constant, which
is two steps here, and lets the bodies part at up to the friction coefficient times the slip. A crate that slides at
4 m/s with a coefficient of 0.5 would jump 14 cm high. The contacts of objects that begin a tick faster than `_SLIP`
therefore ask for no larger change of the slip in a step than `_SLIP` and the speed of approach. That is more than
friction can do, so that the force of friction stays that of Coulomb.

Source: MuJoCo documentation, "Computation", on the reference acceleration of constraints and on the elliptic cone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.physics.model.layout import Motion

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.physics.model.slot import Slot

#: m/s; beyond the second one, bodies have diverged
_SLIP = 0.25
_DIVERGED = 1e6
#: contacts with a larger time constant, in steps, are soft on purpose
_STIFF = 3.0


class Sliding:
    """Runs steps of the engine in which some objects slide.

    Args:
        slots: the objects of the model.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, slots: Iterable[Slot]) -> None:
        self._model, self._data = model, data
        objects = [slot for slot in slots if slot.frame.motion is Motion.FREE and slot.frame.robot is None]
        free = [slot.body for slot in objects if slot.body > 0]
        self._bodies = np.array([body for body in free if model.body_dofnum[body] == 6], dtype=np.intp)
        self._dofs = model.body_dofadr[self._bodies][:, None] + np.arange(3)
        elliptic = model.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC
        self._has_objects = bool(len(self._bodies)) and bool(elliptic)
        self._slides = np.zeros(model.nbody, dtype=bool)
        self._geom_body = np.asarray(model.geom_bodyid)
        self._longest = _STIFF * model.opt.timestep
        self.is_needed = False

    def begin(self) -> None:
        """Note at the beginning of a tick which objects slide: each for itself, whatever the others do."""
        if not self._has_objects:
            return
        fast = np.abs(self._data.qvel[self._dofs]).max(axis=1) > _SLIP
        self.is_needed = bool(fast.any())
        if self.is_needed:
            self._slides[self._bodies] = fast

    def run(self, steps: int) -> None:
        """Run steps of the engine."""
        for _ in range(steps):
            mujoco.mj_step1(self._model, self._data)
            if self._data.ncon:
                self._limit()
            mujoco.mj_step2(self._model, self._data)

    def _limit(self) -> None:
        """Limit the change of the slip that the contacts of sliding objects ask for."""
        data, contact = self._data, self._data.contact
        rows = contact.efc_address
        chosen = self._slides[self._geom_body[contact.geom]].any(axis=1) & (rows >= 0) & (contact.dim > 2)
        chosen &= contact.solref[:, 0] <= self._longest
        if not chosen.any():
            return
        first = rows[chosen]
        # bodies that diverge are dealt with elsewhere
        near, along, across = (np.clip(data.efc_vel[first + row], -_DIVERGED, _DIVERGED) for row in range(3))
        slip = np.sqrt(along * along + across * across)
        share = np.minimum(1.0, (_SLIP + np.abs(near)) / np.maximum(slip, _SLIP))
        data.efc_aref[first + 1] *= share
        data.efc_aref[first + 2] *= share
