"""Robots that start deep inside the ground are raised until they stand on it.

Thin ground is no obstacle to a robot that lies on both sides of it: the contacts above and below keep the robot inside,
and push it aside. A robot with few collision shapes, such as those of its feet, may even touch nothing there. The
origin of many robots with legs is in their trunk; at height 0 their legs are below the floor.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.physics.model.bottom import bottom_of, lowest_of
from morse.physics.model.layout import Motion

if TYPE_CHECKING:
    from collections.abc import Container

    from morse.physics.bodies import Bodies
    from morse.physics.model.layout import Frame
    from morse.physics.state.engine_state import EngineState
    from morse.scene import SourceLine

#: depth of the bottom of a robot below the ground that it touches, beyond which the contacts cannot be trusted to push
#: the robot out, m
_SUNKEN = 0.15
#: depth that the contacts correct, m
_SHALLOW = 0.02
_STEP = 0.02
#: shapes that a ray passes at most, and distance behind one from which it goes on, m
_MOST_HITS, _APART = 100, 1e-4
#: vertical part of the normal of a contact with the ground
_UPWARD = 0.7


def raise_sunken(state: EngineState, bodies: Bodies) -> bool:
    """Raise robots whose bottom is deep inside fixed bodies, by the height of their origin over their bottom at most.

    A robot that overlaps something higher, such as a wall, keeps its pose.

    Returns:
        Whether the pose of any robot has changed; the contacts are then those of the new poses.
    """
    # without gravity, nothing stands on the ground
    if state.model.opt.gravity[2] >= 0.0:
        return False
    sunken = _sunken(state)
    below = _below_thin_ground(state, sunken)
    sunken |= {index: bottom for index, (bottom, _) in below.items()}
    if not sunken:
        return False
    starts = {index: tuple(state.positions[index]) for index in sunken}
    limits = {index: starts[index][2] - bottom + _SUNKEN for index, bottom in sunken.items()}
    lifted = set(sunken)
    for count in range(1, int(max(limits.values()) / _STEP) + 1):
        for index in lifted:
            x, y, z = starts[index]
            if index in below:
                bottom, ground = below[index]
                z += ground - bottom
            bodies.place(index, (x, y, z + count * _STEP), state.rotations[index])
        mujoco.mj_kinematics(state.model, state.data)
        mujoco.mj_collision(state.model, state.data)
        lifted = {index for index in lifted & _overlapping(state, _SHALLOW).keys() if limits[index] > count * _STEP}
        if not lifted:
            break
    for index in starts.keys() & _overlapping(state, _SHALLOW).keys():
        bodies.place(index, starts[index], state.rotations[index])
    return True


def raised(state: EngineState) -> tuple[str, SourceLine | None]:
    """Return a message about the robots that `raise_sunken` has raised; empty if there are none.

    The second value is the line of the script that created the first of them.

    Call it before the first tick.
    """
    robots, line = list[str](), None
    for index, slot in enumerate(state.slots):
        height = state.positions[index][2] - slot.pose.position[2] if _stands(state, index) else 0.0
        if height >= _STEP / 2:
            line = line or slot.frame.node.line
            robots.append(f"'{slot.frame.node.name}' by {height:.2g} m")
    mend = "; translate them up in the script"
    return f"robots start inside the ground, and are put on it: {', '.join(robots)}{mend}" if robots else "", line


def _sunken(state: EngineState) -> dict[int, float]:
    """Return the robots that are deep inside the ground, and the height of their bottom, m."""
    bottoms = {}
    for index, (depth, height) in _overlapping(state, _SHALLOW).items():
        frame = state.slots[index].frame
        bottom = bottom_of(state, frame.node)
        if bottom is not None and (depth > _SUNKEN or (_is_of_file(frame) and height - bottom > _SUNKEN)):
            bottoms[index] = bottom
    return bottoms


def _below_thin_ground(state: EngineState, others: Container[int]) -> dict[int, tuple[float, float]]:
    """Return the robots of files that touch nothing, with their bottom below a fixed body and their origin above it.

    Args:
        others: robots that are raised anyway.

    Returns:
        The index of each robot to the heights of its bottom and of the ground below its origin, m.
    """
    robots: dict[int, tuple[float, float]] = {}
    for index, slot in enumerate(state.slots):
        if index in others or slot.frame.motion is not Motion.FREE or not _is_of_file(slot.frame):
            continue
        lowest = lowest_of(state, slot.frame.node)
        x, y, z = (float(value) for value in state.positions[index])
        if lowest is None or z - lowest[0] <= _SUNKEN:
            continue
        ground = _fixed_height(state, (x, y, z + _SHALLOW), -1.0)
        foot = state.data.geom_xpos[lowest[1]]
        ceiling = _fixed_height(state, (float(foot[0]), float(foot[1]), float(foot[2])), 1.0)
        if ground is not None and ceiling is not None and lowest[0] + _SUNKEN < ground and ceiling <= ground + _SHALLOW:
            robots[index] = lowest[0], ground
    return robots


def _fixed_height(state: EngineState, origin: tuple[float, float, float], up: float) -> float | None:
    """Return the height at which a vertical ray hits the first fixed body, m; it passes through all others."""
    point, geom = np.array(origin), np.full(1, -1, dtype=np.int32)
    for _ in range(_MOST_HITS):
        distance = float(mujoco.mj_ray(state.model, state.data, point, np.array([0.0, 0.0, up]), None, 1, -1, geom))
        if distance < 0.0:
            return None
        point[2] += up * distance
        node = state.geom_node[int(geom[0])]
        is_solid = bool(state.model.geom_contype[geom[0]] or state.model.geom_conaffinity[geom[0]])
        if is_solid and state.slots[state.slot_of[node]].frame.root.motion is Motion.FIXED:
            return float(point[2])
        point[2] += up * _APART
    return None


def _overlapping(state: EngineState, depth: float) -> dict[int, tuple[float, float]]:
    """Return the robots that overlap a fixed body by more than a depth, m.

    Returns:
        The index of each robot to the largest depth, and the height of the highest level contact, m.
    """
    contact = state.data.contact
    deep = np.nonzero(np.asarray(contact.dist) < -depth)[0].tolist()
    robots: dict[int, tuple[float, float]] = {}
    for number in deep:
        frames = [state.slots[state.slot_of[state.geom_node[geom]]].frame.root for geom in contact.geom[number]]
        for one, other in (frames, frames[::-1]):
            index = state.slot_of[one.node]
            if other.motion is Motion.FIXED and _stands(state, index):
                is_level = abs(contact.frame[number][2]) > _UPWARD
                most, height = robots.get(index, (0.0, -np.inf))
                level = float(contact.pos[number][2]) if is_level else -np.inf
                robots[index] = max(most, -float(contact.dist[number])), max(height, level)
    return robots


def _stands(state: EngineState, index: int) -> bool:
    """Whether a body is a robot of a file, or a ground robot without joints."""
    frame = state.slots[index].frame
    is_ground_robot = bool(frame.node.properties.get("GroundRobot")) and index not in state.attached
    return frame.motion is Motion.FREE and (is_ground_robot or _is_of_file(frame))


def _is_of_file(frame: Frame) -> bool:
    """Whether a body is a robot from a URDF, MJCF or SDF file without a floor, to which its pose would refer."""
    settings = frame.node.articulation
    has_floor = settings is not None and settings.model is not None and settings.model.has_floor
    return frame.robot is not None and settings is not None and not has_floor
