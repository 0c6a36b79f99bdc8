"""Computes the poses of all slots from the state of the engine."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.physics.poses import rigid
from morse.physics.poses.rows import Rows

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.physics.state.engine_state import EngineState


#: value of `contact.exclude` of the engine for contacts within a gap
IN_GAP = 1


def place_as_compiled(state: EngineState) -> None:
    """Set every slot to its pose in the scene."""
    count = len(state.slots)
    moving = state.moving
    if len(state.compiled_poses) != count:
        turns = [tuple(float(v) for row in slot.pose.rotation for v in row) for slot in state.slots]
        places = [tuple(map(float, slot.pose.position)) for slot in state.slots]
        state.compiled_poses = list(zip(places, turns, map(rigid.quaternion, turns), strict=True))
    places, turns, quaternions = map(list, zip(*state.compiled_poses, strict=True)) if count else ([], [], [])
    state.positions = Rows(np.array(places, dtype=np.float64).reshape(-1, 3), moving)
    state.rotations = Rows(np.array(turns, dtype=np.float64).reshape(-1, 9), moving)
    state.relocated.clear()
    state.quaternions = quaternions


def sync(state: EngineState) -> None:
    """Compute all poses from the present state."""
    mujoco.mj_kinematics(state.model, state.data)
    refresh(state)


def refresh(state: EngineState, *, gliders: bool = True) -> None:
    """Copy the poses of the moving bodies from the engine.

    Args:
        gliders: whether the robots that glide keep the poses of the kernel; False while it is not known which ones do.
    """
    state.positions.take(state.engine_positions, state.engine_rows)
    state.rotations.take(state.engine_rotations, state.engine_rows)
    if gliders and state.write_gliders is not None:
        state.write_gliders(state.positions, state.rotations)
    state.touched.clear()
    state.stamp += 1


def refresh_gliders(state: EngineState) -> None:
    """Copy the poses of the robots that glide, after others were known to glide than at the last `refresh`."""
    if state.write_gliders is not None:
        # the rows of the bodies that the engine moves, which may be shared, are taken again
        for rows in (state.positions, state.rotations):
            rows.take(rows.array[: state.moving].copy())
        state.write_gliders(state.positions, state.rotations)


def settle_fixed(state: EngineState) -> None:
    """Update the poses of static bodies, after one of them was moved by an explicit call."""
    # with sleeping enabled, the engine computes the poses of static bodies only once
    flags = state.model.opt.enableflags
    state.model.opt.enableflags = flags & ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    mujoco.mj_kinematics(state.model, state.data)
    state.model.opt.enableflags = flags


def contact_pairs(state: EngineState) -> NDArray[np.int32]:
    """Return (N, 2) pairs of geoms that were in contact in the last step of the engine.

    Without those within the gaps around gliding robots.
    """
    if state.known_contacts is not None:
        return state.known_contacts
    contact = state.data.contact
    if not state.has_gaps:
        return np.asarray(contact.geom)
    state.known_contacts = np.asarray(contact.geom)[np.asarray(contact.exclude) != IN_GAP]
    return state.known_contacts
