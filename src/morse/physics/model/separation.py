"""Bodies that overlap at the start are moved apart before the first tick.

The contacts of the engine would push them apart within a few steps, at a speed in proportion to the depth. Thin ground
is no obstacle to a body that lies on both sides of it: the contacts above and below keep the body inside, and push it
aside. What is in the ground is therefore raised.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.physics.model.bottom import bottom_of
from morse.physics.model.layout import Motion

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from morse.physics.bodies import Bodies
    from morse.physics.model.layout import Frame
    from morse.physics.state.engine_state import EngineState
    from morse.scene import Node

    Floats = NDArray[np.float64]

#: depth, m, from which bodies are moved apart; objects that were placed on a floor by hand overlap it by less
_DEEP = 0.03
#: depth that is left to the contacts, m, which push bodies apart at up to 0.3 m/s there
_SHALLOW = 0.005
#: largest movement in a pass, m, and number of passes
_STEP, _PASSES = 0.05, 200
#: what a body is raised by, beyond its height, m
_SPARE = 0.15
#: with more contacts, `morse.physics.crowding` lets the bodies float
_MOST_CONTACTS = 4000
#: components along Z of a direction that leads downward, and of one that leads from a body to one below it
_DOWN, _BELOW = -0.1, -0.5

Pair = tuple[str, str]


def separate(state: EngineState, bodies: Bodies) -> dict[Pair, float] | None:
    """Move bodies apart that overlap deeply; those for which there is no room keep their poses.

    Returns:
        The pairs that overlapped, see `overlapping_pairs`; None if nothing had to be moved. The contacts are those of
        the new poses.
    """
    if len(state.data.contact.dist) > _MOST_CONTACTS:
        return None
    depths = overlapping_pairs(state)
    movable = set(_deepest(state))
    if not movable:
        return None
    starts = {index: np.array(state.positions[index]) for index in movable}
    heights = {index: _height(state, index) for index in movable}
    shallow = {index: _SPARE * heights[index] + 1.5 * depth for index, depth in _deepest(state).items()}
    for direction, limits in ((_no_lower, shallow), (_upward, heights), (_outward, heights)):
        failures = _push(state, bodies, movable, starts, limits, direction)
        movable = failures | (starts.keys() & _deepest(state).keys())
        for index in movable:
            bodies.place(index, starts[index].tolist(), state.rotations[index])
        _find_contacts(state)
        if not movable:
            break
    return depths


def overlapping_pairs(state: EngineState, depth: float = _DEEP) -> dict[Pair, float]:
    """Return the names of objects that overlap by more than a depth, m, and how deep they do.

    Objects of a world model that overlap its ground, such as crates on hills, are left out.
    """
    depths: dict[Pair, float] = {}
    contact = state.data.contact
    for (a, b), distance in zip(contact.geom.tolist(), contact.dist.tolist(), strict=True):
        frames = _root(state, a), _root(state, b)
        if distance > -depth or not (any(frame.robot for frame in frames) or all(map(_moves, frames))):
            continue
        pair = (_name(frames[0], state.geom_node[a]), _name(frames[1], state.geom_node[b]))
        if pair[0] != pair[1]:
            depths[pair] = max(depths.get(pair, 0.0), -distance)
    return depths


@dataclass(slots=True)
class _Contact:
    """A contact of two bodies, of which at least one can be moved.

    Attributes:
        movable: the slots that can be moved, with the direction for each.
        depth: m.
    """

    movable: dict[int, Floats]
    depth: float


def _contacts(state: EngineState, depth: float) -> list[_Contact]:
    contact = state.data.contact
    rows = np.flatnonzero(np.asarray(contact.dist) < -depth)
    result = []
    for row in rows.tolist():
        normal = np.array(contact.frame[row][:3])
        frames = [_root(state, geom) for geom in contact.geom[row].tolist()]
        if frames[0] is frames[1]:
            continue
        movable = {
            state.slot_of[frame.node]: way * normal
            for frame, way in zip(frames, (-1.0, 1.0), strict=True)
            if frame.motion is Motion.FREE
        }
        if movable:
            result.append(_Contact(movable, -float(contact.dist[row])))
    return result


def _push(
    state: EngineState,
    bodies: Bodies,
    movable: set[int],
    starts: dict[int, Floats],
    limits: dict[int, float],
    direction: Callable[[Floats], Floats],
) -> set[int]:
    """Move bodies until none overlap, each in a pass by its deepest contact; return those that reach their limits.

    Bodies that are pushed, such as those on top, move along.
    """
    failures, movable = set[int](), set(movable)
    falls = state.model.opt.gravity[2] < 0.0
    for _ in range(_PASSES):
        moves: dict[int, Floats] = {}
        for pair in sorted(_contacts(state, _SHALLOW), key=lambda pair: -pair.depth):
            if movable.isdisjoint(pair.movable):
                continue
            alone = len(pair.movable) == 1
            for index, away in pair.movable.items():
                if index not in starts:
                    starts[index] = np.array(state.positions[index])
                    limits[index] = 2.0 * _height(state, index)
                if index in failures or index in moves or (falls and not alone and away[2] < _BELOW):
                    continue
                movable.add(index)
                way = direction(away) if alone and falls else away
                moves[index] = min(pair.depth + 1e-4, _STEP) * way
        if not moves:
            break
        for index, move in moves.items():
            place = np.array(state.positions[index]) + move
            if np.abs(place - starts[index]).max() > limits[index]:
                failures.add(index)
                place = starts[index]
            bodies.place(index, place.tolist(), state.rotations[index])
        _find_contacts(state)
    return failures


def _find_contacts(state: EngineState) -> None:
    mujoco.mj_kinematics(state.model, state.data)
    mujoco.mj_collision(state.model, state.data)


def _deepest(state: EngineState) -> dict[int, float]:
    """Return the depth of the deepest contact of each body that overlaps deeply, m."""
    depths: dict[int, float] = {}
    for pair in _contacts(state, _DEEP):
        for index in pair.movable:
            depths[index] = max(depths.get(index, 0.0), pair.depth)
    return depths


def _upward(_: Floats) -> Floats:
    return np.array([0.0, 0.0, 1.0])


def _no_lower(away: Floats) -> Floats:
    return away if away[2] > _DOWN else _upward(away)


def _outward(away: Floats) -> Floats:
    return away


def _height(state: EngineState, index: int) -> float:
    """How far a body may be moved, m: a robot by the height of its origin over its bottom, an object by its height."""
    bottom = bottom_of(state, state.slots[index].frame.node)
    if bottom is None:
        return 0.0
    middle = float(state.data.subtree_com[state.slots[index].body][2])
    return _SPARE + max(2.0 * (middle - bottom), state.positions[index][2] - bottom)


def _root(state: EngineState, geom: int) -> Frame:
    """Return the body of a shape; for a wheel or a link, the robot."""
    frame = state.slots[state.slot_of[state.geom_node[geom]]].frame
    while frame.parent is not None:
        frame = frame.parent
    return frame


def _name(frame: Frame, node: Node) -> str:
    return frame.node.name if _moves(frame) else node.name


def _moves(frame: Frame) -> bool:
    return frame.motion is not Motion.FIXED
