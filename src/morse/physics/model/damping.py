"""The damping of free bodies."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.physics.driving.calibration import FREE_DAMPING

if TYPE_CHECKING:
    from morse.physics.model.slot import Slot


def set_damping(model: mujoco.MjModel, slot: Slot, of_1_4: bool) -> None:
    """Set the damping of a free body, given as the share of the velocity that it loses per second.

    ``v' = -c v`` with ``exp(-c) = 1 - d`` keeps ``1 - d`` of the velocity after a second.

    Args:
        of_1_4: whether the scene has the physics of MORSE 1.4; see `morse.physics.driving.calibration`.
    """
    body = slot.frame.node.body
    if slot.frame.node.articulation is not None and not body.linear_damping and not body.angular_damping:
        # the joint has the damping of its file
        return
    linear, angular = (-math.log(1.0 - min(max(d, 0.0), 0.999)) for d in (body.linear_damping, body.angular_damping))
    linear *= FREE_DAMPING if of_1_4 else 1.0
    model.dof_damping[slot.dof : slot.dof + 3] = linear * model.body_mass[slot.body]
    # the inertia about the axes of the body: it may differ by a factor of ten among them
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[slot.body])
    about = (turn.reshape(3, 3) ** 2 * model.body_inertia[slot.body]).sum(axis=1)
    model.dof_damping[slot.dof + 3 : slot.dof + 6] = angular * about
