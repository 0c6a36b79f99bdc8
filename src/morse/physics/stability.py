"""Notices when the numbers blow up, before anyone sees a NaN."""

from __future__ import annotations

import logging
import math
from typing import TYPE_CHECKING

import mujoco
import numpy as np

if TYPE_CHECKING:
    from morse.physics.world import World


logger = logging.getLogger("morse." + __name__)

#: what the engine warned of already; it repeats itself every step
_said: set[str] = set()


def _warn(text: str) -> None:
    kind = text.partition(" at ")[0].partition(". Time")[0]
    if kind not in _said:
        _said.add(kind)
        logger.warning("%s", text)


# the engine would write its warnings to a file in the user's directory
mujoco.set_mju_user_warning(_warn)


class UnstableError(Exception):
    """The physics has no sensible answer any more.

    Attributes:
        body: name of the body that went first.
    """

    def __init__(self, body: str, what: str) -> None:
        super().__init__(
            f"the physics blew up: {what} of '{body}' is not a number any more. "
            "Look for bodies that start inside each other, for masses that differ by more than 1:1000, "
            "and for forces or speeds that are far too large"
        )
        self.body = body


def check_stable(world: World) -> None:
    """Raise `UnstableError` if a position or velocity is not finite.

    A sum is not finite if any of its terms is not; that keeps the check cheap.
    """
    data = world.data
    if math.isfinite(data.qvel.sum()) and math.isfinite(data.qpos.sum()):
        return
    for slot in world.slots:
        if slot.dof < 0:
            continue
        dofs = 6 if slot.mocap < 0 and slot.actuator < 0 else 1
        if not np.isfinite(data.qvel[slot.dof : slot.dof + dofs]).all():
            raise UnstableError(slot.frame.node.name, "the velocity")
        if not np.isfinite(data.qpos[slot.qpos : slot.qpos + dofs + (dofs == 6)]).all():
            raise UnstableError(slot.frame.node.name, "the position")
    raise UnstableError("the world", "the sum of all speeds")
