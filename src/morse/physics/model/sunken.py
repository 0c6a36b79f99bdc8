"""Ground robots that start deep inside the ground are raised until they stand on it.

Thin ground is no obstacle to a robot that lies on both sides of it: the contacts above and below keep the robot inside,
and push it aside.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.physics.model.bottom import bottom_of
from morse.physics.model.layout import Motion

if TYPE_CHECKING:
    from morse.physics.bodies import Bodies
    from morse.physics.state.engine_state import EngineState

#: depth beyond which the contacts cannot be trusted to push a robot out of the ground, m
_SUNKEN = 0.15
#: depth that the contacts correct, m
_SHALLOW = 0.02
_STEP = 0.02


def raise_sunken(state: EngineState, bodies: Bodies) -> bool:
    """Raise ground robots that overlap fixed bodies deeply, by the height of their origin over their bottom at most.

    A robot that overlaps something higher, such as a wall, keeps its pose.

    Returns:
        Whether the pose of any robot has changed; the contacts are then those of the new poses.
    """
    # without gravity, nothing stands on the ground
    sunken = _overlapping(state, _SUNKEN) if state.model.opt.gravity[2] < 0.0 else set()
    if not sunken:
        return False
    starts = {index: tuple(state.positions[index]) for index in sunken}
    limits = {}
    for index, start in starts.items():
        bottom = bottom_of(state, state.slots[index].frame.node)
        limits[index] = 0.0 if bottom is None else start[2] - bottom + _SUNKEN
    passes = int(max(limits.values()) / _STEP)
    for count in range(1, passes + 1):
        for index in sunken:
            x, y, z = starts[index]
            bodies.place(index, (x, y, z + count * _STEP), state.rotations[index])
        mujoco.mj_kinematics(state.model, state.data)
        mujoco.mj_collision(state.model, state.data)
        sunken = {index for index in sunken & _overlapping(state, _SHALLOW) if limits[index] > count * _STEP}
        if not sunken:
            break
    for index in starts.keys() & _overlapping(state, _SHALLOW):
        bodies.place(index, starts[index], state.rotations[index])
    return True


def _overlapping(state: EngineState, depth: float) -> set[int]:
    """Return the ground robots without joints that overlap a fixed body by more than a depth, m."""
    contact = state.data.contact
    robots = set()
    for a, b in np.asarray(contact.geom)[np.asarray(contact.dist) < -depth].tolist():
        indices = [state.slot_of[state.geom_node[geom]] for geom in (a, b)]
        for one, other in (indices, indices[::-1]):
            frame = state.slots[one].frame
            is_robot = bool(frame.node.properties.get("GroundRobot")) and frame.motion is Motion.FREE
            if is_robot and one not in state.attached and state.slots[other].frame.motion is Motion.FIXED:
                robots.add(one)
    return robots
