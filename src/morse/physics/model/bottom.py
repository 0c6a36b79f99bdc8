"""The lowest point of a body."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import mujoco

if TYPE_CHECKING:
    from morse.physics.state.engine_state import EngineState
    from morse.scene import Node


def bottom_of(state: EngineState, node: Node) -> float | None:
    """Return the height of the lowest point of a body with wheels and links, m; None if it has no collision shapes."""
    lowest = lowest_of(state, node)
    return None if lowest is None else lowest[0]


def lowest_of(state: EngineState, node: Node) -> tuple[float, int] | None:
    """Return the height of the lowest point of a body with wheels and links, m, and the geom that has it."""
    own = state.slots[state.slot_of[node]]
    slots = [state.slots[index] for index in state.attached.get(state.slot_of[node], ())]
    geoms = [geom for slot in (own, *slots) for numbers in slot.geoms.values() for geom in numbers]
    return min(((_lowest(state, geom), geom) for geom in geoms if state.model.geom_contype[geom]), default=None)


def _lowest(state: EngineState, geom: int) -> float:
    a, b, c = (float(size) for size in state.model.geom_size[geom])
    up_x, up_y, up_z = up = tuple(float(part) for part in state.data.geom_xmat[geom][6:])
    height = float(state.data.geom_xpos[geom][2])
    kind = int(state.model.geom_type[geom])
    if kind == mujoco.mjtGeom.mjGEOM_MESH:
        mesh = int(state.model.geom_dataid[geom])
        first, count = int(state.model.mesh_vertadr[mesh]), int(state.model.mesh_vertnum[mesh])
        return height + float((state.model.mesh_vert[first : first + count] @ up).min())
    if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        return height - a
    if kind == mujoco.mjtGeom.mjGEOM_ELLIPSOID:
        return height - math.hypot(a * up_x, b * up_y, c * up_z)
    if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        return height - a * math.hypot(up_x, up_y) - b * abs(up_z)
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        return height - a - b * abs(up_z)
    return height - a * abs(up_x) - b * abs(up_y) - c * abs(up_z)
